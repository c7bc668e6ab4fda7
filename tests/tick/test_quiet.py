"""Quiet ticks in one compiled loop: the bytes are those of single ticks, whatever is in a call."""

from collections.abc import Callable
from itertools import cycle
from pathlib import Path

from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.errors import SimulationDiverged
from isa_ros.run.output import packer_of, RunOutput
from isa_ros.run.provenance import provenance_of
from isa_ros.scripting.log import LogSink
from isa_ros.scripting.run import load, Run
from isa_ros.simulation import Simulation
from isa_ros.tick.exchange import Rows, RowSink
from isa_ros.tick.trips import TripLog
import numpy as np
import pytest

PATTERNS = ((1,), (2,), (7,), (100,), (1, 50, 3, 9), (1_000_000,))
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
    ('quadruped', None, 130), ('press', None, 200)])
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
    simulation = load('leg', scenario='drop').simulation()
    sink = Counting(1000)
    simulation.loop.sinks = (sink,)
    simulation.loop.begin()
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
    simulation = load('leg', scenario='drop').simulation()
    simulation.loop.sinks = (Counting(1000),)
    simulation.loop.begin()
    simulation.loop.advance()
    leg = simulation.surroundings.bodies['body']
    leg._state['v_z'] = np.inf
    with pytest.raises(SimulationDiverged, match='leg.'):
        simulation.loop.advance_quietly(9)
    assert simulation.ticks == 1 and leg.t_ns == simulation.group.t_ns == 2_000_000


def test_nothing_is_quiet_while_something_waits():
    simulation = load('leg', scenario='drop').simulation()
    simulation.loop.sinks = (Counting(1000),)
    simulation.loop.begin()
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
