"""Quiet ticks in one compiled loop: the bytes are those of single ticks, whatever is in a call."""

from isa_ros.errors import SimulationDiverged
from isa_ros.scripting.log import LogSink
from isa_ros.scripting.run import load, Run
from isa_ros.tick.tick_loop import BEFORE_TICKS
import numpy as np
import pytest
from tests.tick.quietly import advance, bag_of, begun, PATTERNS


@pytest.mark.parametrize(('name', 'scenario', 'n_ticks'), [
    ('leg', 'drop', 1100), ('rig_linear', None, 1020), ('rig_temperature', 'temperature', 1010),
    ('quadruped', None, 130), ('press', None, 200), ('leg', 'trot_leg', 300),
    ('rig_rotary', 'wheel_sine', 150), ('crane_circuit', 'crane_circuit', 200),
    ('pump_station', 'pump_station', 60), ('warm_stand', 'warm_stand', 150)])
def test_a_bag_has_the_same_bytes_however_many_ticks_are_in_a_call(
        tmp_path, name, scenario, n_ticks):
    """
    With commands, an impact, inertial units, messages of each second and of each tick.

    And with lines, and a tank whose oil warms its actuators.
    """
    run = load(name, scenario=scenario)
    found = [bag_of(tmp_path / str(k), run, n_ticks, pattern)
             for k, pattern in enumerate(PATTERNS)]
    first, single = found[0]
    assert single == n_ticks and len(first) > 5 * n_ticks
    for (other, calls), pattern in zip(found[1:], PATTERNS[1:]):
        assert other == first
        assert calls <= 0.6 * n_ticks, pattern


def test_what_is_asked_between_two_calls_is_the_same(tmp_path):
    """Tuned values, commands and an emergency stop, at their tick."""
    run = load('leg', scenario='drop')

    def tuned(simulation):
        simulation.tune('kfe', {'plant.valve.null_leakage_lpm': 0.3})
        simulation.tune('supply', {'pressure_mpa': 15.0})
        simulation.command('haa', position=0.07)
    first, _ = bag_of(tmp_path / '1', run, 120, (1,), tuned)
    assert bag_of(tmp_path / '2', run, 120, (40,), tuned)[0] == first
    assert bag_of(tmp_path / '3', run, 120, (1,))[0] != first


def test_stamps_begin_at_the_time_of_the_run(tmp_path):
    run = load('rig_linear').replace({'start_time_s': 1_700_000_000})
    first, _ = bag_of(tmp_path / '1', run, 30, (1,))
    assert bag_of(tmp_path / '2', run, 30, (20,))[0] == first
    assert first[-1][2] == 1_700_000_000_030_000_000


def log_of(
        run: Run, n_ticks: int, pattern: tuple[int, ...], room: int) -> tuple[list[object], int]:
    """Return what is logged of a run where so many ticks were expected, and the single ticks."""
    simulation = run.simulation()
    sink = LogSink(simulation, room)
    simulation.loop.sinks = (sink,)
    single = advance(simulation, n_ticks, pattern)
    log = sink.log
    return [log.samples.tobytes(), log.supplies.tobytes(), log.bodies['body'].tobytes(),
            {tick: rows.tobytes() for tick, rows in log.applied.items()}, len(log.samples)], single


def test_a_log_has_the_same_rows_also_where_it_grows():
    run = load('leg', scenario='drop')
    first, _ = log_of(run, 330, (1,), 330)
    assert first[-1] == 331 and len(first[3]) > 1
    for room, pattern in ((330, (1000,)), (330, (1, 50, 3)), (40, (25,))):
        assert log_of(run, 330, pattern, room)[0] == first


@pytest.mark.parametrize('scenario', ['trot_leg', 'drop'])
def test_a_log_of_a_motion_has_every_applied_command_by_kernels(scenario):
    """At every tick or at some: both kinds of calls, and a log that grows."""
    run = load('leg', scenario=scenario)
    first, single = log_of(run, 90, (1,), 90)
    assert single == 90 and len(first[3]) > (60 if scenario == 'trot_leg' else 0)
    for room, pattern in ((90, (1000,)), (90, (1, 20, 3)), (30, (7,))):
        found, single = log_of(run, 90, pattern, room)
        assert found == first
        assert single < 40, pattern


def test_a_trip_is_told_once():
    """One that was told before a call does not end it."""
    simulation, _ = begun(load('rig_linear'))
    for _ in range(3):
        simulation.loop.advance()
    assert simulation.loop._quiet is not None
    simulation.loop._quiet._trip_times[:] = 0.001
    simulation.loop.advance_quietly(30)
    assert simulation.ticks == 30


def test_a_second_run_of_a_simulation_is_the_first_again():
    """Quiet ticks may begin at t = 0, wherever the clock of the kernels stood."""
    simulation = load('rig_linear').simulation()
    seen = []
    for _ in range(2):
        sink = LogSink(simulation, 90)
        simulation.loop.sinks = (sink,)
        advance(simulation, 90, (91,))
        seen.append(sink.log.samples.tobytes())
        simulation.reset()
    assert seen[0] == seen[1] and len(set(sink.log.samples['position'][:, 0])) > 1


def test_a_state_that_breaks_in_a_call_has_its_time():
    """The actuators have passed the tick; what follows them has not."""
    simulation, sink = begun(load('leg', scenario='drop'))
    for _ in range(5):
        simulation.loop.advance()
    simulation.loop.advance_quietly(40)
    reached = simulation.ticks
    assert reached == 40
    simulation.group._memory.states[0, 5] = np.nan
    with pytest.raises(SimulationDiverged, match=r'haa: .* = nan') as raised:
        simulation.loop.advance_quietly(60)
    assert simulation.ticks == 40 and simulation.group.t_ns == 41_000_000
    assert raised.value.t_ns == 41_000_000
    assert int(simulation.surroundings.bodies['body'].t_ns) == 40_000_000


def test_a_body_that_ends_the_run_does_so_in_a_call():
    """As in a single tick: its own time has passed, and the supplies wait."""
    simulation, _ = begun(load('leg', scenario='drop'))
    simulation.loop.advance()
    leg = simulation.surroundings.bodies['body']
    leg._state['v_z'] = np.inf
    with pytest.raises(SimulationDiverged, match='leg.'):
        simulation.loop.advance_quietly(9)
    assert simulation.ticks == 1 and leg.t_ns == simulation.group.t_ns == 2_000_000


def test_laps_of_quiet_ticks_begin_where_the_ticks_before_ended():
    """What is between them is a lap of its own, also where no tick of Python was before."""
    phases: list[str] = []
    loop = load('rig_linear').simulation().loop
    loop._lap = phases.append
    loop.begin()
    while loop.ticks < 3:
        loop.advance()
    phases.clear()
    loop.advance_quietly(30)
    assert loop.ticks > 3 and phases == [BEFORE_TICKS, 'quiet ticks']
    loop.advance_quietly(loop.ticks)
    assert phases == [BEFORE_TICKS, 'quiet ticks']
