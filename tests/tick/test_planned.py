"""Commands of a source that knows them in advance, as kernels take them."""

from isa_ros.core.signals import COMMAND, HAS_ENABLE, HAS_SETPOINT
from isa_ros.scripting.run import load
from isa_ros.tick.planned import MOST, PlannedCommands
from isa_ros.tick.source import ScheduledSource
import numpy as np
import pytest
from tests.tick.quietly import begun


class Motion:
    """Commands the first actuator at each tick, and the second from tick 30 to 33."""

    def __init__(self, offset: float = 0.0) -> None:
        self.asked: list[int] = []
        self.offset = offset
        self.source = ScheduledSource(
            self.fill, {80: None}, {90: ('event',)}, next_command=lambda tick: tick)

    def fill(self, tick: int, out: np.ndarray) -> None:
        self.asked.append(tick)
        out['kinds'][0], out['position'][0] = HAS_SETPOINT, self.offset + 1e-3 * tick
        if 30 <= tick < 34:
            out['kinds'][1], out['is_enabled'][1] = HAS_ENABLE, 1


@pytest.fixture
def rows() -> tuple[np.ndarray, np.ndarray]:
    """Return a clock and the rows of a tick."""
    return np.array([0, 1_000_000], np.int64), np.full(2, 7, np.uint8).repeat(
        COMMAND.itemsize).view(COMMAND)


def test_commands_are_those_of_the_source_tick_by_tick(rows):
    clock, commands = rows
    motion, planned = Motion(), PlannedCommands(clock, commands)
    assert planned.prepare(motion.source, 10, 15) == 15
    for tick in (10, 11, 24):
        clock[0] = tick
        assert planned.part.bound.run() == 0
        expected = np.zeros(2, COMMAND)
        Motion().fill(tick, expected)
        assert commands.tobytes() == expected.tobytes()
    assert planned.expected.tolist() == [True, False]


def test_ticks_that_command_others_are_not_planned_with_them(rows):
    motion, planned = Motion(), PlannedCommands(*rows)
    assert planned.prepare(motion.source, 25, 50) == 5
    assert planned.prepare(motion.source, 30, 50) == 4
    assert planned.expected.tolist() == [True, True]
    assert planned.prepare(motion.source, 33, 1) == 1
    assert planned.prepare(motion.source, 34, 50) == 50
    assert planned.expected.tolist() == [True, False]


def test_a_source_is_asked_once_for_each_tick(rows):
    motion, planned = Motion(), PlannedCommands(*rows)
    for tick in range(40, 40 + MOST):
        assert planned.prepare(motion.source, tick, 1000) == 40 + MOST - tick
    assert motion.asked == list(range(40, 40 + MOST))
    planned.prepare(motion.source, 40 + MOST, 1)
    assert motion.asked == list(range(40, 40 + 2 * MOST))


def test_another_source_and_an_earlier_tick_are_asked_anew(rows):
    clock, commands = rows
    first, second, planned = Motion(), Motion(offset=0.5), PlannedCommands(clock, commands)
    planned.prepare(first.source, 40, 5)
    for tick, source in ((40, second.source), (39, second.source), (39 + MOST, first.source)):
        planned.prepare(source, tick, 5)
        clock[0] = tick
        planned.part.bound.run()
        offset = 0.5 if source is second.source else 0.0
        assert commands['position'][0] == offset + 1e-3 * tick


def test_a_source_is_planned_until_it_has_more_than_commands():
    source = Motion().source
    assert [source.planned_until(tick) for tick in (0, 80, 81, 90)] == [80, 80, 89, 90]
    assert source.planned_until(91) == float('inf')
    assert source.quiet_until(50) == 50
    assert ScheduledSource(lambda tick, out: None).planned_until(4) == 4


def test_after_planned_commands_none_are_expected():
    """Else each call would end at its first tick."""
    simulation, _ = begun(load('rig_linear'))
    for _ in range(3):
        simulation.loop.advance()
    simulation.loop._quiet._plan.expected[:] = True
    simulation.loop.advance_quietly(30)
    assert simulation.ticks == 30
