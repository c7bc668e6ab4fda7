"""Ticks that a caller writes into the chunk by itself: the bag of a tick at a time."""

from pathlib import Path
from threading import Event, Timer

from isa_ros.bag.message_chunk import append
from isa_ros.bag.packed import layout, Packed
from isa_ros.bag.part_writer import CHUNK_BYTES, CHUNK_NS, CHUNK_TICKS, PartWriter, WAIT_NS
from isa_ros.bag.reader import Bag
from isa_ros.bag.storage import PLAIN, Storage
from isa_ros.bag.writer import BagWriter
from isa_ros.core.topic import Topic
from isa_ros.errors import RunError
from mcap.reader import make_reader
import pytest
from tests.bag.recorded import (
    contents, DEADLINE_S, PROVENANCE, record, STEP_NS, tick_messages, TOPICS)

N = 1234    # ticks: two full chunks and a part; at every hundredth another layout
TEXT = (Topic('/text', 'std_msgs/msg/String'),)
HEADER_BYTES = 31   # of a message record, in front of its CDR bytes


def write_stretch(writer: BagWriter, first: int, most: int, n_ticks: int) -> int:
    """Write up to ``most`` ticks of one layout from tick ``first`` on; return their number."""
    where = Packed.of(tick_messages(first)).layout
    room = writer.open_stretch(where, first * STEP_NS, STEP_NS)
    n = 0
    while n < min(most, room.n_ticks, n_ticks - first):
        packed = Packed.of(tick_messages(first + n))
        if len(packed) != len(where.topics):
            break
        append(room.buffer, room.at + n * room.tick_bytes, packed.block, where, first + n,
               (first + n) * STEP_NS)
        n += 1
    writer.close_stretch(n)
    return n


def record_stretches(
        directory: Path, most: int, *, storage: Storage = PLAIN, single: int = 0) -> Path:
    """Record N ticks, at most ``most`` at once; of ``single`` ticks each first by itself."""
    tick = 0
    with BagWriter(directory, TOPICS, PROVENANCE, storage=storage) as writer:
        while tick < N:
            if single and tick % single == 0:
                writer.write_tick(tick * STEP_NS, tick, tick_messages(tick))
                tick += 1
            else:
                tick += write_stretch(writer, tick, most, N)
    return directory


@pytest.mark.parametrize('most, single', [(1, 0), (7, 0), (1000, 0), (13, 17)])
@pytest.mark.parametrize('storage', [
    PLAIN, Storage(compression='zstd', split_mb=0.0),
    Storage(compression='lz4', split_mb=0.001)], ids=['plain', 'zstd', 'lz4, split'])
def test_stretches_give_the_files_of_single_ticks(tmp_path, most, single, storage):
    """In any number, also with ticks of `write_tick` between them."""
    record(tmp_path / 'one' / 'rig', N, storage=storage)
    found = record_stretches(tmp_path / 'many' / 'rig', most, storage=storage, single=single)
    expected = contents(tmp_path / 'one' / 'rig')
    assert contents(found) == expected
    assert len(expected) == (4 if storage.split_mb else 2)


@pytest.fixture
def writer(tmp_path):
    """Return the writer of a bag with one topic."""
    return BagWriter(tmp_path / 'rig', TEXT, PROVENANCE)


def of_bytes(n):
    """Return the layout of a tick with one message of ``n`` bytes."""
    return layout([0], [0], [n])


def test_room_ends_with_the_tick_that_completes_a_chunk(writer):
    """After 500 ticks, 0.5 s or 1 MiB, counted from the begin of the chunk."""
    start = 3 * STEP_NS
    assert writer.open_stretch(of_bytes(8), start, STEP_NS // 2).n_ticks == CHUNK_TICKS
    assert writer.open_stretch(of_bytes(8), start, STEP_NS).n_ticks == CHUNK_TICKS
    assert writer.open_stretch(of_bytes(8), start, 7 * STEP_NS).n_ticks == 73   # 72 * 7 >= 500
    assert writer.open_stretch(of_bytes(8), start, CHUNK_NS).n_ticks == 2
    assert writer.open_stretch(of_bytes(2 * CHUNK_BYTES), start, STEP_NS).n_ticks == 1


def test_room_is_less_by_what_the_chunk_has(writer):
    tick = bytes(CHUNK_BYTES // 4 - HEADER_BYTES)
    empty = writer.open_stretch(of_bytes(len(tick)), 0, STEP_NS)
    assert (empty.n_ticks, empty.tick_bytes) == (4, CHUNK_BYTES // 4)
    assert empty.at > 0     # behind schemas and channels
    writer.write_tick(0, 0, [(0, tick)])
    room = writer.open_stretch(of_bytes(len(tick)), STEP_NS, STEP_NS)
    assert (room.n_ticks, room.at) == (3, empty.at + CHUNK_BYTES // 4)
    assert writer.open_stretch(of_bytes(8), 400 * STEP_NS, STEP_NS).n_ticks == 101
    assert writer.open_stretch(of_bytes(8), 2 * CHUNK_NS, STEP_NS).n_ticks == 1
    writer.write_tick(STEP_NS, 1, [(0, b'12345678')])
    assert writer.open_stretch(of_bytes(8), 2 * STEP_NS, STEP_NS).n_ticks == CHUNK_TICKS - 2


def test_the_last_tick_of_a_room_completes_the_chunk(writer):
    """And none before it."""
    times, rooms = [k * CHUNK_NS // 2 for k in range(4)], []
    for tick, t_ns in enumerate(times):
        room = writer.open_stretch(of_bytes(8), t_ns, CHUNK_NS // 2)
        append(room.buffer, room.at, Packed.of([(0, b'12345678')]).block, of_bytes(8), tick, t_ns)
        rooms.append(room.n_ticks)
        writer.close_stretch(1)
    assert rooms[:3] == [3, 2, 1]
    writer.close()
    with writer.path.open('rb') as file:
        chunks = make_reader(file).get_summary().chunk_indexes
    assert [(chunk.message_start_time, chunk.message_end_time) for chunk in chunks] == [
        (times[0], times[2]), (times[3], times[3])]


def test_a_chunk_ends_only_once_the_one_before_is_in_the_file(writer, monkeypatch):
    """What a killed run loses is less than a second: 0.5 s in writing and 0.4 s in memory."""
    begun, go_on, write = Event(), Event(), PartWriter.write_chunk

    def slow(part, chunk):
        begun.set()
        assert go_on.wait(DEADLINE_S)
        write(part, chunk)
    monkeypatch.setattr(PartWriter, 'write_chunk', slow)
    for tick in range(CHUNK_TICKS + 3):
        writer.write_tick(tick * STEP_NS, tick, [(0, b'12345678')])
    assert begun.wait(DEADLINE_S)
    at = CHUNK_TICKS + 3, WAIT_NS // STEP_NS - 3
    assert writer.open_stretch(of_bytes(8), at[0] * STEP_NS, STEP_NS).n_ticks == at[1]
    writer.write_tick((sum(at) - 1) * STEP_NS, sum(at) - 1, [(0, b'12345678')])
    assert not Bag(writer.path.parent).n_messages
    Timer(0.1, go_on.set).start()
    writer.write_tick(sum(at) * STEP_NS, sum(at), [(0, b'12345678')])
    assert Bag(writer.path.parent).n_messages == CHUNK_TICKS


def test_a_stretch_of_no_ticks_is_nothing(writer):
    writer.open_stretch(of_bytes(8), 0, STEP_NS)
    writer.close_stretch(0)
    writer.close()
    assert Bag(writer.path.parent).n_messages == 0


def test_more_ticks_than_there_is_room_for_are_refused(writer):
    room = writer.open_stretch(of_bytes(8), 0, STEP_NS)
    with pytest.raises(ValueError, match='501 ticks in a stretch with room for 500'):
        writer.close_stretch(room.n_ticks + 1)
    with pytest.raises(ValueError, match='1 ticks in a stretch with room for 0'):
        writer.close_stretch(1)
    writer.open_stretch(of_bytes(8), 0, STEP_NS)
    with pytest.raises(ValueError, match='-1 ticks'):
        writer.close_stretch(-1)


def test_a_tick_of_its_own_ends_an_open_stretch(writer):
    """Its records are where the stretch had its room."""
    writer.open_stretch(of_bytes(8), 0, STEP_NS)
    writer.write_tick(0, 0, [(0, b'12345678')])
    with pytest.raises(ValueError, match='room for 0'):
        writer.close_stretch(1)


def test_an_open_stretch_is_not_in_the_bag(writer):
    """Closing records what was counted, and nothing of what may be half written."""
    writer.write_tick(0, 0, [(0, b'12345678')])
    room = writer.open_stretch(of_bytes(8), STEP_NS, STEP_NS)
    room.buffer[room.at:room.at + room.tick_bytes] = 255
    writer.close()
    bag = Bag(writer.path.parent)
    assert [message.data for message in bag.messages()] == [b'12345678'] and bag.is_whole


def test_a_lost_file_is_a_run_error_of_the_next_stretch(writer):
    """When it is opened or closed: the chunk before is written meanwhile."""
    large = Packed.of([(0, bytes(2 * CHUNK_BYTES))])

    def write(tick):
        room = writer.open_stretch(large.layout, tick * STEP_NS, STEP_NS)
        append(room.buffer, room.at, large.block, large.layout, tick, tick * STEP_NS)
        writer.close_stretch(1)
    writer.path.unlink()
    write(0)
    with pytest.raises(RunError, match='rig_0.mcap: cannot record, the file was removed'):
        write(1)
    with pytest.raises(RunError, match='cannot record'):
        writer.open_stretch(of_bytes(8), 2 * STEP_NS, STEP_NS)
