"""Forces that go on to swing where the motion has ended, as those of loops that hunt."""

from collections.abc import Iterator
from typing import NamedTuple

from isa_ros.analysis.report.key_figures import END, settling_time
from isa_ros.analysis.signals.signals import Signal, Signals
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.loads.sheets import Blocked
import numpy as np
from numpy.typing import NDArray

_LEAST = 0.01       # of the range of the force sensor: a larger swing is told
_HALVES = 4         # half periods from which on a force swings: two periods


class Swing(NamedTuple):
    """A force that swings in the last tenth of the time."""

    actuator: str
    size: float
    """Half of peak to peak, N or Nm."""
    share: float
    """Of the range of the force sensor."""


def swings(signals: Signals) -> Iterator[Swing]:
    """Yield the forces that swing at the end of a run, and are not wanted to."""
    for own in signals.run.actuators:
        t, x = signals.drawn(f'{own.name}.position')
        if not len(t):
            continue
        is_held = stands(own, x)
        if not is_held and settling_time(t, x) is None:
            continue
        span = own.sheet.plant.sensors.force_range
        size = swing_at_end(signals.drawn(f'{own.name}.force'), _LEAST * span)
        if is_held and swing_at_end(signals.drawn(f'{own.name}.force_reference'), 0.5 * size):
            continue    # as it was wanted
        if size:
            yield Swing(own.name, size, size / span)


def stands(own: ActuatorConfig, x: NDArray[np.float64]) -> bool:
    """Return whether an actuator cannot move, but for what its support yields, or has not."""
    return isinstance(own.load, Blocked) or np.ptp(x) == 0.0


def swing_at_end(signal: Signal, least: float) -> float:
    """
    Return half of peak to peak of a signal in the last tenth of the time; 0: it does not swing.

    It swings where it goes up and down in turn, each time by more than twice ``least``; the
    median of these ways is its height, so that a drift, a step or a pulse beside it does not
    count.
    """
    if not len(signal.t):
        return 0.0
    tail = signal.values[signal.t >= signal.t[-1] - END * (signal.t[-1] - signal.t[0])]
    ways = np.abs(np.diff(_turns(tail[np.isfinite(tail)], 2.0 * least)))
    return 0.5 * float(np.median(ways)) if len(ways) >= _HALVES else 0.0


def _turns(values: NDArray[np.float64], height: float) -> list[float]:
    """Return the begin, the extremes and the end of ways that are longer than ``height``."""
    turns: list[float] = []
    way = extreme = 0.0
    for value in values.tolist():
        if not turns:
            turns, extreme = [value], value
        elif way * (value - extreme) > 0.0:
            extreme = turns[-1] = value
        elif abs(value - extreme) > height:
            way, extreme = value - extreme, value
            turns.append(value)
    return turns
