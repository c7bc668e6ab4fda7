"""What a run adds to its kernels, and how the ticks of both are made."""

from isa_ros.bench import over_kernels
from isa_ros.bench.advancing import Advancing, driving, keeping, kernels_alone
from isa_ros.bench.leg import IN_ONE_PROCESS
from isa_ros.bench.over_kernels import kernel_rows, logging, of_nodes, over, twelve
from isa_ros.bench.parts import misfits
from isa_ros.bench.rounds import Outcomes
from isa_ros.bench.row import Aim
from isa_ros.bench.tick import leg_drop
from isa_ros.errors import RunError
from isa_ros.scripting.run import load
from isa_ros.simulation import Simulation
import numpy as np
import pytest
from tests.bench.artificial import ran
from tests.surroundings.mass_on_spring import MassOnSpring

TIMES = {'a tick': 90e-6, 'kernels': 60e-6, 'kernels of quiet ticks': 54e-6,
         'what keeps their rows': 10e-6, 'ticks in Python': 20e-6}


def test_the_ratio_is_of_a_tick_to_its_kernels_and_parts_add_up():
    ratio, tick, *parts = over('leg, recording', TIMES, Aim(1.3, True))
    assert ratio.value == pytest.approx(1.5) and ratio.is_reached is False
    assert (tick.value, tick.unit) == (pytest.approx(90.0), 'us')
    assert [row.value for row in parts] == pytest.approx([54.0, 10.0, 20.0, 6.0])
    assert {row.part_of for row in (tick, *parts)} == {'leg, recording, over its kernels'}
    assert 'ticks in Python 20.0 us' in ratio.note
    assert not misfits(parts)


def test_a_reached_ratio_has_no_note_and_parts_that_leave_too_much_are_refused():
    ratio, _, *parts = over('leg', TIMES | {'what keeps their rows': 44e-6}, Aim(1.6, True))
    assert ratio.is_reached and not ratio.note
    line, = misfits(parts)
    assert line.startswith('leg, over its kernels: of it not covered -28 us, -31% of a tick')


def test_runs_on_nodes_are_compared_with_the_same_kernels():
    """Half of 200 us is the coordinator's; over 40 us of kernels."""
    outcomes = Outcomes({IN_ONE_PROCESS: [ran(5000.0), ran(5000.0), ran(2500.0)]})
    row, = of_nodes('leg', outcomes, IN_ONE_PROCESS, 40e-6)
    assert (row.lowest, row.value, row.highest) == pytest.approx((2.5, 2.5, 5.0))
    assert row.aim == Aim(1.3, True) and 'its kernels 40.0 us' in row.note
    assert of_nodes('leg', Outcomes({}), IN_ONE_PROCESS, 40e-6) == []


def test_each_row_of_the_issue_has_its_aim(monkeypatch):
    """The leg in memory and recording, twelve recording; twelve in memory has none."""
    monkeypatch.setattr(over_kernels, 'BEGUN', 20)
    monkeypatch.setattr(over_kernels, 'TICKS', 40)
    monkeypatch.setattr(over_kernels, 'DRIVEN', 10)
    rows = kernel_rows(Outcomes({spec: [ran(5000.0)] for spec in over_kernels.SPECS}))
    assert {row.name: row.aim.value for row in rows if row.aim is not None} == {
        'leg, in memory, over its kernels': 1.15, 'leg, recording, over its kernels': 1.3,
        'leg, nodes in one process, recording, over its kernels': 1.3,
        '12 actuators, recording, over its kernels': 1.2,
        '12 actuators, nodes in one process, recording, over its kernels': 1.2}
    ticks = [row for row in rows if row.name == 'a tick']
    assert len(ticks) == 4 and all(row.number > 0.0 for row in ticks)


def test_twelve_hold_their_positions_on_loads_of_their_own():
    names = [own.name for own in twelve().run.actuators]
    assert len(names) == 12 and names[0] == 'haa_1' and names[-1] == 'kfe_4'


def test_a_run_without_a_pace_has_the_ticks_of_one_that_is_stepped():
    """The same samples, with stretches between the ticks that Python drives."""
    advanced, stepped = Simulation(leg_drop()), Simulation(leg_drop())
    advance = Advancing(advanced, 60)
    advance()
    driving(stepped, 60)()
    assert advanced.ticks == stepped.ticks == 60
    assert advanced.group.samples.tobytes() == stepped.group.samples.tobytes()
    assert sum(advance.stretches) + len(advance.stretches) == 60
    assert 0.0 < advance.driven_share == len(advance.stretches) / 60 < 1.0
    first = len(advance.stretches)
    advance()
    assert advanced.ticks == 120
    assert advance.driven_share == (first + len(advance.stretches)) / 120


def test_kernels_alone_are_those_of_the_ticks():
    """After 30 ticks without commands all states are those of a simulation."""
    alone, whole = Simulation(leg_drop()), Simulation(leg_drop())
    for simulation in (alone, whole):
        driving(simulation, 50)()
    kernels_alone(alone, 30)()
    driving(whole, 30)()
    assert alone.group.samples.tobytes() == whole.group.samples.tobytes()
    assert alone.body_sample.tobytes() == whole.body_sample.tobytes()


def test_kernels_alone_begin_where_the_simulation_is():
    """Also after a reset: then at t = 0, as those of a new one."""
    again, new = Simulation(leg_drop()), Simulation(leg_drop())
    driving(again, 50)()
    again.reset()
    for simulation in (again, new):
        kernels_alone(simulation, 30)()
    assert again.group.samples.tobytes() == new.group.samples.tobytes()


def test_parts_of_a_tick_are_those_of_its_two_kinds(monkeypatch):
    """Kernels of quiet ticks alone; a tick in Python is measured by itself, and counted."""
    monkeypatch.setattr(over_kernels, 'BEGUN', 5)
    monkeypatch.setattr(over_kernels, 'TICKS', 40)
    monkeypatch.setattr(over_kernels, 'DRIVEN', 10)
    runs = []

    def in_turn(works, per):
        works['a tick'].run()
        runs.append(works['a tick'].run.driven_share)
        return {'a tick': 9.0, 'kernels': 5.0, 'what keeps their rows': 2.0,
                'ticks in Python': 3.0}
    monkeypatch.setattr(over_kernels, 'in_turn', in_turn)
    times = over_kernels._times(leg_drop(), 'in memory')
    share, = runs
    assert 0.0 < share < 1.0
    assert times == {'a tick': 9.0, 'kernels': 5.0, 'what keeps their rows': 2.0,
                     'kernels of quiet ticks': (1.0 - share) * 5.0,
                     'ticks in Python': share * 3.0 * 40 / 10}


def test_what_is_not_of_kernels_has_no_floor():
    ram = {'model': 'isa_v5'}
    run = load({'name': 'pair', 'supply': {
        'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0},
        'body': {'kind': 'external', 'actuators': ['left', 'right']},
        'actuators': {'left': ram, 'right': ram}})
    with pytest.raises(RunError, match='^pair: a body is not of kernels$'):
        kernels_alone(run.simulation(body=MassOnSpring), 1)


def test_sinks_keep_the_rows_of_now_in_stretches_like_those_of_a_run(monkeypatch):
    """Each stretch writes the sample of now, the ticks between them, for Python, do not."""
    monkeypatch.setattr(over_kernels, 'BEGUN', 5)
    monkeypatch.setattr(over_kernels, 'TICKS', 40)
    simulation = Simulation(leg_drop())
    like = Advancing(Simulation(leg_drop()), 1)
    like.stretches = [3, 0, 4]
    with logging(simulation):
        driving(simulation, 5)()
        keeping(simulation, like)()
        log = simulation.loop.sinks[0].log
        last = simulation.group.samples
    kept = np.array([row.tobytes() == last.tobytes() for row in log.samples])
    # Tick 5 is the last one driven; a stretch is kept at its first row: 6, none, and 11.
    assert np.flatnonzero(kept[5:]).tolist() == [0, 1, 6] and len(kept) == 15
