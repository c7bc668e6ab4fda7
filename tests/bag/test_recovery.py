"""A bag cut short is completed: the bytes of a run that ended there, for every reader."""

import os
from pathlib import Path

from isa_ros.bag import part_writer, provenance
from isa_ros.bag.metadata import NO_START
from isa_ros.bag.reader import Bag
from isa_ros.bag.recovery import recover
from isa_ros.bag.storage import Storage
from isa_ros.cli.main import main
from isa_ros.errors import BagError
from mcap.opcode import Opcode
from mcap.reader import make_reader
import pytest
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader
from tests.bag.recorded import contents, expected, files, record, STEP_NS
from tests.bag.test_checksums import of
from tests.full_disk import limited_files
import yaml

CHUNK_TICKS = 50    # instead of 500: a bag of the same parts is written in a tenth of the time
N = 2 * CHUNK_TICKS + 23
SPLIT_MB = 0.001    # less than a chunk: every chunk has its own file
STORAGES = pytest.mark.parametrize('storage', [
    Storage(compression=compression, split_mb=split_mb)
    for compression in ('none', 'zstd', 'lz4') for split_mb in (0.0, SPLIT_MB)], ids=str)


@pytest.fixture(autouse=True)
def small_chunks(monkeypatch: pytest.MonkeyPatch) -> None:
    """End each chunk after `CHUNK_TICKS`."""
    monkeypatch.setattr(part_writer, 'CHUNK_TICKS', CHUNK_TICKS)


def cut(path: Path, size: int) -> None:
    with path.open('r+b') as file:
        file.truncate(size)


@pytest.fixture
def killed(tmp_path: Path) -> Path:
    """Return a bag of one file, cut in its last chunk; the first two are complete."""
    path = record(tmp_path / 'rig', N)
    chunks = of(path.read_bytes(), Opcode.CHUNK)
    cut(path, chunks[2].start + 1000)
    return tmp_path / 'rig'


@STORAGES
def test_it_has_the_bytes_of_a_run_that_ended_there(tmp_path: Path, storage: Storage) -> None:
    """Files, index, summary and metadata.yaml, wherever the recorder was killed in a chunk."""
    ended = tmp_path / 'ended' / 'rig'
    record(ended, 2 * CHUNK_TICKS, storage=storage)
    whole = tmp_path / 'whole' / 'rig'
    record(whole, N, storage=storage)
    last = files(whole)[-1]
    chunks = of(last.read_bytes(), Opcode.CHUNK)
    if storage.split_mb:
        last.unlink()           # the second file says that it goes on
        last = files(whole)[-1]
        chunks = of(last.read_bytes(), Opcode.CHUNK)
        end, = of(last.read_bytes(), Opcode.METADATA)[-1:]
        places = [end.start, end.start - 100]
    else:
        places = [chunks[2].start, chunks[2].start + 500, chunks[2].start - 100]
    data = last.read_bytes()
    for number, place in enumerate(places):
        last.write_bytes(data[:place])
        before = contents(whole)
        found = recover(whole, tmp_path / f'new_{number}')
        assert contents(tmp_path / f'new_{number}') == contents(ended)
        assert contents(whole) == before
        assert (found.end_ns, found.is_done) == ((2 * CHUNK_TICKS - 1) * STEP_NS, True)


@pytest.mark.parametrize('storage', [
    Storage(compression='none', split_mb=0.0), Storage(compression='zstd', split_mb=SPLIT_MB)],
    ids=str)
def test_every_reader_opens_it(tmp_path: Path, storage: Storage) -> None:
    """Cut anywhere in the last file: rosbags, the official library, and this package."""
    whole = tmp_path / 'rig'
    record(whole, N, storage=storage)
    last = files(whole)[-1]
    data = last.read_bytes()
    for number, size in enumerate(range(len(data) - 1, len(data) // 2, -len(data) // 5)):
        last.write_bytes(data[:size])
        n_ticks = len(list(Bag(whole).ticks()))
        out = recover(whole, tmp_path / f'out_{number}').directory
        sent = list(expected(n_ticks))
        with Reader(out) as reader:
            assert [(c.topic, t, bytes(d)) for c, t, d in reader.messages()] == sent
        with AnyReader([out]) as reader:
            assert reader.message_count == len(sent)
        read = []
        for path in files(out):
            with path.open('rb') as file:
                read += [(channel.topic, message.log_time, message.data) for _, channel, message
                         in make_reader(file, validate_crcs=True).iter_messages()]
        assert read == sent
        bag = Bag(out)
        assert bag.is_whole and bag.provenance == Bag(whole).provenance
        assert [(m.topic, m.t_ns, m.data) for m in bag.messages()] == sent


def test_a_bag_of_a_later_format_is_completed(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its provenance cannot be read here, and is not needed: it is copied as it is."""
    monkeypatch.setattr(provenance, 'FORMAT', '2')
    record(tmp_path / 'rig', N)
    records = Bag(tmp_path / 'rig').provenance_records
    monkeypatch.undo()
    last = files(tmp_path / 'rig')[-1]
    cut(last, last.stat().st_size - 9)
    out = recover(tmp_path / 'rig').directory
    assert Bag(out).is_whole and Bag(out).provenance_records == records
    with pytest.raises(BagError, match="format '2', must be '1'"):
        _ = Bag(out).provenance


@pytest.mark.parametrize('left', [None, 0, 5, 300, 3000])
def test_a_split_bag_without_a_chunk_in_its_last_file_is_completed(
        tmp_path: Path, left: int | None) -> None:
    """The file is missing, empty, or cut in its head: it becomes one without messages."""
    record(tmp_path / 'rig', N, storage=Storage(compression='none', split_mb=SPLIT_MB))
    last = files(tmp_path / 'rig')[-1]
    if left is None:
        last.unlink()
    else:
        cut(last, left)
    out = recover(tmp_path / 'rig').directory
    assert out == tmp_path / 'rig_recovered'
    bag = Bag(out)
    assert bag.is_whole
    assert (bag.end_ns, len(bag.parts)) == ((2 * CHUNK_TICKS - 1) * STEP_NS, 3)
    assert (bag.parts[2].number, bag.parts[2].n_messages) == ('2', 0)
    with AnyReader([out]) as reader:
        assert reader.message_count == bag.n_messages


def test_the_original_stays_as_it_is_and_the_user_is_told(
        killed: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = contents(killed)
    assert main(['recover', str(killed)]) == 0
    assert contents(killed) == before
    n_messages = len(list(expected(2 * CHUNK_TICKS)))
    assert capsys.readouterr().out == (
        f'{killed}_recovered\n{n_messages} messages up to t = 0.099000 s recovered; 1000 bytes '
        'of an incomplete record after it are lost\n')


def test_in_place_only_the_incomplete_file_and_the_metadata_change(tmp_path: Path) -> None:
    record(tmp_path / 'rig', N, storage=Storage(compression='none', split_mb=SPLIT_MB))
    (tmp_path / 'rig' / 'state_7.json').write_text('{}')
    record(tmp_path / 'same' / 'rig', N, storage=Storage(compression='none', split_mb=SPLIT_MB))
    last = files(tmp_path / 'rig')[-1]
    cut(last, last.stat().st_size - 100)    # behind the last chunk: nothing is lost
    kept = [path.stat().st_ino for path in files(tmp_path / 'rig')[:-1]]
    assert main(['recover', str(tmp_path / 'rig'), '--in-place']) == 0
    assert contents(tmp_path / 'rig') == (
        contents(tmp_path / 'same' / 'rig') | {'state_7.json': b'{}'})
    assert [path.stat().st_ino
            for path in files(tmp_path / 'rig')[:-1]] == kept


def test_a_full_disk_leaves_the_original_in_place(killed: Path) -> None:
    before = contents(killed)
    with limited_files(50_000), pytest.raises(OSError, match='File too large'):
        recover(killed, in_place=True)
    assert contents(killed) == before
    with limited_files(50_000), pytest.raises(OSError, match='File too large'):
        recover(killed)
    assert not (killed.parent / 'rig_recovered').exists()


def test_a_whole_bag_is_left_alone(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    record(tmp_path / 'rig', 3)
    assert main(['recover', str(tmp_path / 'rig')]) == 0
    assert capsys.readouterr().out == (
        f'{tmp_path / "rig"} is whole: there is nothing to recover\n')
    assert [path.name for path in tmp_path.iterdir()] == ['rig']


def test_lost_metadata_is_written_anew(tmp_path: Path) -> None:
    record(tmp_path / 'rig', 3)
    metadata = tmp_path / 'rig' / 'metadata.yaml'
    text = metadata.read_text()
    for broken in ('', text.replace('message_count: 3', 'message_count: 2')):
        metadata.write_text(broken)
        recover(tmp_path / 'rig', in_place=True)
        assert metadata.read_text() == text
    metadata.unlink()
    recover(tmp_path / 'rig', in_place=True)
    assert metadata.read_text() == text


def test_a_file_alone_becomes_a_bag(killed: Path, tmp_path: Path) -> None:
    path = killed / 'rig_0.mcap'
    out = recover(path).directory
    assert out == killed / 'rig_0_recovered'
    with Reader(out) as reader:
        assert reader.message_count == Bag(path).n_messages
    with pytest.raises(BagError, match='rig_0.mcap: is not a directory; --in-place'):
        recover(path, in_place=True)


def test_an_existing_directory_is_not_written_to(killed: Path, tmp_path: Path) -> None:
    (tmp_path / 'rig_recovered').mkdir()
    with pytest.raises(BagError, match='rig_recovered already exists; --out names another'):
        recover(killed)
    assert not any((tmp_path / 'rig_recovered').iterdir())
    with pytest.raises(BagError, match='already exists'):
        recover(killed, killed)


def test_a_bag_without_a_complete_chunk_has_nothing_to_recover(killed: Path) -> None:
    path = killed / 'rig_0.mcap'
    chunk = of(path.read_bytes()[:-1000] + bytes(8), Opcode.CHUNK)[0]
    for size, expected_text in (
            (chunk.start + 500, 'has no complete chunk, so there is nothing to recover'),
            (200, 'was not recorded by isa_ros, or is cut short in its head')):
        cut(path, size)
        with pytest.raises(BagError, match=expected_text):
            recover(killed)


def test_a_file_of_a_split_bag_is_not_recovered_alone(tmp_path: Path) -> None:
    record(tmp_path / 'rig', N, storage=Storage(compression='none', split_mb=SPLIT_MB))
    for number in range(2):
        with pytest.raises(BagError, match=(
                f'rig_{number}.mcap: is file {number} of a split bag, recover its directory')):
            recover(tmp_path / 'rig' / f'rig_{number}.mcap')


def test_damage_is_refused_and_not_copied(killed: Path) -> None:
    path = killed / 'rig_0.mcap'
    data = bytearray(path.read_bytes())
    data[of(bytes(data[:-1000]) + bytes(8), Opcode.CHUNK)[0].start + 5000] ^= 1
    path.write_bytes(data)
    with pytest.raises(BagError, match='CRC of a chunk is wrong'):
        recover(killed)
    assert not (killed.parent / 'rig_recovered').exists()


def test_a_chunk_that_is_hidden_is_noticed(killed: Path) -> None:
    """A bag cut short has no checksum of the whole: the index behind a chunk tells."""
    path = killed / 'rig_0.mcap'
    data = path.read_bytes()
    first, second = of(data[:-1000] + bytes(8), Opcode.CHUNK)
    for start, opcode in ((first.start, 0x86), (second.start, 0x86), (first.start, 0x07),
                          (second.start, 0x08), (second.start, 0x0e)):
        path.write_bytes(data[:start] + bytes([opcode]) + data[start + 1:])
        with pytest.raises(BagError, match='index that is not of the chunk|of a summary among'):
            Bag(killed)


@pytest.mark.parametrize('in_place', [False, True])
def test_lost_bytes_and_times_of_a_split_bag_are_those_of_its_last_file(
        tmp_path: Path, in_place: bool) -> None:
    """Which has no chunk: it begins at no time, and what was cut off lies in it."""
    record(tmp_path / 'rig', N, storage=Storage(compression='none', split_mb=SPLIT_MB))
    last = files(tmp_path / 'rig')[-1]
    chunk, = of(last.read_bytes(), Opcode.CHUNK)
    cut(last, chunk.start + 777)
    found = recover(tmp_path / 'rig', in_place=in_place)
    assert found.lost_bytes == 777
    listed = yaml.safe_load((found.directory / 'metadata.yaml').read_text())[
        'rosbag2_bagfile_information']['files']
    starts = [file['starting_time']['nanoseconds_since_epoch'] for file in listed]
    assert starts == [0, CHUNK_TICKS * STEP_NS, NO_START]
    assert [file['message_count'] for file in listed][-1] == 0


def test_in_place_the_new_file_is_on_the_disk_before_it_replaces_the_old_one(
        killed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Else a loss of power could leave neither."""
    steps, path = [], killed / 'rig_0.mcap'
    wait, replace = os.fsync, Path.replace

    def synced(descriptor: int) -> None:
        wait(descriptor)
        steps.append(('fsync', os.fstat(descriptor).st_ino))

    def replaced(own: Path, target: Path) -> Path:
        steps.append(('replace', own.stat().st_ino))
        return replace(own, target)
    monkeypatch.setattr(os, 'fsync', synced)
    monkeypatch.setattr(Path, 'replace', replaced)
    recover(killed, in_place=True)
    new = path.stat().st_ino
    assert steps.index(('fsync', new)) < steps.index(('replace', new))
    assert steps[steps.index(('replace', new)) + 1] == ('fsync', killed.stat().st_ino)
