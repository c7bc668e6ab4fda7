"""Rows that are measured in this process: positive, and consistent with each other."""

from isa_ros.bench import plant, tick
from isa_ros.bench.parts import divided, in_turn, misfits, Work
from isa_ros.bench.row import Row
from isa_ros.bench.spec import parts_of_median
from isa_ros.bench.watch import FirstLaps, Watch
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.run.pacing import JOINING, STARTING
from isa_ros.tick.tick_loop import BEFORE_TICKS
import pytest


def test_parts_of_a_tick_add_up(monkeypatch):
    """Every part has a time; with the remainder, the shares are of the whole."""
    monkeypatch.setattr(tick, 'TICKS', 20)
    whole, *parts = tick.tick_parts()
    assert all(row.value > 0.0 for row in (whole, *parts[:-1]))
    assert sum(row.ratio for row in parts) == pytest.approx(1.0)
    assert (parts[-1].name, parts[-1].most_share) == ('of it not covered', tick.SHARE)


def test_messages_of_each_second_are_packed_once_a_second(monkeypatch):
    """In 1500 ticks of 1 ms twice at most, whatever tick they begin with."""
    monkeypatch.setattr(tick, 'TICKS', 1500)
    packed = []

    class Packer:
        def pack(self, t_ns, tick_start_ns, tuned):
            packed.append((t_ns, tick_start_ns))

        def all_messages(self):
            pass
    tick.packing(Packer(), 1_000_000)()
    assert len(packed) == 1500 and all(end - start == 1_000_000 for end, start in packed)
    assert sum(end % NS_PER_SECOND == 0 for end, _ in packed) == 1


@pytest.mark.parametrize('spent, is_refused', [(80e-6, False), (70e-6, True), (130e-6, True)])
def test_parts_that_leave_too_much_are_refused(spent, is_refused):
    """Of 100 us a quarter may be left, or be too much."""
    rows = divided(Row('a tick', 100.0, 'us'), {'kernels': 10e-6, 'rest': spent - 10e-6}, 0.25)
    assert [row.part_of for row in rows] == ['a tick'] * 3
    assert rows[-1].value == pytest.approx(100.0 - 1e6 * spent)
    assert rows[0].ratio == pytest.approx(0.1)
    lines = misfits(rows)
    assert len(lines) == is_refused
    assert all('must be within 25%' in line for line in lines)


def test_error_of_the_cylinder_stands_beside_its_speed(monkeypatch):
    """Against a finer solution, in metres, and as a ratio to the nanometre."""
    monkeypatch.setattr(plant, 'HOLDS', 200)
    speed, error = plant.cylinder_rows()[1:]
    assert speed.value > 0.0 and speed.ratio > 0.0
    assert 0.0 < error.value < 1e-9
    assert error.ratio == pytest.approx(1e-9 / error.value)


def test_the_parts_of_the_median_run_add_up_where_medians_of_parts_do_not():
    """Three runs of 10, 20 and 30; of two their mean."""
    many = [{'a': 1.0, 'b': 9.0}, {'a': 15.0, 'b': 5.0}, {'a': 7.0, 'b': 23.0}]
    assert parts_of_median([10.0, 20.0, 30.0], many) == {'a': 15.0, 'b': 5.0}
    assert parts_of_median([20.0, 30.0], many[1:]) == {'a': 11.0, 'b': 14.0}
    assert parts_of_median([30.0, 10.0], [many[2], many[0]]) == {'a': 4.0, 'b': 16.0}


def test_parts_of_a_start_up_are_in_its_unit():
    rows = divided(Row('to tick 0', 2.0, 's'), {'imports': 1.5}, 0.3, '')
    assert [(row.name, row.value, row.unit) for row in rows] == [
        ('imports', 1.5, 's'), ('not covered', 0.5, 's')]


def test_each_work_is_measured_by_its_clock():
    """One clock stands still, the other goes on by 3 s with each look at it."""
    clock = iter(range(0, 1000, 3))
    times = in_turn({'still': Work(lambda: None, clock=lambda: 7.0),
                     'moving': Work(lambda: None, clock=lambda: float(next(clock)))}, 6)
    assert times == {'still': 0.0, 'moving': 0.5}


def test_a_start_up_is_measured_from_the_start_of_the_process():
    """Its parts begin later, so that what is between is in none of them."""
    watch = Watch({'interpreter': 1.5}, 10.0)
    watch._begun, watch._factor = 12.0, 0.5
    watch._laps.first = {STARTING: 13.0, JOINING: 14.5, BEFORE_TICKS: 17.0}
    found = watch.measured(100)
    assert found.to_tick_0 == 7.0 and found.ticks_per_s == 500.0
    assert list(found.startup.values()) == [1.5, 1.0, 1.5, 2.5]


def test_laps_between_ticks_do_not_count_what_was_before_the_first(monkeypatch):
    """The first ends the start-up; the second, 0.25 s later, is of the ticks."""
    now = iter([0.0, 5.0, 6.0, 6.25])
    laps = FirstLaps()
    monkeypatch.setattr(laps, '_now', lambda: next(now))
    laps._last = laps._now()
    for phase in (BEFORE_TICKS, 'quiet ticks', BEFORE_TICKS):
        laps.lap(phase)
    assert laps.spent == {BEFORE_TICKS: 0.25, 'quiet ticks': 1.0}
    assert laps.spent_before['coordinator'] > 0.0
