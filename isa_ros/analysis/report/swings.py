"""Forces that go on to swing where the motion has ended, as those of loops that hunt."""

from collections.abc import Iterator
from typing import NamedTuple

from isa_ros.analysis.report.key_figures import end_of, settling_time
from isa_ros.analysis.signals.signals import Signal, Signals
from isa_ros.analysis.signals.swing import Swing, swing
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.loads.sheets import Blocked
from isa_ros.reu.wiring import active
import numpy as np
from numpy.typing import NDArray

_LEAST = 0.01       # of the range of the force sensor: a larger swing is told
_STANDS = 1e-3      # of the stroke: who moves by less stands


class SwingingForce(NamedTuple):
    """A force that swings in the last tenth of the time."""

    actuator: str
    size: float
    """Half of peak to peak, N or Nm."""
    hertz: float
    share: float
    """Of the range of the force sensor."""


def swings(signals: Signals) -> Iterator[SwingingForce]:
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
            yield SwingingForce(own.name, size, hertz, size / span)


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


def swing_at_end(signal: Signal, least: float) -> Swing:
    """Return the `swing` in the last tenth of the time."""
    return swing(*end_of(signal), least)
