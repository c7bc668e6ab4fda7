"""Setpoints from the values of a dictionary: in SI, and limited to what the actuator has."""

from collections.abc import Mapping
from dataclasses import dataclass
import math

from isa_ros.core.signals import HAS_ENABLE, HAS_MODE, HAS_REFERENCE, HAS_SETPOINT
from isa_ros.fieldbus.device.axis import Axis
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.manufacturer_area import tunable_keys
from isa_ros.fieldbus.device.objects import Value
import numpy as np

_GAINS = ('position.stiffness', 'position.damping')
KEPT = (math.nan, math.nan)
"""Gains that stay as they are."""


@dataclass
class Limiter:
    """Limits values, and notes whether it had to."""

    is_limited: bool = False

    def limited(self, value: float, low: float, high: float) -> float:
        """Return the nearest value of the range."""
        if low <= value <= high:
            return value
        self.is_limited = True
        return high if value > high else low


class ImpedanceGains:
    """The gains of an impedance: those of its block, or those that come with each setpoint."""

    def __init__(self, axis: Axis, values: Mapping[Key, Value]) -> None:
        by_name = {one.name: key for key, one in tunable_keys(axis).items()}
        self._keys = [by_name[name] for name in _GAINS if name in by_name]
        self._largest = axis.largest_gains
        self._values = values
        self._are_commanded = False

    def commanded(self, stiffness: float, damping: float, limiter: Limiter) -> tuple[float, float]:
        """Return the gains of a setpoint, limited; NaN keeps the one in force."""
        self._are_commanded = True
        found = [value if math.isnan(value) else limiter.limited(value, 0.0, high)
                 for value, high in zip((stiffness, damping), self._largest)]
        return found[0], found[1]

    def of_block(self) -> tuple[float, float]:
        """Return those of the block if others are in force, else `KEPT`."""
        if not self._are_commanded or len(self._keys) < len(KEPT):
            return KEPT
        self._are_commanded = False
        stiffness, damping = (float(self._values[key]) for key in self._keys)
        return stiffness, damping


def enable(command: np.void, mode: int) -> int:
    """Write a mode of the REU (0: the present one) and the enabling; return the kinds."""
    command['is_enabled'] = 1
    if not mode:
        return HAS_ENABLE
    command['mode'] = mode
    return HAS_ENABLE | HAS_MODE


def change_mode(command: np.void, mode: int) -> int:
    """Write a mode of the REU; return the kinds."""
    command['mode'] = mode
    return HAS_MODE


def setpoint(
        command: np.void, position: float, velocity: float = 0.0, effort: float = 0.0,
        gains: tuple[float, float] = KEPT) -> int:
    """Write a setpoint, SI; return the kinds."""
    command['position'], command['velocity'], command['effort'] = position, velocity, effort
    command['stiffness'], command['damping'] = gains
    return HAS_SETPOINT


def reference(command: np.void, mode: int, value: float) -> int:
    """Write the reference of an inner mode, SI; return the kinds."""
    command['mode'], command['reference'] = mode, value
    return HAS_REFERENCE
