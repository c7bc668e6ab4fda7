"""Sweeps: simulate a run with many combinations of values, on all cores; a table of results."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
import multiprocessing
from multiprocessing.connection import Connection, wait
import os
import sys
from typing import Any

from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError, IsaError, RunError
from isa_ros.scripting.result import Result
from isa_ros.scripting.run import Run
from isa_ros.text.progress import counted
from isa_ros.text.table import aligned, RIGHT
import numpy as np

Measure = Callable[[Result], float]

_Outcome = tuple[int, list[float] | BaseException]
"""Index of a run, and its measured values or its error."""
_DIGITS = 6


@dataclass(frozen=True)
class Sweep(Mapping[str, Any]):
    """
    A table with a row for each combination of values; the last key varies fastest.

    ``sweep['peak']`` is the column of a measure, ``sweep['supply.pressure_mpa']`` that of a
    key; (n,) each.
    """

    columns: Mapping[str, np.ndarray]

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self.columns:
            raise KeyError(f'{name} is unknown; {alternatives(name, self.columns)}')
        return self.columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    def __str__(self) -> str:
        rows = zip(*self.columns.values())
        cells = [list(self.columns), *([_shown(value) for value in row] for row in rows)]
        return '\n'.join(aligned(cells, RIGHT * len(self.columns)))

    def to_pandas(self) -> Any:
        """Return a `pandas.DataFrame`; raises as `Result.to_pandas`."""
        from isa_ros.scripting.result import optional
        return optional('pandas').DataFrame(dict(self.columns))


def _shown(value: Any) -> str:
    return f'{value:.{_DIGITS}g}' if isinstance(value, float) else str(value)


def sweep(
        run: Run, values: Mapping[str, Sequence[Any]], duration: float | None = None, *,
        measure: Mapping[str, Measure], workers: int = -1, progress: bool = False) -> Sweep:
    """
    Simulate a run with every combination of ``values`` and measure each result.

    ``values`` are lists by key of `Run.replace`, ``measure`` functions from a `Result` to a
    number by name, ``duration`` (s) as in `Run.simulate`. ``workers`` is the number of
    processes, -1: one per core. ``progress`` is shown on a terminal only.

    On Linux the workers are forked, so that a measure may be any function; on other systems it
    must be defined at the top level of a module.

    Raises
    ------
    ConfigError
        A key, a value or the number of workers is refused; nothing has been simulated.
    SimulationDiverged
        A state of one of the runs is no longer finite.

    """
    if workers != -1 and workers < 1:
        raise ConfigError(f'workers = {workers}, must be >= 1, or -1 for all cores')
    for key, given in values.items():
        if isinstance(given, str) or not len(given):
            raise ConfigError(f'{key}: values = {given!r}, must be a list of at least one value')
    cases = [dict(zip(values, combination)) for combination in product(*values.values())]
    runs = [run.replace(case) for case in cases]
    n_workers = min(len(cases), os.cpu_count() or 1 if workers == -1 else workers)
    report = counted(sys.stderr, 'runs') if progress else None
    outcomes = (_serial(runs, duration, measure) if n_workers == 1
                else _parallel(runs, duration, measure, n_workers))
    rows: list[list[float]] = [[] for _ in cases]
    for done, (k, measured) in enumerate(outcomes, start=1):
        if isinstance(measured, BaseException):
            raise measured
        rows[k] = measured
        if report is not None:
            report(done, len(cases))
    columns = {key: np.array([case[key] for case in cases]) for key in values}
    columns |= {name: np.array(column) for name, column in zip(measure, zip(*rows))}
    return Sweep(columns)


def _measured(
        run: Run, duration: float | None, measure: Mapping[str, Measure]) -> list[float]:
    result = run.simulate(duration)
    return [float(function(result)) for function in measure.values()]


def _serial(
        runs: Sequence[Run], duration: float | None, measure: Mapping[str, Measure]
        ) -> Iterator[_Outcome]:
    for k, run in enumerate(runs):
        yield k, _measured(run, duration, measure)


def _parallel(
        runs: Sequence[Run], duration: float | None, measure: Mapping[str, Measure],
        n_workers: int) -> Iterator[_Outcome]:
    """Yield the outcomes as they arrive; worker w of n does the runs w, w + n, w + 2 n, ..."""
    runs[0].simulation().step()  # load the kernels once, before the fork
    context: Any = multiprocessing.get_context(
        'fork' if 'fork' in multiprocessing.get_all_start_methods() else 'spawn')
    workers, ends = [], []
    for w in range(n_workers):
        ours, theirs = context.Pipe(duplex=False)
        workers.append(context.Process(
            target=_work, args=(runs, duration, measure, w, n_workers, theirs), daemon=True))
        workers[-1].start()
        theirs.close()
        ends.append(ours)
    try:
        while ends:
            for end in wait(ends):
                assert isinstance(end, Connection)
                try:
                    outcome: _Outcome = end.recv()
                except EOFError:
                    ends.remove(end)
                    continue
                yield outcome
        for worker in workers:
            worker.join()
            if worker.exitcode:
                raise RunError(f'a worker of the sweep ended with exit code {worker.exitcode}')
    finally:
        for worker in workers:
            worker.terminate()
            worker.join()


def _work(
        runs: Sequence[Run], duration: float | None, measure: Mapping[str, Measure], first: int,
        stride: int, end: Connection) -> None:
    """Measure a worker's share of the runs, and send each outcome when it is ready."""
    for k in range(first, len(runs), stride):
        try:
            end.send((k, _measured(runs[k], duration, measure)))
        except IsaError as error:
            end.send((k, error))
            return
    end.close()
