"""Rows of the groups from the results of runs."""

from isa_ros.bench import leg, memory, startup
from isa_ros.bench.loading import Loading
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
    loads = Loading(floor=0.5, floor_bytes=45 * MIB, imports=1.0, kernels=0.25)
    monkeypatch.setattr(startup, 'median_loading', lambda: loads)
    monkeypatch.setattr(memory, 'median_loading', lambda: loads)


def test_a_missed_aim_says_where_the_tick_goes(monkeypatch):
    """Half of 1000 us in each phase; 1500 us of processor time is 3/4 of two cores."""
    monkeypatch.setattr(leg, 'pipe_exchange', lambda: 100e-6)
    monkeypatch.setattr(leg, 'actuators_alone', lambda: 70e-6)
    monkeypatch.setattr('isa_ros.bench.leg.cores', lambda: 2)
    outcomes = Outcomes({leg.IN_PROCESSES: [ran(1000.0, 3)], leg.IN_ONE_PROCESS: [ran(5000.0)]})
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


def test_memory_is_that_of_all_processes(loading):
    """80 MiB for the coordinator, 50 for each actuator; the floor is half of the latter."""
    rows = by_name(memory.memory_rows(Outcomes({
        leg.IN_PROCESSES: [ran(1000.0, 3)], leg.IN_ONE_PROCESS: [ran(4000.0)]})))
    assert rows['leg, processes: all together, proportional'].value == pytest.approx(230.0)
    assert rows['leg, processes: an actuator, resident'].ratio == pytest.approx(0.5)


def test_start_up_is_the_sum_of_its_parts(loading):
    rows = by_name(startup.startup_rows(Outcomes({
        leg.IN_PROCESSES: [ran(1000.0, 3, startup=3.0), ran(1000.0, 3, startup=6.0),
                           ran(1000.0, 3, startup=5.0)]})))
    total = rows['the leg, processes: to tick 0']
    assert (total.lowest, total.value, total.highest) == (3.0, 5.0, 6.0)
    assert total.is_reached is False and 'waiting for actuators to join 3.75 s' in total.note
    assert rows['imports'].ratio == pytest.approx(0.25)
