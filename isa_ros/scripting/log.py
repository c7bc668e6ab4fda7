"""Every row of a run in memory."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from isa_ros.core.bound import Bound, nothing, Part, Rebound
from isa_ros.core.kernel import kernel
from isa_ros.core.record import floats
from isa_ros.core.signals import Records
from isa_ros.simulation import Simulation
from isa_ros.text.progress import Progress
from isa_ros.tick.exchange import Rows, RowSink
import numpy as np
from numpy.typing import NDArray

_REPORT_TICKS = 100     # ticks between two reports of progress


class Log(NamedTuple):
    """Every row of a run: n + 1 samples of n ticks."""

    samples: Records
    """`SAMPLE`, (n + 1, n_actuators)."""
    supplies: Records
    """`SUPPLY_SAMPLE`, (n + 1, n_supplies)."""
    bodies: Mapping[str, Records]
    """The sample of each body by name, (n + 1,)."""
    applied: Mapping[int, Records]
    """`COMMAND` rows (n_actuators,) by sample, for the samples with an applied command."""
    observed: Records | None = None
    """`SAMPLE` that listeners have, (n + 1, n_actuators); None: ``samples``, without a link."""
    sent: Mapping[int, Records] = {}
    """As ``applied``, of the commands handed to links."""
    tuned: Mapping[int, Mapping[int, Mapping[str, float]]] = {}
    """Changed parameters by sample, row and name, for the samples with any."""
    tuned_supplies: Mapping[int, Mapping[str, float]] = {}
    """Those of the supplies, by sample and SUPPLY.KEY."""
    events: Mapping[int, Sequence[str]] = {}
    """Texts of the run's events by sample: refused requests of controllers."""
    begins: Mapping[tuple[int, str], tuple[int, int]] = {}
    """Of a bag, by row and field of a count: its first sample is between these two."""


class _Kept(NamedTuple):
    """Memory of `keep`."""

    clock: NDArray[np.int64]
    """Finished ticks, and the tick in ns, (2,)."""
    source: NDArray[np.float64]
    """Numbers of a sample, (f,)."""
    rows: NDArray[np.float64]
    """By sample, (n, f)."""


@kernel
def keep(own):
    """Copy the source of a sample; return 0."""
    row = own.rows[own.clock[0]]
    for k in range(len(row)):
        row[k] = own.source[k]
    return 0


class RowColumn:
    """The rows of one source by sample, in an array that grows."""

    def __init__(self, source: Records, n: int, *shape: int) -> None:
        self._source: NDArray[np.float64] = floats(source).reshape(-1)
        self.rows: Records = np.zeros((n, *shape), source.dtype)
        self._floats = floats(self.rows)
        self._keeping = Rebound(keep, lambda clock, rows: _Kept(clock, self._source, rows))

    def take(self, tick: int) -> None:
        """Copy the source of a sample."""
        if tick >= len(self.rows):
            self.reach(2 * tick)
        self._floats[tick] = self._source

    def reach(self, n: int) -> None:
        """Have rows for at least so many samples."""
        if n > len(self.rows):
            larger: Records = np.zeros((n, *self.rows.shape[1:]), self.rows.dtype)
            larger[:len(self.rows)] = self.rows
            self.rows, self._floats = larger, floats(larger)

    def keeping(self, clock: NDArray[np.int64]) -> Bound:
        """Return what copies the source of a quiet tick, for which there is a row."""
        return self._keeping.to(clock, self._floats)


class LogSink(RowSink):
    """Writes the rows of a simulation into `log`; ``n_ticks`` of them without growing."""

    def __init__(
            self, simulation: Simulation, n_ticks: int, report: Progress | None = None) -> None:
        rows, samples = simulation.loop.rows, simulation.group.samples
        n = n_ticks + 1
        self._samples = RowColumn(samples, n, len(samples))
        self._supplies = RowColumn(rows.supplies, n, len(rows.supplies))
        self._bodies = {name: RowColumn(sample, n) for name, sample in rows.bodies.items()}
        self._observed = (RowColumn(rows.samples, n, len(samples))
                          if simulation.scenario.run.linked else None)
        self._all = [self._samples, self._supplies, *self._bodies.values()]
        if self._observed is not None:
            self._all.append(self._observed)
        self._commands = RowColumn(rows.applied, 0, len(rows.applied))
        self._applied: dict[int, Records] = {}
        self._sent: dict[int, Records] = {}
        self._tuned: dict[int, Mapping[int, Mapping[str, float]]] = {}
        self._tuned_supplies: dict[int, Mapping[str, float]] = {}
        self._events: dict[int, list[str]] = {}
        self._kinds, self._sent_kinds = rows.applied['kinds'], rows.sent['kinds']
        self._n_ticks, self._report, self._taken = n_ticks, report, 0
        self._is_commanded = False

    @property
    def log(self) -> Log:
        """Return what was taken so far."""
        n = self._taken
        return Log(
            self._samples.rows[:n], self._supplies.rows[:n],
            {name: column.rows[:n] for name, column in self._bodies.items()}, self._applied,
            None if self._observed is None else self._observed.rows[:n], self._sent, self._tuned,
            self._tuned_supplies, self._events)

    def take(self, tick: int, rows: Rows) -> None:
        """Copy the rows before ``tick``, which begins the run or follows the last one."""
        for column in self._all:
            column.take(tick)
        self._taken = tick + 1
        if self._kinds.any():
            self._applied[tick] = rows.applied.copy()
        if self._observed is not None and self._sent_kinds.any():
            self._sent[tick] = rows.sent.copy()
        if rows.tuned:
            self._tuned[tick] = rows.tuned
        if rows.tuned_supplies:
            self._tuned_supplies[tick] = rows.tuned_supplies
        if self._report is not None and tick % _REPORT_TICKS == 0:
            self._report(tick, self._n_ticks)

    def quiet_ticks(self, tick: int) -> int:
        """Return how many have a row already, up to the next report of progress."""
        return min(len(self._samples.rows) - 1 - tick, _REPORT_TICKS - 1 - tick % _REPORT_TICKS)

    def takes_applied(self, expected: NDArray[np.bool_]) -> bool:
        """Return True."""
        self._is_commanded = bool(expected.any())
        return True

    def begin_quiet(
            self, tick: int, most: int, clock: NDArray[np.int64]) -> tuple[int, Sequence[Part]]:
        """Return what copies the rows."""
        columns = self._all
        if self._is_commanded:
            self._commands.reach(len(self._samples.rows))
            columns = [*columns, self._commands]
        return most, [Part(column.keeping(clock), nothing) for column in columns]

    def end_quiet(self, tick: int, n_ticks: int) -> None:
        """Count the samples, and those with an applied command."""
        self._taken = tick + n_ticks + 1
        if self._is_commanded:
            self._applied.update(
                (k, self._commands.rows[k]) for k in range(tick + 1, self._taken))

    def add_event(self, tick: int, text: str) -> None:
        """Keep an event before ``tick``."""
        self._events.setdefault(tick, []).append(text)

    def end(self) -> None:
        """Report the end."""
        if self._report is not None:
            self._report(self._n_ticks, self._n_ticks)
