"""Every row of a run in memory."""

from collections.abc import Mapping
from typing import NamedTuple

from isa_ros.core.record import floats
from isa_ros.core.signals import Records
from isa_ros.simulation import Simulation
from isa_ros.text.progress import Progress
from isa_ros.tick.exchange import Rows, RowSink
import numpy as np

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


class LogSink(RowSink):
    """Writes the rows of the first ``n_ticks`` of a simulation into `log`."""

    def __init__(
            self, simulation: Simulation, n_ticks: int, report: Progress | None = None) -> None:
        rows, samples = simulation.loop.rows, simulation.group.samples
        n = n_ticks + 1
        is_linked = bool(simulation.scenario.run.linked)

        def log_of(source: Records, *shape: int) -> Records:
            log: Records = np.zeros((n, *shape), source.dtype)
            self._pairs.append((floats(log), floats(source).reshape(-1)))
            return log
        self._pairs: list[tuple[np.ndarray, np.ndarray]] = []
        self._applied: dict[int, Records] = {}
        self._sent: dict[int, Records] = {}
        self._tuned: dict[int, Mapping[int, Mapping[str, float]]] = {}
        self._tuned_supplies: dict[int, Mapping[str, float]] = {}
        self.log = Log(
            log_of(samples, len(samples)), log_of(rows.supplies, len(rows.supplies)),
            {name: log_of(sample) for name, sample in rows.bodies.items()}, self._applied,
            log_of(rows.samples, len(samples)) if is_linked else None, self._sent, self._tuned,
            self._tuned_supplies)
        self._kinds, self._sent_kinds = rows.applied['kinds'], rows.sent['kinds']
        self._n_ticks, self._report = n_ticks, report

    def take(self, tick: int, rows: Rows) -> None:
        """Copy the rows before ``tick``, which begins the run or follows the last one."""
        for log, source in self._pairs:
            log[tick] = source
        if self._kinds.any():
            self._applied[tick] = rows.applied.copy()
        if self.log.observed is not None and self._sent_kinds.any():
            self._sent[tick] = rows.sent.copy()
        if rows.tuned:
            self._tuned[tick] = rows.tuned
        if rows.tuned_supplies:
            self._tuned_supplies[tick] = rows.tuned_supplies
        if self._report is not None and tick % _REPORT_TICKS == 0:
            self._report(tick, self._n_ticks)

    def end(self) -> None:
        """Report the end."""
        if self._report is not None:
            self._report(self._n_ticks, self._n_ticks)
