"""Commands of quiet ticks that their source knows in advance: a motion has one at each tick."""

from typing import NamedTuple

from isa_ros.core.bound import Bound, nothing, Part
from isa_ros.core.kernel import kernel
from isa_ros.core.signals import COMMAND, Records
from isa_ros.tick.source import Source
import numpy as np
from numpy.typing import NDArray

MOST = 64
"""Ticks that are planned at once."""


class Plan(NamedTuple):
    """Memory of `take_commands`."""

    clock: np.ndarray
    """Finished ticks, and the tick in ns, int64, (2,)."""
    first: np.ndarray
    """Tick of the first row of commands, int64, (1,)."""
    planned: np.ndarray
    """`COMMAND` of each tick, (`MOST`, n)."""
    commands: np.ndarray
    """`COMMAND` of the tick, (n,)."""


@kernel
def take_commands(own):
    """Make the planned commands those of the tick; return 0."""
    k = own.clock[0] - own.first[0]
    for n in range(len(own.commands)):
        own.commands[n] = own.planned[k, n]
    return 0


class PlannedCommands:
    """The commands of the next ticks; ``commands`` are the rows of each tick, (n,)."""

    def __init__(self, clock: NDArray[np.int64], commands: Records) -> None:
        n = len(commands)
        self._first = np.full(1, -1, np.int64)
        self._planned = np.zeros((MOST, n), COMMAND)
        self._source: Source | None = None
        self.part = Part(Bound(take_commands, Plan(
            clock, self._first, self._planned, commands)), nothing)
        """What makes them those of a tick."""
        self.expected = np.zeros(n, np.bool_)
        """Whether each actuator gets a command in the ticks of `prepare`."""

    def prepare(self, source: Source, tick: int, most: int) -> int:
        """
        Plan ticks from one on; return how many of them command the same actuators.

        The source knows them in advance, and is asked once for each.
        """
        first = int(self._first[0])
        if source is not self._source or not first <= tick < first + MOST or first < 0:
            self._source, self._first[0], first = source, tick, tick
            self._planned[:] = np.zeros((), COMMAND)
            for k in range(MOST):
                source.commands(tick + k, self._planned[k])
        are_given = self._planned['kinds'][tick - first:tick - first + most] != 0
        self.expected[:] = are_given[0]
        others = np.flatnonzero((are_given != are_given[0]).any(axis=1))
        return int(others[0]) if len(others) else len(are_given)
