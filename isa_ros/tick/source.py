"""Where the commands of a run come from: its scenario, a bag, or the master of a bus."""

from bisect import bisect_left
from collections.abc import Callable, Mapping, Sequence
import math
from typing import Protocol

from isa_ros.core.signals import Records
from isa_ros.scenario.faults import ParameterChanges


class Source(Protocol):
    """
    Commands and changes of parameters, tick by tick.

    For each tick the run calls `is_due` until it is true, then the others, in their order here.
    """

    def is_due(self, tick: int, samples: Records) -> bool:
        """
        Return whether the commands of a tick are there, after at most a moment's wait.

        ``samples`` are the `SAMPLE` rows at the tick's start, (n_actuators,).
        """
        ...

    def quiet_until(self, tick: int) -> float:
        """
        Return the first tick from ``tick`` on for which it has to be asked at all.

        It is ``tick`` itself where that is not known.
        """
        ...

    def commands(self, tick: int, out: Records) -> None:
        """Overwrite the `COMMAND` rows of a tick, (n_actuators,), where it commands."""
        ...

    def events(self, tick: int) -> Sequence[str]:
        """Return what happened since the last tick and belongs into the bag."""
        ...

    def changes(self, tick: int) -> ParameterChanges | None:
        """Return the parameters that change at a tick; None: none."""
        ...

    def take_tuned(self, tuned: Mapping[int, Mapping[str, float]]) -> None:
        """Take the parameters that changed at the start of the last tick, SI, by row and name."""
        ...

    def end(self, tick: int, samples: Records) -> Sequence[str]:
        """
        Take the samples at the end of the run, before a tick that does not begin.

        Returns what belongs into the bag there.
        """
        ...


class ScheduledSource:
    """
    A `Source` that is known in advance and never waits: a scenario, or what a bag has recorded.

    ``commands`` overwrites `COMMAND` rows of a tick, as `Scenario.commands`; ``changes`` and
    ``events`` are given by tick. ``next_command`` returns the first tick from one on at which
    ``commands`` may do something (None: every tick).
    """

    def __init__(
            self, commands: Callable[[int, Records], None],
            changes: Mapping[int, ParameterChanges] = {},
            events: Mapping[int, Sequence[str]] = {},
            next_command: Callable[[int], float] | None = None) -> None:
        self.commands, self.changes, self._events = commands, changes.get, events
        self._next_command = next_command
        # an event is written with the messages of the tick before, which kernels do not do
        self._others = sorted({*changes, *events, *(tick - 1 for tick in events)})

    def quiet_until(self, tick: int) -> float:
        """Return the first tick from ``tick`` on with a command, a change or an event after it."""
        if self._next_command is None:
            return tick
        return min(self._next_command(tick), self.planned_until(tick))

    def planned_until(self, tick: int) -> float:
        """
        Return the first tick from ``tick`` on with a change, or an event before or after it.

        Commands of the ticks before may be asked for in advance. It is ``tick`` itself where that
        is not known.
        """
        if self._next_command is None:
            return tick
        k = bisect_left(self._others, tick)
        return self._others[k] if k < len(self._others) else math.inf

    def is_due(self, tick: int, samples: Records) -> bool:
        """Return True."""
        return True

    def events(self, tick: int) -> Sequence[str]:
        """Return the events before a tick."""
        return self._events.get(tick, ())

    def take_tuned(self, tuned: Mapping[int, Mapping[str, float]]) -> None:
        """Do nothing."""

    def end(self, tick: int, samples: Records) -> Sequence[str]:
        """Return the events at the end."""
        return self.events(tick)
