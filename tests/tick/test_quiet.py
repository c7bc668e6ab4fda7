"""Quiet ticks in one compiled loop: the bytes are those of single ticks, whatever is in a call."""

from collections.abc import Callable, Mapping
from itertools import cycle
import math
from pathlib import Path

from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.controller import Controller, Setpoint, State
from isa_ros.core.bound import Bound
from isa_ros.core.signals import COMMAND, SAMPLE
from isa_ros.errors import SimulationDiverged
from isa_ros.run.output import packer_of, RunOutput
from isa_ros.run.provenance import provenance_of
from isa_ros.scenario.faults import ParameterChanges
from isa_ros.scripting.log import LogSink
from isa_ros.scripting.run import load, Run
from isa_ros.simulation import Simulation
from isa_ros.tick.exchange import Rows, RowSink
from isa_ros.tick.quiet import watch, Watched
from isa_ros.tick.source import ScheduledSource
from isa_ros.tick.tick_loop import BEFORE_TICKS
from isa_ros.tick.trips import TripLog
import numpy as np
import pytest

PATTERNS = ((1,), (2,), (3,), (7,), (20,), (100,), (1, 50, 3, 9), (1_000_000,))
"""Ticks of successive calls."""


def advance(simulation: Simulation, n_ticks: int, pattern: tuple[int, ...]) -> int:
    """Advance to a tick by calls of quiet ticks, each with a single one behind; return these."""
    loop, single = simulation.loop, 0
    loop.begin()
    for most in cycle(pattern):
        loop.advance_quietly(min(n_ticks - 1, loop.ticks + most - 1))
        loop.advance()
        single += 1
        if loop.ticks == n_ticks:
            loop.finish()
            loop.end()
            return single
    raise AssertionError


def bag_of(directory: Path, run: Run, n_ticks: int, pattern: tuple[int, ...],
           act: Callable[[Simulation], object] = lambda simulation: None
           ) -> tuple[list[tuple[object, ...]], int]:
    """Return all messages of the bag of a run, and the number of single ticks."""
    simulation = run.simulation()
    act(simulation)
    config = simulation.scenario.run
    packer = packer_of(config, simulation.loop.rows.published)
    with BagWriter(directory, packer.topics, provenance_of(simulation.scenario)) as bag:
        simulation.loop.sinks = (
            RunOutput(packer, config.step_ns, bag),
            TripLog([(own.name, own.sheet.is_rotary) for own in config.actuators]))
        single = advance(simulation, n_ticks, pattern)
    return [(own.topic, own.sequence, own.t_ns, own.data)
            for own in Bag(directory).messages()], single


@pytest.mark.parametrize(('name', 'scenario', 'n_ticks'), [
    ('leg', 'drop', 1100), ('rig_linear', None, 1020), ('rig_temperature', 'temperature', 1010),
    ('quadruped', None, 130), ('press', None, 200), ('leg', 'trot_leg', 300),
    ('rig_rotary', 'wheel_sine', 150)])
def test_a_bag_has_the_same_bytes_however_many_ticks_are_in_a_call(
        tmp_path, name, scenario, n_ticks):
    """With commands, an impact, inertial units, messages of each second and of each tick."""
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


def test_a_circuit_is_advanced_tick_by_tick(tmp_path):
    """It is not of kernels yet."""
    _, single = bag_of(tmp_path / 'bag', load('pump_station'), 30, (10,))
    assert single == 30


def log_of(run: Run, n_ticks: int, pattern: tuple[int, ...], room: int) -> list[object]:
    """Return what is logged of a run, where so many ticks were expected."""
    simulation = run.simulation()
    sink = LogSink(simulation, room)
    simulation.loop.sinks = (sink,)
    advance(simulation, n_ticks, pattern)
    log = sink.log
    return [log.samples.tobytes(), log.supplies.tobytes(), log.bodies['body'].tobytes(),
            {tick: rows.tobytes() for tick, rows in log.applied.items()}, len(log.samples)]


def test_a_log_has_the_same_rows_also_where_it_grows():
    run = load('leg', scenario='drop')
    first = log_of(run, 330, (1,), 330)
    assert first[-1] == 331 and len(first[3]) > 1
    for room, pattern in ((330, (1000,)), (330, (1, 50, 3)), (40, (25,))):
        assert log_of(run, 330, pattern, room) == first


def test_a_log_of_a_motion_has_every_applied_command():
    run = load('leg', scenario='trot_leg')
    first = log_of(run, 90, (1,), 90)
    assert len(first[3]) > 60 and log_of(run, 90, (1000,), 90) == first


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


class Counting(RowSink):
    """Counts the ticks that it takes, and those that kernels took."""

    def __init__(self, n: int) -> None:
        self.n, self.taken, self.quiet = n, [], 0

    def quiet_ticks(self, tick: int) -> int:
        return self.n

    def take(self, tick: int, rows: Rows) -> None:
        self.taken.append(tick)

    def end_quiet(self, tick: int, n_ticks: int) -> None:
        self.quiet += n_ticks


def begun(run: Run) -> tuple[Simulation, Counting]:
    """Return a simulation at t = 0, and the sink of its rows."""
    simulation, sink = run.simulation(), Counting(1000)
    simulation.loop.sinks = (sink,)
    simulation.loop.begin()
    return simulation, sink


def counted(n: int, n_ticks: int = 60, **scenario: object) -> Counting:
    simulation = load('rig_linear', **scenario).simulation()
    sink = Counting(n)
    simulation.loop.sinks = (sink,)
    advance(simulation, n_ticks, (1_000_000,))
    return sink


def test_a_sink_says_how_many_ticks_it_can_do_without():
    assert counted(0).taken == list(range(61))
    ten = counted(10)
    assert ten.quiet + len(ten.taken) == 61 and 5 <= len(ten.taken) <= 9


def test_a_device_that_changes_is_taken_at_its_tick():
    """The device of a rig is ready after its first tick; then nothing happens until the end."""
    taken = counted(1000).taken
    assert taken[0] == 0 and taken[-1] == 60 and len(taken) <= 4


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


def test_a_source_says_until_when_it_has_nothing():
    source = ScheduledSource(
        lambda tick, rows: None, {7: ParameterChanges({}, {})}, {3: ['x'], 12: ['y']},
        lambda tick: 9 if tick <= 9 else math.inf)
    assert [source.quiet_until(tick) for tick in (0, 3, 4, 8, 10, 13)] == [
        2, 3, 7, 9, 11, math.inf]
    assert [source.planned_until(tick) for tick in (0, 3, 4, 8, 12, 13)] == [
        2, 3, 7, 11, 12, math.inf]
    assert ScheduledSource(lambda tick, rows: None).quiet_until(5) == 5


def test_a_scenario_has_commands_at_its_events_and_during_a_motion():
    drop = load('rig_rotary', scenario='step').simulation().scenario
    events = sorted({event.tick for track in drop.tracks for event in track.events})
    first, *_, last = events
    assert drop.next_command(first) == first and drop.next_command(last + 1) == math.inf
    assert [drop.next_command(tick + 1) for tick in events[:-1]] == events[1:]
    sine = load('rig_rotary_position', scenario='wheel_sine').simulation().scenario
    begin = min(event.tick for track in sine.tracks for event in track.events
                if event.motion is not None)
    assert sine.next_command(begin + 5) == begin + 5


def test_an_open_line_of_an_emergency_stop_is_followed_tick_by_tick():
    simulation, _ = begun(load('quadruped'))
    for _ in range(3):
        simulation.loop.advance()
    simulation.loop.advance_quietly(6)
    assert simulation.ticks == 6
    simulation.emergency_stop()
    for tick in range(7, 12):
        simulation.loop.advance()
        simulation.loop.advance_quietly(30)
        assert simulation.ticks == tick


class Asked(Controller):
    """Counts how often it is asked."""

    def __init__(self) -> None:
        self.n = 0

    def step(self, state: State) -> Mapping[str, Setpoint]:
        self.n += 1
        return {}


def test_a_controller_is_asked_at_every_tick():
    asked = Asked()
    simulation = load('rig_linear').simulation([asked])
    simulation.loop.sinks = (Counting(1000),)
    assert advance(simulation, 25, (50,)) == 25 == asked.n


class Node:
    """An actuator's node, with or without publishers of setpoints."""

    def __init__(self, is_commanded: bool) -> None:
        self.is_commanded, self.served = is_commanded, 0

    def serve(self) -> None:
        self.served += 1


@pytest.mark.parametrize(('commanded', 'served'), [(False, 3), (True, 40)])
def test_a_node_with_a_publisher_of_setpoints_is_served_at_every_tick(commanded, served):
    simulation = load('leg').simulation()
    nodes = [Node(False), Node(commanded), Node(False)]
    simulation.loop.transport._inputs = nodes
    simulation.loop.sinks = (Counting(1000),)
    advance(simulation, 40, (50,))
    assert nodes[0].served <= served if not commanded else nodes[0].served == served


def watched(seconds: float) -> Watched:
    """Return the memory before the tick that ends at a time: two devices that do nothing."""
    samples = np.zeros(2, SAMPLE)
    samples['state_since'], samples['trip_time'] = 0.25, (0.1, 0.2)
    return Watched(np.array([round(seconds * 1e3) - 1, 1_000_000]), samples,
                   *(np.zeros(2, COMMAND) for _ in range(2)), np.array([0.1, 0.2]),
                   np.zeros(2, np.bool_))


@pytest.mark.parametrize(('seconds', 'field', 'value', 'is_seen'), [
    (0.5, None, 0, False), (2.0, None, 0, True), (2.001, None, 0, False), (0.251, None, 0, True),
    (0.5, 'applied', 2, True), (0.5, 'sent', 4, True), (0.5, 'trip_time', 0.49, True),
    (0.5, 'state_since', 0.4995, True), (0.5, 'age', 0.2495, True), (0.5, 'age', 0.1, False)])
def test_a_tick_is_watched_for_what_actuators_do(seconds, field, value, is_seen):
    """The second one does it; a change of 0.25 s is told in the tick after it."""
    own = watched(seconds)
    if field in ('applied', 'sent'):
        getattr(own, field)['kinds'][1] = value
    elif field is not None:
        own.samples[field][1] = value
    assert Bound(watch, own).run() == is_seen
    assert own.clock.tolist() == [round(seconds * 1e3), 1_000_000]


@pytest.mark.parametrize('applied', [(0, 0), (2, 0), (0, 2), (4, 2)])
@pytest.mark.parametrize('expected', [(False, False), (True, False), (True, True)])
def test_a_planned_command_is_not_seen_where_it_takes_effect(applied, expected):
    """One that does not, or that nobody has planned, is."""
    own = watched(0.5)
    own.applied['kinds'], own.expected[:] = applied, expected
    assert Bound(watch, own).run() == (tuple(kinds != 0 for kinds in applied) != expected)


@pytest.mark.parametrize('link', [{'kind': 'none'}, {'kind': 'can', 'cycle_ms': 4.0}])
def test_a_command_from_outside_is_taken_at_its_tick(link):
    """Behind a link it is sent at once, and applied when its frame has arrived."""
    simulation, sink = begun(load('rig_linear').replace({'link': link}))
    for _ in range(30):
        simulation.loop.advance()
    simulation.loop.advance_quietly(41)
    assert simulation.ticks == 41
    simulation.command('ram', position=0.06)
    simulation.loop.advance_quietly(60)
    assert simulation.ticks == 42 == sink.taken[-1]
    assert (simulation.loop.rows.sent['kinds'][0] != 0) == (link['kind'] == 'can')
    while simulation.ticks < 60:
        simulation.loop.advance_quietly(60)
    assert (45 in sink.taken) == (link['kind'] == 'can')
    assert float(simulation.group.samples['position_reference'][0]) == 0.06


def test_nothing_is_quiet_while_something_waits():
    simulation, _ = begun(load('leg', scenario='drop'))
    simulation.loop.advance()
    simulation.loop.advance()

    def passed(until: int = 12) -> int:
        first = simulation.ticks
        simulation.loop.advance_quietly(until)
        return simulation.ticks - first
    simulation.tune('kfe', {'plant.spool.stuck': 1.0})
    assert passed() == 0
    simulation.loop.advance()
    assert passed() == 0        # the change is still told
    simulation.loop.advance()
    assert passed() == 8
    simulation.tune('supply', {'pressure_mpa': 19.0})
    assert passed(30) == 0
    simulation.loop.advance()
    simulation.loop.advance()
    simulation.loop.rows.requests['kinds'][1] = 1
    assert passed(30) == 0
    simulation.loop.rows.clear_requests()
    assert passed(30) == 16 and passed(30) == 0 and passed(29) == 0


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
