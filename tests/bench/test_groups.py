"""Rows of the groups from the results of runs."""

from isa_ros.bench import growth, leg, memory, startup
from isa_ros.bench.loading import Loading
from isa_ros.bench.rounds import Outcomes
from isa_ros.bench.spec import ONE_PROCESS, PROCESSES
import pytest
from tests.bench.told import MIB, told


def by_name(rows):
    """Return the rows by name; names are unique in a group, and parts in a row."""
    assert len({(row.part_of, row.name) for row in rows}) == len(rows)
    return {row.name: row for row in rows}


@pytest.fixture
def loading(monkeypatch):
    """Return the modules an actuator loads, without starting one."""
    loads = Loading(floor=0.5, floor_bytes=45 * MIB, imports=1.0, kernels=0.25)
    monkeypatch.setattr(startup, 'median_loading', lambda: loads)
    monkeypatch.setattr(memory, 'median_loading', lambda: loads)


def test_a_missed_aim_says_where_the_tick_goes(monkeypatch):
    """Half of 1000 us in each phase; 1500 us of processor time is 3/4 of two cores."""
    monkeypatch.setattr(leg, 'pipe_exchange', lambda: 100e-6)
    monkeypatch.setattr(leg, 'actuator_parts', lambda: {'plant': 60e-6, 'messages': 10e-6})
    monkeypatch.setattr('isa_ros.bench.limits.cores', lambda: 2)
    outcomes = Outcomes({leg.IN_PROCESSES: [told(1000.0, 3)], leg.IN_ONE_PROCESS: [told(5000.0)]})
    rows = leg.leg_rows(outcomes)
    missed = [row for row in rows if row.is_reached is False]
    assert [row.name for row in missed] == ['leg, processes']
    assert 'actuators 500 us' in missed[0].note and 'together 75% of 2 cores' in missed[0].note
    assert [row.name for row in rows if row.is_reached] == ['leg, one process']
    parts = [row for row in rows if row.part_of == 'leg, processes']
    assert [row.value for row in parts if row.name.startswith('of it')] == pytest.approx(
        [500.0, 500.0])
    # 100 us of the 200 us tick in one process are the actuators': the rest of them is ROS.
    assert by_name(rows)['of its actuators ROS: publishing and receiving'].value == (
        pytest.approx(30.0))


def test_twelve_actuators_have_aims_and_what_was_not_run_says_so():
    twelve = [next(s for s in specs if s.plant == '12')
              for specs in (growth.IN_ONE_PROCESS, growth.IN_PROCESSES)]
    rows = by_name(growth.growth_rows(Outcomes({spec: [told(700.0, 12)] for spec in twelve})))
    assert rows['12 actuators, one process'].is_reached is False
    assert rows['12 actuators, processes'].is_reached is True
    assert rows['24 actuators, processes'].value is None


def test_one_actuator_more_costs_what_its_process_has(loading):
    """80 MiB for the coordinator, 50 for each actuator, from 1 to 12."""
    one, twelve = (next(s for s in growth.IN_PROCESSES if s.plant == n) for n in ('1', '12'))
    rows = by_name(memory.memory_rows(Outcomes({
        one: [told(900.0, 1)], twelve: [told(300.0, 12)],
        leg.IN_PROCESSES: [told(1000.0, 3)], leg.IN_ONE_PROCESS: [told(4000.0)]})))
    assert rows['one actuator more, in processes, 1 to 12'].value == pytest.approx(50.0)
    assert rows['leg, processes: all together, proportional'].value == pytest.approx(230.0)
    assert rows['leg, processes: an actuator, resident'].ratio == pytest.approx(0.5)


def test_start_up_is_the_sum_of_its_parts(loading):
    rows = by_name(startup.startup_rows(Outcomes({
        leg.IN_PROCESSES: [told(1000.0, 3, startup=3.0), told(1000.0, 3, startup=6.0),
                           told(1000.0, 3, startup=5.0)]})))
    total = rows['the leg, processes: to tick 0']
    assert (total.lowest, total.value, total.highest) == (3.0, 5.0, 6.0)
    assert total.is_reached is False and 'waiting for actuators to join 3.75 s' in total.note
    assert rows['imports'].ratio == pytest.approx(0.25)


def test_24_processes_are_left_out_where_memory_is_short(monkeypatch):
    monkeypatch.setattr(growth, 'available_memory', lambda: 13 * growth.PROCESS_BYTES)
    wanted = growth.specs()
    assert {s.plant for s in wanted if s.way == PROCESSES} == {'1', '2', '3', '6', '12'}
    assert '24' in {s.plant for s in wanted if s.way == ONE_PROCESS}
