"""The bench's own arithmetic; how fast anything is, is no test."""

from isa_ros.analysis import bench
import pytest


def test_seconds_is_the_median_of_one_piece(monkeypatch):
    """Each repetition's time over its pieces; one slow repetition does not matter."""
    durations = iter([1.0, 2.0, 3.0, 100.0, 2.0, 2.0, 1.0])
    clock = [0.0]
    calls = []

    def work() -> None:
        if calls:  # the first call is the warm-up
            clock[0] += next(durations)
        calls.append(None)
    monkeypatch.setattr(bench.time, 'perf_counter', lambda: clock[0])
    assert bench.seconds(work, per=4) == pytest.approx(0.5)
    assert len(calls) == bench.REPEATS + 1


def test_parts_of_a_tick_add_up(monkeypatch):
    """Every part has a time, and the shares are of their sum."""
    monkeypatch.setattr(bench, 'TICKS', 20)
    rows = bench.tick_parts()
    assert all(row.value > 0.0 for row in rows)
    assert sum(row.ratio for row in rows) == pytest.approx(1.0)
