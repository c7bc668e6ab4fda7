"""
Parameters that bring a simulated machine closer to a measured one: least squares, intervals.

The residuals of all signals that both have, each over the standard deviation of the measured one,
go to `search`. The 95 % intervals allow for residuals that hang together over `CORRELATION`; they
hold for this model: what it lacks, the parameters take upon them.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from functools import lru_cache
from itertools import count
from typing import Any, NamedTuple

from isa_ros.analysis.measured.fit import Floats
from isa_ros.analysis.measured.measurement import Measurement
from isa_ros.analysis.measured.playback import played
from isa_ros.analysis.measured.search import ScaledBox, searched
from isa_ros.analysis.signals.signals import Signal
from isa_ros.core.parameter import Parameters
from isa_ros.core.suggest import alternatives
from isa_ros.errors import ConfigError, ParameterError, SimulationDiverged
from isa_ros.scripting.run import Run
import numpy as np

CLOCK, DELAY = 'clock_ppm', 'delay_ms'
"""Free keys of the measurement itself: its clock and its delay against those of its commands."""

MACHINE = ('load.inertia', 'plant.friction.viscous', 'plant.oil.effective_bulk_modulus')
DEFAULT = (*MACHINE, DELAY)
"""
Keys that are free if none are named, as far as the actuator has them.

Of a log that is 1 ms late they would make up for its delay; free, it costs no runs.
"""

REACH = 10.0            # a parameter is searched between a tenth and ten times its value
CORRELATION = 0.4       # s, as for `isa identify`
SHORTEST_S = 3.0        # s: some eight times as long
"""Of a measurement from which intervals can be found."""
WIDEST = 0.5            # half of an interval over the estimate, beyond which it is not determined
LEAST_LATE_MS = 0.1     # a tenth of a tick; without a delay 0.03 ms were left
POINTS = 2000           # samples of a signal among the residuals, at most
_RANGES = {CLOCK: (-1000.0, 1000.0, 100.0), DELAY: (-50.0, 50.0, 1.0)}
"""Bounds, and size of a step."""


class Free(NamedTuple):
    """One free parameter: its start, bounds and size, in the unit of its key."""

    key: str
    start: float
    low: float
    high: float
    size: float
    unit: str


class Closed(NamedTuple):
    """One parameter after the search; ``half_width`` of its 95 % interval."""

    free: Free
    value: float
    half_width: float

    @property
    def is_determined(self) -> bool:
        """Return whether the data determine it."""
        return self.half_width <= WIDEST * max(abs(self.value), self.free.size)


def free_of(run: Run, name: str, keys: Sequence[str]) -> list[Free]:
    """
    Return the free parameters of an actuator: KEY or KEY=LOW:HIGH, below plant, reu or load.

    Raises
    ------
    ConfigError
        A key is unknown or no number, or bounds are needed or wrong.

    """
    own = run.configuration.actuator(name)
    found = []
    for text in keys or DEFAULT:
        key, _, bounds = text.partition('=')
        if key in _RANGES:
            low, high, size = _RANGES[key]
            found.append(Free(key, 0.0, low, high, size, key.rpartition('_')[2]))
            continue
        root = {'load': own.load, 'plant': own.sheet, 'reu': own.sheet}.get(key.partition('.')[0])
        if not keys and (root is None or not _has(root, key)):
            continue
        found.append(_free(key, bounds, _declared(root, key), _value(root, key)))
    return found


def _free(key: str, bounds: str, declared: Mapping[str, Any], start: float) -> Free:
    low, high = sorted((start / REACH, start * REACH))
    if bounds:
        try:
            low, high = map(float, bounds.split(':'))
        except ValueError:
            raise ConfigError(f'--free {key}={bounds}: must be KEY=LOW:HIGH') from None
    own = declared['bounds']
    low = max(low, own.get('ge', own.get('gt', -np.inf)))
    high = min(high, own.get('le', own.get('lt', np.inf)))
    if not low < high:
        raise ConfigError(
            f'--free {key}: is {start:g}, give bounds within its range: {key}=LOW:HIGH')
    return Free(key, min(max(start, low), high), low, high,
                abs(start) or 0.25 * (high - low), str(declared.get('unit', '')))


def _path(root: Any, key: str) -> tuple[Any, str]:
    """Return the parameter set that has the last part of a key, and that part."""
    *sections, last = key.split('.')
    here = root
    for section in sections[1:] if sections and sections[0] == 'load' else sections:
        here = getattr(here, section, None)
    return here, last


def _has(root: Any, key: str) -> bool:
    here, last = _path(root, key)
    return isinstance(here, Parameters) and any(f.name == last for f in fields(here))


def _declared(root: Any, key: str) -> Mapping[str, Any]:
    here, last = _path(root, key)
    known = [f.name for f in fields(here)] if isinstance(here, Parameters) else []
    if last not in known or key.partition('.')[0] not in ('load', 'plant', 'reu'):
        raise ConfigError(f'--free {key}: is unknown; {alternatives(last, known)}')
    declared: Mapping[str, Any] = next(f.metadata for f in fields(here) if f.name == last)
    if 'bounds' not in declared:
        raise ConfigError(f'--free {key}: is no number')
    return declared


def _value(root: Any, key: str) -> float:
    here, last = _path(root, key)
    return float(getattr(here, last))


def changed(run: Run, name: str, values: Mapping[str, float]) -> Run:
    """Return the run with values by free key; those of the measurement change nothing in it."""
    return run.replace({
        f'actuators.{name}.{key if key.startswith("load.") else f"parameters.{key}"}': value
        for key, value in values.items() if key not in _RANGES})


def _simulations(
        simulated: Callable[[Mapping[str, float]], Mapping[str, Signal]],
        progress: Callable[[int], object], n_kept: int
        ) -> Callable[[Mapping[str, float]], Mapping[str, Signal]]:
    """
    Return what simulates with values by free key, and tells the number of runs.

    The last ones are kept: where only values of the measurement differ, nothing is simulated.
    """
    runs = count(1)

    @lru_cache(maxsize=n_kept)
    def of(machine: tuple[tuple[str, float], ...]) -> Mapping[str, Signal]:
        progress(next(runs))
        return simulated(dict(machine))
    return lambda values: of(tuple(
        (key, value) for key, value in values.items() if key not in _RANGES))


def closed(
        run: Run, name: str, measurement: Measurement, free: Sequence[Free], duration: float,
        progress: Callable[[int], object] = lambda n: None) -> list[Closed]:
    """
    Return the free parameters with which the run is closest to a measurement.

    ``run`` as `prepared`; ``progress`` is called with the number of finished runs.
    """
    size = np.array([own.size for own in free])
    grid = _grid(measurement, duration)
    start: Floats | None = None
    simulated_with = _simulations(
        lambda values: played(changed(run, name, values), name, measurement, duration),
        progress, 2 * len(free) + 1)    # from one slope by the delay to the next

    def residuals(theta: Floats) -> Floats:
        nonlocal start
        values = dict(zip([own.key for own in free], (theta * size).tolist()))
        try:
            simulated = simulated_with(values)
        except (ParameterError, SimulationDiverged):
            if start is None:
                raise
            return np.full_like(start, np.inf)
        found = _residuals(measurement, simulated, grid, values)
        start = found if start is None else start
        return found

    box = ScaledBox(np.array([own.low for own in free]) / size,
                    np.array([own.high for own in free]) / size)
    lags = max(1, round(CORRELATION / float(np.median(np.diff(grid)))))
    found = searched(residuals, np.array([own.start for own in free]) / size, box, lags)
    return [Closed(own, float(x * own.size), float(width * own.size))
            for own, x, width in zip(free, found.theta, found.half_widths)]


def delay_left(
        run: Run, name: str, measurement: Measurement, duration: float) -> Closed | None:
    """
    Return the delay of a measurement against a run with parameters that were found without it.

    It is less than the one that they make up for. None: it is none, or less than `LEAST_LATE_MS`.
    """
    found, = closed(run, name, measurement, free_of(run, name, [DELAY]), duration)
    is_late = abs(found.value) - found.half_width > LEAST_LATE_MS
    return found if is_late else None


def shifted(signal: Signal, values: Mapping[str, float]) -> Signal:
    """Return a measured signal by the clock of its commands, for values of `CLOCK` and `DELAY`."""
    clock, delay = values.get(CLOCK, 0.0) * 1e-6, values.get(DELAY, 0.0) * 1e-3
    return Signal(signal.t / (1.0 + clock) - delay, signal.values)


def _grid(measurement: Measurement, duration: float) -> Floats:
    """Return the instants of the residuals, (n,), s."""
    steps = [float(np.median(np.diff(own.t))) for own in measurement.outputs.values()
             if len(own.t) > 1]
    step = max([*steps, duration / POINTS])
    return np.arange(0.0, duration, step)


def _residuals(
        measurement: Measurement, simulated: Mapping[str, Signal], grid: Floats,
        values: Mapping[str, float]) -> Floats:
    """
    Return the residuals (n_signals, n), each over the spread of what is measured.

    They are at measured samples, the first from each instant of the grid: between samples the
    noise would be less, and a clock be found that brings them there.
    """
    found = []
    for quantity, own in simulated.items():
        measured = measurement.outputs[quantity]
        at = np.minimum(np.searchsorted(measured.t, grid), len(measured.t) - 1)
        t, values_there = shifted(Signal(measured.t[at], measured.values[at]), values)
        spread = float(np.std(measured.values)) or 1.0
        found.append((np.interp(t, own.t, own.values) - values_there) / spread)
    return np.stack(found)
