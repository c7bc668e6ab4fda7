"""What ends a call of quiet ticks: sinks, sources, controllers, nodes, devices, commands."""

from collections.abc import Mapping
import math

from isa_ros.controller import Controller, Setpoint, State
from isa_ros.core.bound import Bound
from isa_ros.core.signals import COMMAND, SAMPLE
from isa_ros.scenario.faults import ParameterChanges
from isa_ros.scripting.run import load
from isa_ros.tick.quiet import watch, Watched
from isa_ros.tick.source import ScheduledSource
import numpy as np
import pytest
from tests.tick.quietly import advance, begun, counted, Counting


def test_a_sink_says_how_many_ticks_it_can_do_without():
    assert counted(0).taken == list(range(61))
    ten = counted(10)
    assert ten.quiet + len(ten.taken) == 61 and 5 <= len(ten.taken) <= 9


def test_a_device_that_changes_is_taken_at_its_tick():
    """The device of a rig is ready after its first tick; then nothing happens until the end."""
    taken = counted(1000).taken
    assert taken[0] == 0 and taken[-1] == 60 and len(taken) <= 4


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
