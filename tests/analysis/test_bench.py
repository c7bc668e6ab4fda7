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


def test_error_of_the_cylinder_stands_beside_its_speed(monkeypatch):
    """Against a finer solution, in metres, and as a ratio to the nanometre."""
    monkeypatch.setattr(bench, 'HOLDS', 200)
    speed, error = bench.cylinder_rows()[1:]
    assert speed.value > 0.0 and speed.ratio > 0.0
    assert 0.0 < error.value < 1e-9
    assert error.ratio == pytest.approx(1e-9 / error.value)


def test_processor_time_does_not_count_waiting(monkeypatch):
    """The other clock, and only that one."""
    clock = iter(range(100))
    monkeypatch.setattr(bench.time, 'process_time', lambda: 3.0 * next(clock))
    assert bench.seconds(lambda: None, per=6, of_cpu=True) == pytest.approx(0.5)
