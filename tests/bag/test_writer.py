"""The recorder: its bags in other readers, determinism, loss, and refusals."""

from contextlib import ExitStack
import hashlib
from pathlib import Path
import signal
import subprocess
import sys

from isa_ros.bag.part_writer import CHUNK_BYTES, CHUNK_TICKS
from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.core.topic import Topic
from isa_ros.errors import BagError, RunError
from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from mcap_ros2.decoder import DecoderFactory
import pytest
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader
from tests.bag.recorded import (
    expected, NAMES, PROVENANCE, record, STEP_NS, tick_messages, TOPICS, wait_for_disk)
from tests.full_disk import limited_files
import yaml

N = 1234  # ticks: two full chunks and a part


@pytest.fixture(scope='module')
def mcap(tmp_path_factory):
    """Return the MCAP file of a bag of N ticks."""
    return record(tmp_path_factory.mktemp('recorded') / 'rig', N)


def test_rosbag2_reader_reads_every_message(mcap):
    with Reader(mcap.parent) as reader:
        read = [(c.topic, t_ns, bytes(data)) for c, t_ns, data in reader.messages()]
    assert read == list(expected(N))


def test_any_reader_decodes_simulation_time(mcap):
    with AnyReader([mcap.parent]) as reader:
        topic = [c for c in reader.connections if c.topic == '/hip/valve']
        stamps = [
            reader.deserialize(data, c.msgtype).header.stamp
            for c, _, data in reader.messages(connections=topic)]
    assert [s.sec * 10**9 + s.nanosec for s in stamps] == [k * STEP_NS for k in range(N)]


def test_mcap_library_reads_it_in_order_with_valid_checksums(mcap):
    with mcap.open('rb') as file:
        read = [
            (channel.topic, message.log_time, message.data)
            for _, channel, message in make_reader(file, validate_crcs=True).iter_messages()]
    assert read == list(expected(N))


def test_data_section_checksum_holds(mcap):
    """The stream reader checks the CRC of DataEnd and of every chunk."""
    with mcap.open('rb') as file:
        kinds = [type(r).__name__ for r in StreamReader(file, validate_crcs=True).records]
    assert kinds[:5] == ['Header', 'Attachment', 'Attachment', 'Metadata', 'Metadata']
    assert kinds[-1] == 'Footer'


def test_times_and_sequence_are_the_ticks(mcap):
    with mcap.open('rb') as file:
        for _, _, message in make_reader(file).iter_messages():
            assert message.log_time == message.publish_time == message.sequence * STEP_NS


def test_schemas_decode_with_the_ros2_support_of_mcap(mcap):
    with mcap.open('rb') as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        decoded = [m.decoded_message for m in reader.iter_decoded_messages(['/hip/references'])]
    assert len(decoded) == N
    assert decoded[0].name[3] == 'hip/current'


def test_doctor_finds_nothing(mcap):
    doctor = Path(sys.executable).with_name('pymcap-cli')
    done = subprocess.run([doctor, 'doctor', mcap], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout


def test_summary_counts_what_was_written(mcap):
    with mcap.open('rb') as file:
        summary = make_reader(file).get_summary()
    counts = {
        summary.channels[k].topic: count
        for k, count in summary.statistics.channel_message_counts.items()}
    assert counts == {
        name: 13 if name == '/hip/applied_setpoint' else N for name in NAMES}
    assert summary.statistics.chunk_count == len(summary.chunk_indexes) == 3


def test_metadata_is_that_of_rosbag2_version_9(mcap):
    read = yaml.safe_load((mcap.parent / 'metadata.yaml').read_text())
    bag = read['rosbag2_bagfile_information']
    assert list(bag) == [
        'version', 'storage_identifier', 'duration', 'starting_time', 'message_count',
        'topics_with_message_count', 'compression_format', 'compression_mode',
        'relative_file_paths', 'files', 'custom_data', 'ros_distro']
    assert (bag['version'], bag['storage_identifier'], bag['ros_distro']) == (
        9, 'mcap', 'jazzy')
    assert bag['duration'] == {'nanoseconds': (N - 1) * STEP_NS}
    assert bag['starting_time'] == {'nanoseconds_since_epoch': 0}
    assert bag['relative_file_paths'] == ['rig_0.mcap']
    assert bag['files'] == [{
        'path': 'rig_0.mcap', 'starting_time': bag['starting_time'],
        'duration': bag['duration'], 'message_count': bag['message_count']}]
    assert bag['custom_data'] == PROVENANCE.record()


def test_quality_of_service_is_written_as_rosbag2_does(mcap):
    """rosbag2_storage convert<Rosbag2QoS>::encode: names, and infinite as 2^63 - 1 ns."""
    forever = {'sec': 9223372036, 'nsec': 854775807}
    profile = {
        'history': 'keep_last', 'depth': 10, 'reliability': 'reliable',
        'durability': 'volatile', 'deadline': forever, 'lifespan': forever,
        'liveliness': 'automatic', 'liveliness_lease_duration': forever,
        'avoid_ros_namespace_conventions': False}
    read = yaml.safe_load((mcap.parent / 'metadata.yaml').read_text())
    topics = read['rosbag2_bagfile_information']['topics_with_message_count']
    kept = profile | {'durability': 'transient_local'}

    def offered(topic: str) -> list[dict[str, object]]:
        return [kept if '/applied_' in topic else profile]
    assert all(t['topic_metadata']['offered_qos_profiles'] == offered(t['topic_metadata']['name'])
               for t in topics)
    with mcap.open('rb') as file:
        channels = make_reader(file).get_summary().channels.values()
    assert all(
        yaml.safe_load(c.metadata['offered_qos_profiles']) == offered(c.topic) for c in channels)
    assert {c.topic: c.metadata['topic_type_hash'] for c in channels} == {
        t['topic_metadata']['name']: t['topic_metadata']['type_description_hash']
        for t in topics}


def test_same_run_gives_the_same_bytes_in_another_directory(mcap, tmp_path):
    again = record(tmp_path / 'elsewhere', N)
    digests = {hashlib.sha256(path.read_bytes()).hexdigest() for path in (mcap, again)}
    assert len(digests) == 1


def test_provenance_and_metadata_are_there_before_the_first_tick(tmp_path):
    BagWriter(tmp_path / 'rig', TOPICS, PROVENANCE)
    assert Bag(tmp_path / 'rig').provenance == PROVENANCE
    read = yaml.safe_load((tmp_path / 'rig' / 'metadata.yaml').read_text())
    bag = read['rosbag2_bagfile_information']
    assert bag['message_count'] == 0
    assert [t['topic_metadata']['name'] for t in bag['topics_with_message_count']] == NAMES


def test_bag_without_a_tick_is_readable(tmp_path):
    record(tmp_path / 'rig', 0)
    with Reader(tmp_path / 'rig') as reader:
        assert reader.message_count == 0
    assert Bag(tmp_path / 'rig').is_whole


def test_chunk_ends_after_500_ticks_and_is_on_disk(tmp_path):
    writer = BagWriter(tmp_path / 'rig', TOPICS, PROVENANCE)
    clock = [(0, tick_messages(0)[0][1])]
    for tick in range(CHUNK_TICKS - 1):
        writer.write_tick(tick * STEP_NS, tick, clock)
    assert Bag(tmp_path / 'rig').n_messages == 0
    writer.write_tick((CHUNK_TICKS - 1) * STEP_NS, CHUNK_TICKS - 1, clock)
    wait_for_disk(tmp_path / 'rig', lambda bag: bag.n_messages == CHUNK_TICKS)


def test_chunk_ends_with_the_tick_that_reaches_a_mebibyte(tmp_path):
    writer = BagWriter(tmp_path / 'rig', [Topic('/text', 'std_msgs/msg/String')], PROVENANCE)
    half = CHUNK_BYTES // 2
    writer.write_tick(0, 0, [(0, bytes(half - 1000))])
    writer.write_tick(STEP_NS, 1, [(0, bytes(half - 1000))])
    assert Bag(tmp_path / 'rig').n_messages == 0
    writer.write_tick(2 * STEP_NS, 2, [(0, bytes(2000))])
    wait_for_disk(tmp_path / 'rig', lambda bag: bag.n_messages == 3)


def test_kill_leaves_all_but_the_last_two_chunks(tmp_path):
    """The chunk that is being filled, and the one that the thread is writing."""
    script = (
        'import os, signal\n'
        'from pathlib import Path\n'
        'from isa_ros.bag.writer import BagWriter\n'
        'from tests.bag.recorded import *\n'
        f'writer = BagWriter(Path({str(tmp_path / "rig")!r}), TOPICS, PROVENANCE)\n'
        f'for tick in range({N}):\n'
        '    writer.write_tick(tick * STEP_NS, tick, tick_messages(tick))\n'
        'os.kill(os.getpid(), signal.SIGKILL)\n')
    root = Path(__file__).parents[2]
    done = subprocess.run([sys.executable, '-c', script], cwd=root, timeout=120)
    assert done.returncode == -signal.SIGKILL
    bag = Bag(tmp_path / 'rig')
    ticks = list(bag.ticks())
    assert not bag.is_whole
    assert N - 2 * CHUNK_TICKS <= len(ticks) < N
    assert [tick.sequence for tick in ticks] == list(range(len(ticks)))
    assert all(len(tick.messages) == len(tick_messages(tick.sequence)) for tick in ticks)
    assert bag.provenance == PROVENANCE


def test_full_disk_is_a_run_error_and_leaves_a_readable_bag(tmp_path):
    writer = BagWriter(tmp_path / 'rig', TOPICS, PROVENANCE)
    with limited_files(1_000_000):
        with pytest.raises(RunError, match=r'rig_0.mcap: cannot record, File too large'):
            for tick in range(2000):
                writer.write_tick(tick * STEP_NS, tick, tick_messages(tick))
        with pytest.raises(RunError, match='cannot record'):
            writer.write_tick(tick * STEP_NS, tick, tick_messages(tick))
        writer.close()
    bag = Bag(tmp_path / 'rig')
    assert bag.is_whole
    written = [t.sequence for t in bag.ticks()]
    assert written == list(range(len(written))) and len(written) % CHUNK_TICKS == 0
    # The chunk that did not fit, and at most the next one, which was filled meanwhile.
    assert 1 <= tick + 1 - len(written) - CHUNK_TICKS <= CHUNK_TICKS


def test_error_of_the_run_is_not_replaced_by_one_of_closing(tmp_path):
    with ExitStack() as limit, pytest.raises(KeyError):
        with BagWriter(tmp_path / 'rig', TOPICS, PROVENANCE):
            limit.enter_context(limited_files(100))
            raise KeyError('the run')


def test_topics_out_of_order_are_refused(tmp_path):
    with pytest.raises(BagError, match='topics = /hip/valve, '):
        BagWriter(tmp_path / 'rig', TOPICS[::-1], PROVENANCE)
    assert not (tmp_path / 'rig').exists()
