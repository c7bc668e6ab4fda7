"""A bag that is written through to the disk at each chunk."""

import os
from pathlib import Path

from isa_ros.bag.part_writer import CHUNK_TICKS
from isa_ros.bag.storage import Storage
from isa_ros.bag.writer import BagWriter
import pytest
from tests.bag.recorded import PROVENANCE, record, STEP_NS, tick_messages, TOPICS, wait_for_disk

Synced = list[tuple[int, int]]


@pytest.fixture
def synced(monkeypatch: pytest.MonkeyPatch) -> Synced:
    """Return (inode, size) of every file that the disk was waited for, as it was then."""
    found: Synced = []
    wait = os.fsync

    def noted(descriptor: int) -> None:
        wait(descriptor)
        status = os.fstat(descriptor)
        found.append((status.st_ino, status.st_size))

    monkeypatch.setattr(os, 'fsync', noted)
    return found


def sizes(synced: Synced, path: Path) -> list[int]:
    """Return the sizes that a file was synced with."""
    return [size for inode, size in synced if inode == path.stat().st_ino]


def test_every_chunk_is_on_the_disk_before_the_next(tmp_path: Path, synced: Synced) -> None:
    """The head, each chunk, and the end of the file."""
    on_disk = []
    with BagWriter(tmp_path / 'rig', TOPICS, PROVENANCE, is_synced=True) as writer:
        on_disk.append(writer.path.stat().st_size)
        for tick in range(3 * CHUNK_TICKS):
            writer.write_tick(tick * STEP_NS, tick, tick_messages(tick))
            if tick % CHUNK_TICKS == CHUNK_TICKS - 1:
                wait_for_disk(tmp_path / 'rig', lambda bag: bag.end_ns == tick * STEP_NS)
                on_disk.append(writer.path.stat().st_size)
    on_disk.append(writer.path.stat().st_size)
    assert sizes(synced, writer.path) == on_disk


def test_names_and_metadata_are_on_the_disk_too(tmp_path: Path, synced: Synced) -> None:
    """A file without its name would be lost."""
    directory = tmp_path / 'rig'
    record(directory, CHUNK_TICKS + 1, is_synced=True,
           storage=Storage(compression='none', split_mb=0.001))
    metadata = directory / 'metadata.yaml'
    assert sizes(synced, metadata)[-1:] == [metadata.stat().st_size]
    assert synced[-1][0] == directory.stat().st_ino
    for path in directory.glob('*.mcap'):
        assert sizes(synced, path)[-1] == path.stat().st_size
    assert synced[0][0] == directory.parent.stat().st_ino


def test_it_is_the_same_bag_without_waiting(tmp_path: Path, synced: Synced) -> None:
    plain = record(tmp_path / 'a' / 'rig', 700)
    assert synced == []
    assert record(tmp_path / 'b' / 'rig', 700, is_synced=True).read_bytes() == plain.read_bytes()
    assert (plain.with_name('metadata.yaml').read_bytes()
            == (tmp_path / 'b' / 'rig' / 'metadata.yaml').read_bytes())
