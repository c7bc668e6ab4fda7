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
_STANDS = 1e-3      # of the stroke: who moves by less stands
_HALVES = 4         # half periods from which on a force swings: two periods


class Swing(NamedTuple):
    """A force that swings in the last tenth of the time."""

    actuator: str
    size: float
    """Half of peak to peak, N or Nm."""
    hertz: float
    share: float
    """Of the range of the force sensor."""


def swings(signals: Signals) -> Iterator[Swing]:
    """Yield the forces that swing at the end of a run, and are not wanted to."""
    for own in signals.run.actuators:
        t, x = signals.drawn(f'{own.name}.position')
        if not len(t):
            continue
        if not stood(own, x) and settling_time(t, x) is None:
            continue
        span = own.sheet.plant.sensors.force_range
        size, hertz = swing_at_end(signals.drawn(f'{own.name}.force'), _LEAST * span)
        is_fixed = isinstance(own.load, Blocked) or np.ptp(x) == 0.0
        wanted, _ = swing_at_end(signals.drawn(f'{own.name}.force_reference'), 0.5 * size)
        if size and not (is_fixed and wanted):
            yield Swing(own.name, size, hertz, size / span)


def stood(own: ActuatorConfig, x: NDArray[np.float64]) -> bool:
    """Return whether an actuator moved by no more than its support, or its loop, yields."""
    return isinstance(own.load, Blocked) or bool(
        np.ptp(x) <= _STANDS * own.sheet.plant.drive.stroke)


def swing_at_end(signal: Signal, least: float) -> tuple[float, float]:
    """
    Return half of peak to peak, and Hz, of a swing in the last tenth of the time; 0: none.

    It swings where it goes up and down in turn, each time by more than twice ``least``; the
    median of these ways is its height, so that a drift, a step or a pulse beside it does not
    count.
    """
    if not len(signal.t):
        return 0.0, 0.0
    is_tail = (signal.t >= signal.t[-1] - END * (signal.t[-1] - signal.t[0])) & np.isfinite(
        signal.values)
    t, values = signal.t[is_tail], signal.values[is_tail]
    turns = _turns(values, 2.0 * least)
    if len(turns) <= _HALVES:
        return 0.0, 0.0
    # of whole half periods: from the first extreme to the last, without begin and end
    hertz = 0.5 * (len(turns) - 3) / float(t[turns[-2]] - t[turns[1]])
    return 0.5 * float(np.median(np.abs(np.diff(values[turns])))), hertz


def _turns(values: NDArray[np.float64], height: float) -> list[int]:
    """Return the places of begin, extremes and end of ways that are longer than ``height``."""
    turns: list[int] = []
    way = extreme = 0.0
    for place, value in enumerate(values.tolist()):
        if not turns:
            turns, extreme = [place], value
        elif way * (value - extreme) > 0.0:
            extreme, turns[-1] = value, place
        elif abs(value - extreme) > height:
            way, extreme = value - extreme, value
            turns.append(place)
    return turns
