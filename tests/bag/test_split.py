"""Split and compressed bags: other readers, files of one run, loss at a kill."""

from dataclasses import replace
import hashlib
from pathlib import Path
import shutil
import subprocess
import sys
import tracemalloc

from isa_ros.bag.part_writer import CHUNK_BYTES, CHUNK_TICKS
from isa_ros.bag.reader import Bag
from isa_ros.bag.storage import Storage
from isa_ros.bag.writer import BagWriter
from isa_ros.errors import BagError, RunError
from mcap.reader import make_reader
import pytest
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader
from tests.bag.recorded import (
    expected, files, NAMES, PROVENANCE, record, STEP_NS, tick_messages, TOPICS, wait_for_disk)
from tests.full_disk import limited_files
import yaml

N = 1234  # ticks: two full chunks and a part
EACH_CHUNK = 0.001  # MB, less than a chunk: every chunk has its own file
CODECS = ('none', 'lz4', 'zstd')


def storage(compression: str = 'none', split_mb: float = EACH_CHUNK) -> Storage:
    return Storage(compression=compression, split_mb=split_mb)


@pytest.fixture(scope='module', params=CODECS)
def split(request, tmp_path_factory):
    """Return the directory of a bag of N ticks, a file per chunk."""
    directory = tmp_path_factory.mktemp('recorded') / 'rig'
    record(directory, N, storage=storage(request.param))
    return directory


@pytest.fixture
def copy(tmp_path):
    """Return a copy of a bag of two full files and a third, to be damaged."""
    directory = tmp_path / 'rig'
    record(directory, N, storage=storage('zstd'))
    return directory


def test_every_file_begins_with_the_tick_after_the_chunk_that_filled_the_last(split):
    assert [path.name for path in files(split)] == ['rig_0.mcap', 'rig_1.mcap', 'rig_2.mcap']
    sequences = [[tick.sequence for tick in Bag(path).ticks()] for path in files(split)]
    assert sequences == [
        list(range(500)), list(range(500, 1000)), list(range(1000, N))]


def test_a_finished_file_keeps_no_memory_for_messages(tmp_path):
    """A long run has many files; the buffer of a chunk is a megabyte and more."""
    tracemalloc.start()
    try:
        with BagWriter(tmp_path / 'rig', TOPICS, PROVENANCE, storage=storage()) as writer:
            used = []
            for tick in range(7 * CHUNK_TICKS):
                writer.write_tick(tick * STEP_NS, tick, tick_messages(tick))
                if tick % CHUNK_TICKS == CHUNK_TICKS - 1:
                    used.append(tracemalloc.get_traced_memory()[0])
    finally:
        tracemalloc.stop()
    assert len(used) == len(files(tmp_path / 'rig')) == 7
    # four more files: their names, counts and offsets, and not a buffer each
    assert used[-1] - used[2] < CHUNK_BYTES


def test_files_are_read_as_one_run(split):
    bag = Bag(split)
    assert [(m.topic, m.t_ns, m.data) for m in bag.messages()] == list(expected(N))
    assert (bag.start_ns, bag.end_ns, bag.is_whole) == (0, (N - 1) * STEP_NS, True)
    assert bag.n_messages == len(list(expected(N)))
    assert bag.provenance == PROVENANCE


def test_rosbag2_and_any_reader_read_every_message(split):
    with Reader(split) as reader:
        read = [(c.topic, t_ns, bytes(data)) for c, t_ns, data in reader.messages()]
    assert read == list(expected(N))
    with AnyReader([split]) as reader:
        assert reader.message_count == len(read)


def test_every_file_stands_alone_in_the_official_reader(split):
    read = []
    for path in files(split):
        with path.open('rb') as file:
            reader = make_reader(file, validate_crcs=True)
            read += [(channel.topic, message.log_time, message.data)
                     for _, channel, message in reader.iter_messages()]
            summary = reader.get_summary()
            assert [a.name for a in reader.iter_attachments()] == [
                'configuration.yaml', 'scenario.yaml']
        assert sorted(c.topic for c in summary.channels.values()) == NAMES
        assert Bag(path).provenance == PROVENANCE
    assert read == list(expected(N))


def test_chunks_are_compressed_as_asked(tmp_path):
    sizes = {}
    for codec in CODECS:
        path = record(tmp_path / codec, N, storage=storage(codec, 0.0))
        with path.open('rb') as file:
            chunks = make_reader(file).get_summary().chunk_indexes
        assert {chunk.compression for chunk in chunks} == {codec.removeprefix('none')}
        sizes[codec] = sum(chunk.compressed_size for chunk in chunks)
        assert sum(chunk.uncompressed_size for chunk in chunks) >= sizes['none']
    assert sizes['zstd'] < sizes['lz4'] < sizes['none']


def test_doctor_finds_nothing(copy):
    doctor = Path(sys.executable).with_name('pymcap-cli')
    done = subprocess.run(
        [doctor, 'doctor', files(copy)[1]], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout


def test_metadata_lists_every_file_with_its_own_extent(split):
    bag = yaml.safe_load((split / 'metadata.yaml').read_text())['rosbag2_bagfile_information']
    assert bag['version'] == 9
    assert bag['relative_file_paths'] == ['rig_0.mcap', 'rig_1.mcap', 'rig_2.mcap']
    spans = [(0, 499), (500, 999), (1000, N - 1)]
    counts = [sum(len(tick_messages(k)) for k in range(a, b + 1)) for a, b in spans]
    assert bag['files'] == [
        {'path': f'rig_{k}.mcap', 'starting_time': {'nanoseconds_since_epoch': a * STEP_NS},
         'duration': {'nanoseconds': (b - a) * STEP_NS}, 'message_count': counts[k]}
        for k, (a, b) in enumerate(spans)]
    assert bag['message_count'] == sum(counts)
    assert bag['duration'] == {'nanoseconds': (N - 1) * STEP_NS}


def test_same_run_gives_the_same_bytes(split, tmp_path):
    with files(split)[0].open('rb') as file:
        codec = make_reader(file).get_summary().chunk_indexes[0].compression or 'none'
    record(tmp_path / 'rig', N, storage=storage(codec))
    assert [hashlib.sha256(p.read_bytes()).digest() for p in files(tmp_path / 'rig')] == [
        hashlib.sha256(p.read_bytes()).digest() for p in files(split)]


def test_one_file_is_the_same_whether_it_could_have_been_split(tmp_path):
    whole = record(tmp_path / 'whole' / 'rig', N)
    large = record(tmp_path / 'large' / 'rig', N, storage=storage(split_mb=100.0))
    assert whole.read_bytes() == large.read_bytes()


def test_run_that_ends_with_a_full_file_leaves_no_empty_one(tmp_path):
    record(tmp_path / 'rig', 2 * CHUNK_TICKS, storage=storage())
    assert [path.name for path in files(tmp_path / 'rig')] == ['rig_0.mcap', 'rig_1.mcap']
    assert Bag(tmp_path / 'rig').is_whole


def test_overwriting_removes_every_file(copy):
    record(copy, 3, overwrite=True)
    assert [path.name for path in files(copy)] == ['rig_0.mcap']


def test_last_file_may_be_cut_short_anywhere(copy):
    last = files(copy)[-1]
    data = last.read_bytes()
    for cut in (0, 3, 8, 100, 2000, len(data) // 2, len(data) - 1):
        last.write_bytes(data[:cut])
        bag = Bag(copy)
        assert not bag.is_whole
        assert len(list(bag.ticks())) in (1000, N)
        assert bag.provenance == PROVENANCE


def test_bag_without_its_last_file_says_that_it_goes_on(copy):
    files(copy)[-1].unlink()
    bag = Bag(copy)
    assert not bag.is_whole
    assert bag.end_ns == 999 * STEP_NS


def test_missing_file_in_the_middle_is_named(copy):
    (copy / 'rig_1.mcap').unlink()
    with pytest.raises(BagError, match='rig_1.mcap is missing among rig_0.mcap, rig_2.mcap'):
        Bag(copy)


def test_file_cut_short_before_others_is_named(copy):
    middle = copy / 'rig_1.mcap'
    middle.write_bytes(middle.read_bytes()[:-5])
    with pytest.raises(BagError, match='rig_1.mcap: is cut short, but rig_2.mcap continues it'):
        Bag(copy)


def test_file_of_another_name_is_no_part(copy):
    (copy / 'rig_2.mcap').rename(copy / 'other_2.mcap')
    with pytest.raises(BagError, match='holds 3 MCAP files, must hold one, or NAME_0.mcap'):
        Bag(copy)


def test_files_in_another_order_are_refused(copy):
    one, two = copy / 'rig_1.mcap', copy / 'rig_2.mcap'
    one.rename(copy / 'x')
    two.rename(one)
    (copy / 'x').rename(two)
    with pytest.raises(BagError, match="rig_1.mcap: is labelled file '2' of a bag, not 1"):
        Bag(copy)


def test_first_file_that_is_not_the_first_is_refused(copy):
    (copy / 'rig_0.mcap').unlink()
    for number in (1, 2):
        (copy / f'rig_{number}.mcap').rename(copy / f'rig_{number - 1}.mcap')
    with pytest.raises(BagError, match="rig_0.mcap: is labelled file '1' of a bag, not 0"):
        Bag(copy)


def other_run(directory, provenance=PROVENANCE, topics=TOPICS, first=0):
    """Record a split run that is not the one of `record`."""
    with BagWriter(directory, topics, provenance, storage=storage()) as writer:
        for tick in range(first, first + N):
            writer.write_tick(tick * STEP_NS, tick, [
                (k, data) for k, data in tick_messages(tick) if k < len(topics)])
    return directory / f'{directory.name}_1.mcap'


def test_file_of_another_run_is_refused(copy, tmp_path):
    other = other_run(tmp_path / 'other', replace(PROVENANCE, seed=8))
    shutil.copyfile(other, copy / 'rig_1.mcap')
    with pytest.raises(BagError, match='rig_1.mcap: belongs to another run than rig_0.mcap'):
        Bag(copy)


def test_file_with_other_topics_is_refused(copy, tmp_path):
    other = other_run(tmp_path / 'other', topics=TOPICS[:-1])
    shutil.copyfile(other, copy / 'rig_1.mcap')
    with pytest.raises(BagError, match='rig_1.mcap: has other topics or types than rig_0.mcap'):
        Bag(copy)


def test_time_that_does_not_go_on_is_refused(copy, tmp_path):
    late = other_run(tmp_path / 'late', first=CHUNK_TICKS // 2)
    shutil.copyfile(late, copy / 'rig_1.mcap')
    with pytest.raises(BagError, match='rig_2.mcap: begins at 1000000000 ns, before rig_1.mcap'):
        Bag(copy)


def test_full_disk_while_splitting_leaves_a_readable_bag(tmp_path):
    """The limit allows two files; then every file is too large for its second chunk."""
    size = record(tmp_path / 'measure', CHUNK_TICKS, storage=storage()).stat().st_size
    writer = BagWriter(tmp_path / 'rig', TOPICS, PROVENANCE, storage=storage(split_mb=2.0))
    with limited_files(int(1.5 * size)), pytest.raises(RunError, match='cannot record, File too'):
        for tick in range(5000):
            writer.write_tick(tick * STEP_NS, tick, tick_messages(tick))
    writer.close()
    assert [tick.sequence for tick in Bag(tmp_path / 'rig').ticks()] == list(range(CHUNK_TICKS))


def test_next_file_that_cannot_be_made_is_a_run_error(tmp_path):
    """The recorded files are kept, and the bag is labelled as continuing."""
    (tmp_path / 'rig').mkdir()
    writer = BagWriter(tmp_path / 'rig', TOPICS, PROVENANCE, True, storage())
    (tmp_path / 'rig' / 'rig_1.mcap').write_bytes(b'in the way')
    with pytest.raises(RunError, match='rig_1.mcap: cannot record, File exists'):
        for tick in range(CHUNK_TICKS + 1):
            writer.write_tick(tick * STEP_NS, tick, tick_messages(tick))
    writer.close()
    assert (tmp_path / 'rig' / 'rig_1.mcap').read_bytes() == b'in the way'
    (tmp_path / 'rig' / 'rig_1.mcap').unlink()
    bag = Bag(tmp_path / 'rig')
    assert (bag.end_ns, bag.is_whole) == ((CHUNK_TICKS - 1) * STEP_NS, False)


def test_long_steps_end_a_chunk_after_half_a_second(tmp_path):
    """At most a second of simulation may be lost, at any step."""
    step_ns = 100_000_000
    writer = BagWriter(tmp_path / 'rig', TOPICS, PROVENANCE)
    for tick in range(30):
        t_ns = tick * step_ns
        writer.write_tick(t_ns, tick, tick_messages(tick))
        wait_for_disk(tmp_path / 'rig', lambda bag: t_ns - (bag.end_ns or 0) <= 500_000_000)


def test_ticks_without_messages_end_a_chunk_too(tmp_path):
    """A topic at every 2000th tick: its chunk must not wait for the next message."""
    writer = BagWriter(tmp_path / 'rig', TOPICS, PROVENANCE)
    writer.write_tick(0, 0, tick_messages(0))
    for tick in range(1, 501):
        assert Bag(tmp_path / 'rig').n_messages == 0
        writer.write_tick(tick * STEP_NS, tick, [])
    wait_for_disk(tmp_path / 'rig', lambda bag: bag.n_messages == len(tick_messages(0)))
