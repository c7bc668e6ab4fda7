"""
Ticks in which nothing unusual happens, many of them in one compiled loop.

Such a tick is kernels alone: ports of supplies and bodies, actuators, bodies and supplies, and
what the sinks keep of the rows. They are the kernels that `isa_ros.tick.tick_loop` calls one by
one, over the same memory, so that the bytes of a run do not depend on how many ticks are in a
call. A command or a value that changes, a trip, a device that changes its state, a full second:
these are looked at in Python, and `watch` ends the loop where actuators have caused one. Those of
other processes are kernels too: their step out and their answers back (`Ends`).
"""

from collections.abc import Sequence
from enum import Enum
from typing import NamedTuple

from isa_ros.core.bound import Bound, nothing, Part, Program
from isa_ros.core.device import is_status_due
from isa_ros.core.kernel import kernel
from isa_ros.tick.exchange import Ends, Rows, RowSink
from isa_ros.tick.planned import PlannedCommands
from isa_ros.tick.source import Source
import numpy as np


class Watched(NamedTuple):
    """Memory of `watch`."""

    clock: np.ndarray
    """Finished ticks, and the tick in ns, int64, (2,)."""
    samples: np.ndarray
    """`SAMPLE` that listeners have, (n,)."""
    applied: np.ndarray
    """`COMMAND` that took effect in the tick, (n,)."""
    sent: np.ndarray
    """`COMMAND` handed to a link, (n,)."""
    trip_times: np.ndarray
    """Of the last trip of each actuator before, s, (n,)."""
    expected: np.ndarray
    """Whether a command takes effect in the tick as planned, bool, (n,)."""


@kernel
def watch(own):
    """Finish a tick; return 1 if it is one for Python, else 0."""
    own.clock[0] += 1
    end_ns = own.clock[0] * own.clock[1]
    start_ns = end_ns - own.clock[1]
    for n in range(len(own.samples)):
        sample = own.samples[n]
        if ((own.applied[n].kinds != 0) != own.expected[n] or own.sent[n].kinds != 0
                or sample.trip_time != own.trip_times[n]
                or is_status_due(
                    sample.state_since, sample.age, sample.is_stale, end_ns, start_ns)):
            return 1
    return 0


class QuietEnd(Enum):
    """How a call of quiet ticks has ended."""

    FULL = 1
    """All ticks are finished, and the sinks have them."""
    SEEN = 2
    """One more is finished, which the sinks do not have."""
    BEGUN = 3
    """One more has begun, and waits for its actuators."""


class QuietTicks:
    """
    The compiled loop over the ``ends`` and the surroundings of a run, with its ``rows``.

    ``before`` and ``after`` are from `Surroundings.parts` for these rows.
    """

    def __init__(
            self, ends: Ends, rows: Rows, step_ns: int, before: Sequence[Part],
            after: Sequence[Part]) -> None:
        self.ends = ends
        """The actuators."""
        self._rows = rows
        self._clock = np.array([0, step_ns], np.int64)
        self._trip_times = np.zeros(len(rows.samples))
        self._plan = PlannedCommands(self._clock, rows.commands)
        watched = Watched(self._clock, rows.samples, rows.applied, rows.sent, self._trip_times,
                          self._plan.expected)
        self._tick = (*before, *ends.parts, *after, Part(Bound(watch, watched), nothing))
        self._place = len(before)
        self._program = Program(())

    def run(self, tick: int, most: int, sinks: Sequence[RowSink],
            source: Source | None = None) -> tuple[int, QuietEnd]:
        """
        Run up to ``most`` ticks after ``tick`` ones, as far as the sinks need no Python.

        Their commands are those of a source, None: they have none. Returns how many ticks the
        sinks have kept.
        """
        self._plan.expected[:] = False
        if source is not None:
            most = self._plan.prepare(source, tick, most)
        for sink in sinks:
            most = min(most, sink.quiet_ticks(tick))
            if not (most and sink.takes_applied(self._plan.expected)):
                return 0, QuietEnd.FULL
        self._clock[0] = tick
        self._trip_times[:] = self._rows.samples['trip_time']
        self._rows.take_requests()
        self.ends.begin_quiet(tick)
        parts = [*self._tick] if source is None else [self._plan.part, *self._tick]
        for sink in sinks:
            most, own = sink.begin_quiet(tick, most, self._clock)
            parts += own
        bounds = tuple(part.bound for part in parts)
        if bounds != self._program.parts:
            self._program = Program(bounds)
        done, place, found = self._program.run(most)
        before = self._place + (source is not None)
        has_begun = self.ends.end_quiet(tick, done, place - before)
        for sink in sinks:
            sink.end_quiet(tick, done)
        if place < 0:
            return done, QuietEnd.FULL
        parts[place].found(found)
        return done, QuietEnd.BEGUN if has_begun else QuietEnd.SEEN
