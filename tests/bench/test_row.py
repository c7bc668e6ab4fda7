"""A row's own arithmetic; speeds are not tested."""

from isa_ros.bench import row
from isa_ros.bench.row import Aim, Row
import pytest


def test_seconds_is_the_median_of_one_piece(monkeypatch):
    """Each repetition's time over its pieces; one slow repetition has no influence."""
    durations = iter([1.0, 2.0, 3.0, 100.0, 2.0, 2.0, 1.0])
    clock = [0.0]
    calls = []

    def work() -> None:
        if calls:  # the first call is the warm-up
            clock[0] += next(durations)
        calls.append(None)
    monkeypatch.setattr(row.time, 'perf_counter', lambda: clock[0])
    assert row.seconds(work, per=4) == pytest.approx(0.5)
    assert len(calls) == row.REPEATS + 1


def test_processor_time_does_not_count_waiting(monkeypatch):
    """Only the processor's clock is used."""
    clock = iter(range(100))
    monkeypatch.setattr(row.time, 'process_time', lambda: 3.0 * next(clock))
    assert row.seconds(lambda: None, per=6, of_cpu=True) == pytest.approx(0.5)


def test_a_row_of_several_runs_shows_their_median_and_extremes():
    speed = Row.of('leg', [3.0, 1.0, 2.0], 'ticks/s')
    assert (speed.value, speed.lowest, speed.highest) == (2.0, 1.0, 3.0)


@pytest.mark.parametrize('value, aim, expected', [
    (4.0, Aim(4.0), True), (3.9, Aim(4.0), False),
    (4.0, Aim(4.0, is_most=True), True), (4.1, Aim(4.0, is_most=True), False),
    (None, Aim(4.0), None), (5.0, None, None)])
def test_an_aim_is_reached_on_its_side_only(value, aim, expected):
    assert Row('x', value, 's', aim=aim).is_reached is expected
