"""Forces that go on to swing where the motion has ended, as those of loops that hunt."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from isa_ros.analysis.report.key_figures import end_of, settling_time
from isa_ros.analysis.signals.signals import Signal, Signals
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.loads.sheets import Blocked
from isa_ros.reu.wiring import active
import numpy as np
from numpy.typing import NDArray

_LEAST = 0.01       # of the range of the force sensor: a larger swing is told
_STANDS = 1e-3      # of the stroke: who moves by less stands
_HALVES = 3         # whole half periods from which on a force swings


class Swing(NamedTuple):
    """A force that swings in the last tenth of the time."""

    actuator: str
    size: float
    """Half of peak to peak, N or Nm."""
    hertz: float
    share: float
    """Of the range of the force sensor."""


def swings(signals: Signals) -> Iterator[Swing]:
    """Yield the forces that swing at the end of a run; on a fixture, those that nobody wanted."""
    for own in signals.run.actuators:
        t, x = signals.drawn(f'{own.name}.position')
        if not len(t):
            continue
        if not stood(own, x) and settling_time(t, x) is None:
            continue
        span = own.sheet.plant.sensors.force_range
        size, hertz = swing_at_end(signals.drawn(f'{own.name}.force'), _LEAST * span)
        is_fixed = isinstance(own.load, Blocked) or np.ptp(x) == 0.0
        if is_fixed and size and not _is_own(own, signals, size):
            continue
        if size:
            yield Swing(own.name, size, hertz, size / span)


def _is_own(own: ActuatorConfig, signals: Signals, size: float) -> bool:
    """Return whether a swing on a fixture is one of the force loop, and nobody wanted it."""
    if 'force' not in active(own.sheet.reu):
        return False
    wanted, _ = swing_at_end(signals.drawn(f'{own.name}.force_reference'), 0.5 * size)
    return not wanted


def stood(own: ActuatorConfig, x: NDArray[np.float64]) -> bool:
    """Return whether an actuator moved by no more than its support, or its loop, yields."""
    return isinstance(own.load, Blocked) or stands(own, x)


def stands(own: ActuatorConfig, x: NDArray[np.float64]) -> bool:
    """Return whether positions, or references of them, are within a small part of the stroke."""
    return bool(np.ptp(x) <= _STANDS * own.sheet.plant.drive.stroke)


def swing_at_end(signal: Signal, least: float) -> tuple[float, float]:
    """
    Return half of peak to peak, and Hz, of a swing in the last tenth of the time; 0: none.

    It swings where it goes up and down in turn to the end, by more than twice ``least`` > 0. Its
    height is that of the ways between the extremes, the mean of the medians of those up and those
    down, after those of less than a limit are left out, the largest one that leaves a swing: so
    what is faster and smaller does not count, nor a drift, a step or a pulse beside it.
    """
    t, values = end_of(signal)
    is_there = np.isfinite(values)
    t, values = t[is_there], values[is_there]
    found, limit = (0.0, 0.0), 2.0 * least
    while len(extremes := _extremes(values.tolist(), limit)) > _HALVES:
        at = t[extremes]
        half = (at[-1] - at[0]) / (len(at) - 1)
        if t[-1] - at[-1] <= 2.0 * half:
            ways = np.abs(np.diff(values[extremes]))
            found = (0.25 * float(np.median(ways[::2]) + np.median(ways[1::2])),
                     0.5 / float(half))
        limit *= 2.0
    return found


def _extremes(values: Sequence[float], limit: float) -> list[int]:
    """Return the places of the extremes between ways that are longer than ``limit``."""
    low = high = way = 0        # places since the last extreme, and whether it goes up or down
    found: list[int] = []
    for place, value in enumerate(values):
        low = place if value < values[low] else low
        high = place if value > values[high] else high
        if way >= 0 and values[high] - value > limit:
            found += [high] if high else []     # the begin is none
            way, low, high = -1, place, place
        elif way <= 0 and value - values[low] > limit:
            found += [low] if low else []
            way, low, high = 1, place, place
    return found
