"""
Gains and limits of the loops that a unit may change while it runs, and where they take effect.

Python makes all constants anew from a changed sheet; a unit has no sheet. What it may change are
values that stand in the constants as they are, at one place. That this is so is tried here for
each, at values over its whole range; one for which it is not remains a constant of the unit.
"""

from collections.abc import Iterator
import math
from typing import NamedTuple

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.tunable import GAINS, tunables
from isa_ros.config.assembly import timing_of
from isa_ros.core.changeable import Changeable
from isa_ros.core.parameter import SMALLEST
from isa_ros.errors import ConfigError
from isa_ros.export.exported import Exported
import numpy as np
from numpy.typing import NDArray

_PARTS = (0.013, 0.11, 0.37, 0.51, 0.73, 0.97)    # of a range, at which a value is tried
_SCALES = (1e-4, 1e-2, 1.0)                       # and of its lower end, where gains are
_FLOAT_BYTES = 8


class TunedValue(NamedTuple):
    """A value that may change while the unit runs."""

    name: str
    """Its key, as in `isa params`."""
    low: float
    high: float
    place: int
    """In the memory of the actuator, bytes."""


def tuned(own: Exported) -> list[TunedValue]:
    """
    Return the values that the unit of an actuator may change while it runs.

    None behind a link: there they would travel in its frames.
    """
    if own.actuator.has_link:
        return []
    trial = SmartActuator(own.chosen.config, timing_of(own.chosen.run))
    base = own.layout().place(own.ticked.memory.constants)
    found = []
    for gain in tunables(own.chosen.config.sheet).values():
        low, high = _range(gain)
        if gain.name not in GAINS and math.isfinite(high - low):
            found += [TunedValue(gain.key, low, high, base + place)
                      for place in _places(trial, gain, low, high)]
    return found


def _range(gain: Changeable) -> tuple[float, float]:
    """Return the least and the largest value of a gain; one without a bound is infinite."""
    bounds = gain.bounds
    low = bounds.get('ge', bounds['gt'] + SMALLEST if 'gt' in bounds else -math.inf)
    return low, bounds.get('le', math.inf)


def _constants(actuator: SmartActuator) -> NDArray[np.float64]:
    """Return the constants of an actuator as numbers of 8 bytes, a copy."""
    return np.frombuffer(actuator.memory.constants.tobytes(), np.float64)


def _places(
        trial: SmartActuator, gain: Changeable, low: float, high: float) -> Iterator[int]:
    """Yield the byte at which the constants have a gain as it is; nothing: there is no such."""
    before = _constants(trial).view(np.int64)
    changed: set[int] = set()
    tried = 0
    for value in (low + (high - low) * part * scale for scale in _SCALES for part in _PARTS):
        try:
            trial.tune({gain.key: value})
        except ConfigError:     # it does not fit the others
            continue
        trial.latch_tuning()
        now = _constants(trial)
        changed |= {int(k) for k in np.flatnonzero(now.view(np.int64) != before)}
        if len(changed) != 1 or now[min(changed)] != value:
            break
        tried += 1
    else:
        if tried > 1:
            yield min(changed) * _FLOAT_BYTES
    trial.tune({gain.name: gain.value})
    trial.latch_tuning()
