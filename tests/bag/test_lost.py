"""Files of a bag that others remove, move, replace or truncate during the run."""

from collections.abc import Callable
import os
from pathlib import Path
import shutil

from isa_ros.bag.part_writer import CHUNK_TICKS
from isa_ros.bag.reader import Bag
from isa_ros.bag.storage import Storage
from isa_ros.bag.writer import BagWriter
from isa_ros.errors import RunError
import pytest
from tests.bag.recorded import PROVENANCE, STEP_NS, tick_messages, TOPICS, wait_for_disk

SPLIT = Storage(compression='none', split_mb=0.001)
GONE = 'the file was removed or moved during the run'


def removed(path: Path) -> None:
    path.unlink()


def moved(path: Path) -> None:
    path.rename(path.with_name('elsewhere'))


def directory_moved(path: Path) -> None:
    path.parent.rename(path.parent.with_name('elsewhere'))


def replaced(path: Path) -> None:
    """Put an equal copy in its place: what is written from now on is not in it."""
    shutil.copyfile(path, path.with_name('copy'))
    path.with_name('copy').replace(path)


def truncated(path: Path) -> None:
    os.truncate(path, path.stat().st_size - 1000)


def appended(path: Path) -> None:
    with path.open('ab') as file:
        file.write(b'mine')


FAULTS = pytest.mark.parametrize('fault, reason', [
    (removed, GONE), (moved, GONE), (directory_moved, GONE),
    (replaced, 'another file took its place during the run'),
    (truncated, r'the file has \d+ bytes instead of the \d+ written: it was changed'),
    (appended, r'the file has \d+ bytes instead of the \d+ written: it was changed')])


def started(directory: Path, storage: Storage | None = None) -> BagWriter:
    """Return a writer whose first chunk is on disk."""
    options = {} if storage is None else {'storage': storage}
    writer = BagWriter(directory, TOPICS, PROVENANCE, **options)
    for tick in range(CHUNK_TICKS):
        writer.write_tick(tick * STEP_NS, tick, tick_messages(tick))
    wait_for_disk(directory, lambda bag: bag.n_messages > 0)
    return writer


@FAULTS
def test_a_lost_file_ends_the_run_at_a_chunk(
        tmp_path: Path, fault: Callable[[Path], None], reason: str) -> None:
    """At the next chunk, or one later where the thread was about to write that one."""
    writer = started(tmp_path / 'rig')
    fault(writer.path)
    with pytest.raises(RunError, match=rf'^{writer.path}: cannot record, {reason}'):
        for tick in range(CHUNK_TICKS, 4 * CHUNK_TICKS):
            writer.write_tick(tick * STEP_NS, tick, tick_messages(tick))
    with pytest.raises(RunError, match=reason):
        writer.close()


@FAULTS
def test_a_lost_file_is_an_error_of_closing(
        tmp_path: Path, fault: Callable[[Path], None], reason: str) -> None:
    """Exit code 3, also of a run that was shorter than a chunk."""
    writer = BagWriter(tmp_path / 'rig', TOPICS, PROVENANCE)
    writer.write_tick(0, 0, tick_messages(0))
    fault(writer.path)
    with pytest.raises(RunError, match=reason) as refused:
        writer.close()
    assert refused.value.exit_code == 3 and '\n' not in str(refused.value)


def test_a_truncated_file_is_left_readable_up_to_its_last_whole_chunk(tmp_path: Path) -> None:
    """Nothing is appended behind the gap."""
    writer = started(tmp_path / 'rig')
    size = writer.path.stat().st_size
    for tick in range(CHUNK_TICKS, 2 * CHUNK_TICKS):
        writer.write_tick(tick * STEP_NS, tick, tick_messages(tick))
    wait_for_disk(tmp_path / 'rig', lambda bag: bag.end_ns == (2 * CHUNK_TICKS - 1) * STEP_NS)
    os.truncate(writer.path, size + 1000)
    left = writer.path.read_bytes()
    with pytest.raises(RunError):
        writer.close()
    assert writer.path.read_bytes() == left
    bag = Bag(tmp_path / 'rig')
    assert (bag.end_ns, bag.is_whole) == ((CHUNK_TICKS - 1) * STEP_NS, False)


@pytest.mark.parametrize('fault', [removed, moved, replaced, truncated])
def test_an_earlier_file_of_a_split_bag_is_missed(
        tmp_path: Path, fault: Callable[[Path], None]) -> None:
    """And the last one is finished all the same."""
    writer = started(tmp_path / 'rig', SPLIT)
    writer.write_tick(CHUNK_TICKS * STEP_NS, CHUNK_TICKS, tick_messages(CHUNK_TICKS))
    fault(writer.path)
    with pytest.raises(RunError, match='rig_0.mcap: cannot record, '):
        writer.close()
    assert Bag(tmp_path / 'rig' / 'rig_1.mcap').is_whole


def test_an_earlier_file_is_missed_when_the_next_begins(tmp_path: Path) -> None:
    writer = started(tmp_path / 'rig', SPLIT)
    with pytest.raises(RunError, match=f'rig_0.mcap: cannot record, {GONE}'):
        for tick in range(CHUNK_TICKS, 3 * CHUNK_TICKS):
            writer.write_tick(tick * STEP_NS, tick, tick_messages(tick))
            if tick == CHUNK_TICKS:
                writer.path.unlink()
    assert tick == 2 * CHUNK_TICKS
