"""Rows of the groups from the results of runs."""

from dataclasses import replace

from isa_ros.bench import leg, memory, startup
from isa_ros.bench.loading import Loading
from isa_ros.bench.parts import misfits
from isa_ros.bench.rounds import Outcomes
import pytest
from tests.bench.artificial import MIB, ran


def by_name(rows):
    """Return the rows by name; names are unique in a group, and parts in a row."""
    assert len({(row.part_of, row.name) for row in rows}) == len(rows)
    return {row.name: row for row in rows}


@pytest.fixture
def loading(monkeypatch):
    """Return the modules an actuator loads, without starting one."""
    loads = Loading(floor=0.5, floor_bytes=45 * MIB, imports=1.0, kernels=0.25, whole=1.26)
    monkeypatch.setattr(startup, 'median_loading', lambda: loads)
    monkeypatch.setattr(memory, 'median_loading', lambda: loads)


def test_a_missed_aim_says_where_the_tick_goes(monkeypatch):
    """Half of 1000 us in each phase; 1500 us of processor time is 3/4 of two cores."""
    monkeypatch.setattr(leg, 'pipe_exchange', lambda: 100e-6)
    monkeypatch.setattr('isa_ros.bench.leg.cores', lambda: 2)
    outcomes = Outcomes({leg.IN_PROCESSES: [ran(1000.0, 3)], leg.IN_ONE_PROCESS: [ran(5000.0)]})
    rows = leg.leg_rows(outcomes)
    missed = [row for row in rows if row.is_reached is False]
    assert [row.name for row in missed] == ['leg, processes']
    assert 'actuators 500 us' in missed[0].note and 'together 75% of 2 cores' in missed[0].note
    assert [row.name for row in rows if row.is_reached] == ['leg, one process']
    parts = [row for row in rows if row.part_of == 'leg, processes']
    assert [row.value for row in parts if row.name.startswith('of it')] == pytest.approx(
        [500.0, 500.0, 0.0], abs=1e-9)
    assert not misfits(rows)


def test_laps_that_leave_too_much_of_a_tick_and_too_many_cores_are_refused(monkeypatch):
    """Of 1000 us 880 are in phases; 1500 us of processor time are more than one core has."""
    monkeypatch.setattr(leg, 'pipe_exchange', lambda: 100e-6)
    monkeypatch.setattr('isa_ros.bench.leg.cores', lambda: 1)
    short = replace(ran(1000.0, 3), phases={'actuators': 0.5e-3, 'recorder': 0.38e-3})
    outcomes = Outcomes({leg.IN_PROCESSES: [short], leg.IN_ONE_PROCESS: [ran(5000.0)]})
    assert misfits(leg.leg_rows(outcomes)) == [
        'leg, processes: of it not covered 120 us, +12% of a tick, must be within 10%',
        'leg, processes: 1 cores in use 150 %, +150% of all of them, must be within 102%']


def test_a_robot_in_processes_has_its_aim_and_the_parts_of_its_tick(monkeypatch):
    monkeypatch.setattr(leg, 'pipe_exchange', lambda: 100e-6)
    rows = leg.quadruped_rows(Outcomes({leg.TROTTING: [ran(800.0, 12), ran(950.0, 12),
                                                       ran(1100.0, 12)]}))
    assert rows[0].name == 'the quadruped, processes, recording, with its controller'
    assert (rows[0].value, rows[0].ratio) == pytest.approx((950.0, 0.95))
    assert rows[0].is_reached is False and 'actuators 526 us' in rows[0].note
    assert {row.part_of for row in rows[1:]} == {rows[0].name}
    assert by_name(rows)['of it recorder'].value == pytest.approx(0.5e6 / 950.0)


def test_memory_is_that_of_all_processes(loading):
    """80 MiB for the coordinator, 50 for each actuator; the floor is half of the latter."""
    rows = by_name(memory.memory_rows(Outcomes({
        leg.IN_PROCESSES: [ran(1000.0, 3)], leg.IN_ONE_PROCESS: [ran(4000.0)]})))
    assert rows['leg, processes: all together, proportional'].value == pytest.approx(230.0)
    assert rows['leg, processes: an actuator, resident'].ratio == pytest.approx(0.5)


def test_start_up_is_the_sum_of_its_parts(loading):
    rows = startup.startup_rows(Outcomes({
        leg.IN_PROCESSES: [ran(1000.0, 3, startup=3.0), ran(1000.0, 3, startup=6.0),
                           ran(1000.0, 3, startup=5.0)]}))
    total, = [row for row in rows if row.name == 'the leg, processes: to tick 0']
    assert (total.lowest, total.value, total.highest) == (3.0, 5.0, 6.0)
    assert total.is_reached is False and 'waiting for actuators to join 3.75 s' in total.note
    assert by_name([row for row in rows if row.part_of == total.name])[
        'imports'].ratio == pytest.approx(0.25)


def test_a_lone_actuator_is_measured_from_its_process_to_its_first_tick(loading):
    """Its whole, 1.26 s, is measured by itself: imports and kernels leave 0.01 s of it."""
    alone, *parts = [row for row in startup.startup_rows(Outcomes({}))
                     if 'an actuator alone' in row.name + row.part_of]
    assert (alone.value, alone.is_reached) == (1.26, False)
    assert alone.ratio == pytest.approx(0.5 / 1.26) and 'imports 1 s' in alone.note
    assert [(row.name, row.unit) for row in parts] == [
        ('imports', 's'), ('kernels from the cache', 's'), ('not covered', 's')]
    assert parts[-1].value == pytest.approx(0.01) and not misfits(parts)


def test_a_start_up_whose_parts_leave_more_is_refused(loading):
    """Of 3 s, measured from the start of the process, 0.2 s are in no part."""
    rows = startup.startup_rows(Outcomes({
        leg.IN_PROCESSES: [replace(ran(1000.0, 3, startup=2.8), to_tick_0=3.0)]}))
    line, = misfits(rows)
    assert line.startswith('the leg, processes: to tick 0: not covered 0.2 s, +7% of')
