"""
The range of an actuator's setpoints: its stroke, its rated force and its usable gains.

A setpoint from a topic or from Python that leaves the range is refused, or limited to it where
the configuration says ``beyond_range: limit``; both are reported.
"""

from collections.abc import Mapping
import math
from typing import NamedTuple

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.actuator.tunable import GAINS, tunables
from isa_ros.core.signals import HAS_SETPOINT
from isa_ros.errors import SetpointError
from isa_ros.reu.impedance import Impedance
from isa_ros.reu.wiring import Off
import numpy as np

LIMIT = 'limit'
BEYOND_RANGE = ('refuse', LIMIT)
"""What happens to a setpoint beyond the range: the first is the default."""


class Bounds(NamedTuple):
    """The range of one field of a setpoint, SI."""

    low: float
    high: float
    unit: str
    what: str


def setpoint_bounds(sheet: ActuatorSheet) -> Mapping[str, Bounds]:
    """Return the ranges by field of a `COMMAND`; a field that no block uses has none."""
    position = sheet.reu.position
    if isinstance(position, Off):
        return {}
    length, force = ('rad', 'Nm') if sheet.is_rotary else ('m', 'N')
    bounds = {'position': Bounds(0.0, sheet.plant.drive.stroke, length, 'the stroke')}
    if isinstance(position, Impedance):
        bounds['effort'] = Bounds(
            -position.force_in, position.force_out, force, 'the rated force')
    known = tunables(sheet)
    for name, gain in GAINS.items():
        if name in known:
            bounds[gain] = Bounds(
                0.0, known[name].bounds['le'], known[name].unit, 'the usable gains')
    return bounds


class SetpointRange:
    """
    Checks the setpoints of actuator ``name``.

    ``beyond``: one of `BEYOND_RANGE`, None for the default.
    """

    def __init__(self, name: str, sheet: ActuatorSheet, beyond: str | None = None) -> None:
        self._name = name
        self._limits = beyond == LIMIT
        self._bounds = setpoint_bounds(sheet)

    def admit(self, command: np.void) -> str:
        """
        Limit the fields of a `COMMAND` row in place, and return what was limited, or ''.

        Raises
        ------
        SetpointError
            A field is beyond its range and is not limited; the whole setpoint is refused.

        """
        if not int(command['kinds']) & HAS_SETPOINT:
            return ''
        limited = []
        for field, (low, high, unit, what) in self._bounds.items():
            value = float(command[field])
            if math.isnan(value) or low <= value <= high:
                continue
            text = f'{self._name}: setpoint {field} = {value:g} {unit}'
            if not self._limits:
                raise SetpointError(
                    f'{text}, must be {low:g} to {high:g} {unit}, {what}; the key beyond_range: '
                    f'{LIMIT} of the actuator limits it instead')
            command[field] = min(max(value, low), high)
            limited.append(f'{text}, limited to {float(command[field]):g} {unit}, {what}')
        return '; '.join(limited)
