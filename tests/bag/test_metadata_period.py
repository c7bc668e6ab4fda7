"""How often metadata.yaml is written during a run: it takes as long as a tick."""

from pathlib import Path
from types import SimpleNamespace

from isa_ros.bag import writer as bag_writer
from isa_ros.bag.metadata import FILE_NAME
from isa_ros.bag.part_writer import CHUNK_TICKS
from isa_ros.bag.writer import BagWriter
import pytest
from tests.bag.recorded import PROVENANCE, STEP_NS, tick_messages, TOPICS, wait_for_disk

CHUNKS = 3


def writings(directory: Path) -> list[int]:
    """Return at which chunks metadata.yaml was replaced, and `CHUNKS` + 1 for the end."""
    path, found = directory / FILE_NAME, []
    with BagWriter(directory, TOPICS, PROVENANCE) as writer:
        known = path.stat().st_mtime_ns, path.stat().st_ino
        for tick in range(CHUNKS * CHUNK_TICKS):
            writer.write_tick(tick * STEP_NS, tick, tick_messages(tick))
            if (tick + 1) % CHUNK_TICKS == 0:
                wait_for_disk(directory, lambda bag: bag.end_ns == tick * STEP_NS)
                writer._end_writing()
                now = path.stat().st_mtime_ns, path.stat().st_ino
                if now != known:
                    found.append((tick + 1) // CHUNK_TICKS)
                known = now
    if (path.stat().st_mtime_ns, path.stat().st_ino) != known:
        found.append(CHUNKS + 1)
    return found


def test_it_is_written_at_the_begin_and_the_end_of_a_short_run(tmp_path: Path) -> None:
    """Its counts are needed once the bag is complete; before, the files have all."""
    assert bag_writer.METADATA_PERIOD_S >= 10.0
    assert writings(tmp_path / 'rig') == [CHUNKS + 1]


def test_it_is_written_at_the_chunk_after_its_period(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By the clock of the host: here each chunk takes half a period."""
    now = [0.0]

    def clock() -> float:
        now[0] += 0.5 * bag_writer.METADATA_PERIOD_S
        return now[0]
    monkeypatch.setattr(bag_writer, 'time', SimpleNamespace(monotonic=clock))
    assert writings(tmp_path / 'rig') == [2, CHUNKS + 1]
