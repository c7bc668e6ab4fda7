"""Ticks of a log, replayed by kernels into the rows that messages are packed from."""

from bisect import bisect_right
from collections.abc import Sequence
from typing import NamedTuple

from isa_ros.core.bound import Bound, nothing, Part
from isa_ros.core.kernel import kernel
from isa_ros.core.record import floats
from isa_ros.core.signals import Records
from isa_ros.scripting.log import Log
from isa_ros.tick.exchange import Rows, RowSink
from isa_ros.tick.quiet import QuietTicks
from isa_ros.tick.source import ScheduledSource
import numpy as np
from numpy.typing import NDArray


class LogPlace(NamedTuple):
    """Memory of `go_on`."""

    sample: NDArray[np.int64]
    """Number of the sample, (1,)."""


class Logged(NamedTuple):
    """Memory of `load`."""

    place: LogPlace
    rows: NDArray[np.float64]
    """Numbers by sample, (n, f)."""
    into: NDArray[np.float64]
    """Those of the sample, (f,)."""


@kernel
def go_on(own):
    """Go on to the next sample; return 0."""
    own.sample[0] += 1
    return 0


@kernel
def load(own):
    """Copy the rows of the sample; return 0."""
    row = own.rows[own.place.sample[0]]
    for k in range(len(row)):
        own.into[k] = row[k]
    return 0


class _LoggedEnds:
    """Actuators and surroundings that answer what a log has; as `isa_ros.tick.exchange.Ends`."""

    is_settled = True

    def __init__(self, pairs: Sequence[tuple[Records, Records]]) -> None:
        self._place = LogPlace(np.zeros(1, np.int64))
        self.parts: Sequence[Part] = [Part(own, nothing) for own in (
            Bound(go_on, self._place), *(Bound(load, Logged(
                self._place, floats(rows).reshape(len(rows), -1), floats(into).reshape(-1)))
                for rows, into in pairs))]

    def begin_quiet(self, tick: int) -> None:
        """Begin behind a sample."""
        self._place.sample[0] = tick

    def end_quiet(self, tick: int, n_ticks: int, place: int) -> bool:
        """Return False: a tick that has begun is finished."""
        return False


class QuietLog:
    """The ticks of a log in which nothing unusual happens, for a sink of its rows."""

    def __init__(self, log: Log, rows: Rows, step_ns: int) -> None:
        pairs = [(log.samples, rows.samples), (log.supplies, rows.supplies), *(
            (log.bodies[name], sample) for name, sample in rows.bodies.items())]
        self._applied = log.applied
        self._others = sorted({*log.tuned, *log.tuned_supplies, *log.events})
        self._quiet: QuietTicks | None = None
        if log.observed is None and all(
                own.dtype == into.dtype for own, into in pairs):
            rows.commands = rows.applied    # what is planned for a tick is what it applies
            self._quiet = QuietTicks(_LoggedEnds(pairs), rows, step_ns, (), ())
        self._source = ScheduledSource(self._commands)

    def _commands(self, tick: int, out: Records) -> None:
        """Write what was applied in a tick."""
        if (applied := self._applied.get(tick + 1)) is not None:
            out[:] = applied

    def run(self, tick: int, most: int, sink: RowSink) -> int:
        """Give a sink up to ``most`` samples after one, as far as they are kernels'; how many."""
        if self._quiet is None:
            return 0
        k = bisect_right(self._others, tick)
        if k < len(self._others):
            most = min(most, self._others[k] - tick - 1)
        return self._quiet.run(tick, most, (sink,), self._source)[0] if most > 0 else 0
