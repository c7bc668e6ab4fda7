"""Simulations in this process that advance as runs do: many quiet ticks in a call."""

from collections.abc import Callable, Sequence

from isa_ros.core.bound import Part, Program
from isa_ros.errors import RunError
from isa_ros.run.pacing import QuietStretch
from isa_ros.simulation import Simulation
from isa_ros.tick.exchange import RowSink
import numpy as np
from numpy.typing import NDArray


class Advancing:
    """
    Advances a simulation by ``n_ticks``, as a run without a pace does.

    A stretch of quiet ticks, possibly none, and one that Python drives follow each other.
    """

    def __init__(self, simulation: Simulation, n_ticks: int) -> None:
        self._loop, self._n_ticks, self._stretch = simulation.loop, n_ticks, QuietStretch()
        self.stretches: list[int] = []
        """Quiet ticks of each stretch of the last call."""
        self._begun, self._done = 0, 0

    def __call__(self) -> None:
        """Advance."""
        self.stretches = []
        loop, end = self._loop, self._loop.ticks + self._n_ticks
        while loop.ticks < end:
            first = loop.ticks
            self._stretch.advance(loop, end)
            self.stretches.append(loop.ticks - first)
            loop.advance()
        self._begun += len(self.stretches)
        self._done += self._n_ticks

    @property
    def driven_share(self) -> float:
        """Return the share of the ticks of all calls that Python drove."""
        return self._begun / self._done


def kernels_alone(simulation: Simulation, n_ticks: int) -> Callable[[], None]:
    """
    Return what runs the kernels of actuators, bodies and supplies alone, ``n_ticks`` in a call.

    They go on from the state of the simulation, without commands, and leave its clock behind.

    Raises
    ------
    RunError
        A body of the simulation is not of kernels.

    """
    group, rows = simulation.group, simulation.loop.rows
    parts = simulation.surroundings.parts(rows.ports, rows.feeds, rows.replies, rows.fed)
    if parts is None:
        raise RunError(f'{simulation.scenario.run.name}: a body is not of kernels')
    before, after = parts
    tick = [*before, Part(group.tick, group.refuse), *after]
    program = Program([part.bound for part in tick])
    rows.commands['kinds'] = 0
    group.set_clock()

    def run() -> None:
        _, place, found = program.run(n_ticks)
        if place >= 0:
            tick[place].found(found)
    return run


def driving(simulation: Simulation, n_ticks: int) -> Callable[[], None]:
    """Return what advances a simulation by ``n_ticks`` that Python drives."""
    def drive() -> None:
        for _ in range(n_ticks):
            simulation.loop.advance()
    return drive


def keeping(simulation: Simulation, like: Advancing) -> Callable[[], None]:
    """Return what lets the sinks keep rows in stretches ``like`` others; all rows are equal."""
    loop = simulation.loop
    clock = np.array([loop.ticks, simulation.scenario.run.step_ns], np.int64)

    def keep() -> None:
        tick = int(clock[0])
        for length in like.stretches:
            end = tick + length
            while tick < end:
                most = min([end - tick, *(sink.quiet_ticks(tick) for sink in loop.sinks)])
                clock[0] = tick + 1
                tick += _kept(loop.sinks, tick, most, clock) or 1  # none: Python takes its rows
            tick += 1
        clock[0] = tick
    return keep


def _kept(sinks: Sequence[RowSink], tick: int, most: int, clock: NDArray[np.int64]) -> int:
    """Let the sinks keep the rows of ``most`` ticks, or of fewer; return how many."""
    if not most:
        return 0
    parts: list[Part] = []
    for sink in sinks:
        most, own = sink.begin_quiet(tick, most, clock)
        parts += own
    Program([part.bound for part in parts]).run(most)
    for sink in sinks:
        sink.end_quiet(tick, most)
    return most
