"""Sweeps: simulate a run with many combinations of values, on all cores; a table of results."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from itertools import product
import os
import sys
from typing import Any

from isa_ros.config.differences import section_differences
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.text.parameter_sets import as_tree
from isa_ros.core.caller import warn
from isa_ros.core.frozen import frozen
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError
from isa_ros.scripting.outcomes import Failure, Measure, outcomes
from isa_ros.scripting.run import Run
from isa_ros.text.progress import counted
from isa_ros.text.table import aligned, RIGHT
import numpy as np

_DIGITS = 6
_MOST_NAMED = 3     # values that follow a changed one


@frozen
class Sweep(Mapping[str, Any]):
    """
    A table with a row for each combination of values; the last key varies fastest.

    ``sweep['peak']`` is the column of a measure, ``sweep['supply.pressure_mpa']`` that of a
    key; (n,) each. A value that could not be measured is NaN, and `failures` has the reason.
    """

    columns: Mapping[str, np.ndarray]
    failures: Mapping[int, Sequence[Failure]] = field(default_factory=dict)
    """By row: each has ``measure`` ('' where the run itself failed) and ``error``."""

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

    A run that diverges and a measure that raises lose no other value: theirs is NaN in the table,
    `Sweep.failures` has the errors, and one line, a `UserWarning`, says how many and why. Another
    one names what follows a changed bore or valve (docs/own_cylinder.md).

    On Linux the workers are forked, so that a measure may be any function; on other systems it
    must be defined at the top level of a module.

    Raises
    ------
    ConfigError
        A key, a value or the number of workers is refused; nothing has been simulated.
    Exception
        No run has a value: the error of the first one.

    """
    if workers != -1 and workers < 1:
        raise ConfigError(f'workers = {workers}, must be >= 1, or -1 for all cores')
    for key, given in values.items():
        if isinstance(given, str) or not len(given):
            raise ConfigError(f'{key}: values = {given!r}, must be a list of at least one value')
    cases = [dict(zip(values, combination)) for combination in product(*values.values())]
    runs = [run.replace(case) for case in cases]
    _name_followers(run.configuration, runs[-1].configuration, list(values))
    n_workers = min(len(cases), os.cpu_count() or 1 if workers == -1 else workers)
    report = counted(sys.stderr, 'runs') if progress else None
    measured = {name: np.full(len(cases), np.nan) for name in measure}
    failures: dict[int, Sequence[Failure]] = {}
    for done, outcome in enumerate(outcomes(runs, duration, measure, n_workers), start=1):
        for name, value in outcome.values.items():
            measured[name][outcome.run] = value
        if outcome.failures:
            failures[outcome.run] = outcome.failures
        if report is not None:
            report(done, len(cases))
    if failures:
        _name_failures(dict(sorted(failures.items())), cases, measured)
    columns = {key: np.array([case[key] for case in cases]) for key in values}
    return Sweep(columns | measured, dict(sorted(failures.items())))


def _name_failures(
        failures: Mapping[int, Sequence[Failure]], cases: Sequence[Mapping[str, Any]],
        measured: Mapping[str, np.ndarray]) -> None:
    """Warn of failures in one line; raise the first one if there is no value at all."""
    row, (first, *_) = next(iter(failures.items()))
    if len(failures) == len(cases) and all(np.isnan(column).all() for column in measured.values()):
        raise first.error
    case = ', '.join(f'{key} = {value}' for key, value in cases[row].items())
    warn(
        f'{len(failures)} of {len(cases)} runs lack a value; with {case}: {first}')


def _name_followers(run: RunConfig, other: RunConfig, changed: Sequence[str]) -> None:
    """Warn, in one line, that other values of actuators follow those of changed parameters."""
    for actuator, own in zip(run.actuators, other.actuators):
        of_actuator = f'actuators.{actuator.name}.'
        keys = [key for key in changed if key.startswith(f'{of_actuator}parameters.')]
        if not keys:
            continue
        found = [f'{of_actuator}{part}.{difference.key}'
                 for part, before, after in (('parameters', actuator.sheet, own.sheet),
                                             ('load', actuator.load, own.load))
                 if before is not None and after is not None
                 for difference in section_differences(as_tree(before), as_tree(after))]
        follow = [key.removeprefix(of_actuator) for key in found
                  if not any(f'{key}.'.startswith(f'{one}.') for one in changed)]
        if follow:
            named = ', '.join(follow[:_MOST_NAMED])
            warn(
                f'{len(follow)} more values of {actuator.name} follow {", ".join(keys)}: {named}'
                f'{", ..." if len(follow) > _MOST_NAMED else ""}; `isa params --set` lists them, '
                'and a value in the run file is kept')
