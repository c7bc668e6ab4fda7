"""
The range of an actuator's setpoints: stroke, rated force, usable gains, valve and modes.

A setpoint from a topic or from Python that leaves the range is refused, or limited to it where
the configuration says ``beyond_range: limit``; both are reported.
"""

from collections.abc import Mapping
import math
from typing import NamedTuple

from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.actuator.tunable import GAINS, tunables
from isa_ros.core.device import CURRENT, MODES, PRESSURE, SPOOL
from isa_ros.core.signals import HAS_MODE, HAS_REFERENCE, HAS_SETPOINT
from isa_ros.core.units import MILLI, MPA
from isa_ros.errors import ConfigError, SetpointError
from isa_ros.plant.coil import coil_record
from isa_ros.reu.impedance import Impedance
from isa_ros.reu.wiring import mode_of, Off
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


def reference_bounds(sheet: ActuatorSheet) -> Mapping[int, Bounds]:
    """Return the ranges of the references by their mode."""
    valve, pressure = sheet.plant.valve, sheet.plant.sensors.pressure_range_mpa * MPA
    spool = valve.spool_stop_mm * MILLI
    current = coil_record(sheet.plant.coil).parallel * spool / valve.spool_gain_mm_per_ma
    return {
        SPOOL: Bounds(-spool, spool, 'm', 'the stop of the spool'),
        CURRENT: Bounds(-current, current, 'A', 'the stop of the spool'),
        PRESSURE: Bounds(-pressure, pressure, 'Pa', 'the range of the pressure sensors')}


class SetpointRange:
    """
    Checks the setpoints of actuator ``name``.

    ``beyond``: one of `BEYOND_RANGE`, None for the default.
    """

    def __init__(self, name: str, sheet: ActuatorSheet, beyond: str | None = None) -> None:
        self._name = name
        self._limits = beyond == LIMIT
        self._reu = sheet.reu
        self._bounds = setpoint_bounds(sheet)
        self._references = reference_bounds(sheet)

    def admit(self, command: np.void, mode: int) -> str:
        """
        Limit the fields of a `COMMAND` row in place, and return what was limited, or ''.

        ``mode`` is the one in force at the next tick, without this command.

        Raises
        ------
        SetpointError
            A field is beyond its range and is not limited, the wiring does not have the mode, or
            a reference is of another mode; the whole setpoint is refused.

        """
        kinds = int(command['kinds'])
        mode = int(command['mode']) if kinds & HAS_MODE else mode
        self._refuse_mode(command, kinds, mode)
        limited = []
        if kinds & HAS_SETPOINT:
            limited = [self._limited(command, field, field, bounds)
                       for field, bounds in self._bounds.items()]
        if kinds & HAS_REFERENCE:
            limited.append(
                self._limited(command, 'reference', MODES[mode], self._references[mode]))
        return '; '.join(text for text in limited if text)

    def _refuse_mode(self, command: np.void, kinds: int, mode: int) -> None:
        if kinds & HAS_MODE:
            try:
                mode_of(MODES[mode], self._reu, f'{self._name}: mode')
            except ConfigError as error:
                raise SetpointError(str(error)) from error
        if kinds & HAS_REFERENCE and command['mode'] != mode:
            raise SetpointError(
                f"{self._name}: setpoint {MODES[int(command['mode'])]} is not of the mode in "
                f'force, {MODES[mode]}; change the mode first')

    def _limited(self, command: np.void, field: str, name: str, bounds: Bounds) -> str:
        """Limit one field; return what was limited, or ''."""
        low, high, unit, what = bounds
        value = float(command[field])
        if math.isnan(value) or low <= value <= high:
            return ''
        text = f'{self._name}: setpoint {name} = {value:g} {unit}'
        if not self._limits:
            raise SetpointError(
                f'{text}, must be {low:g} to {high:g} {unit}, {what}; the key beyond_range: '
                f'{LIMIT} of the actuator limits it instead')
        command[field] = min(max(value, low), high)
        return f'{text}, limited to {float(command[field]):g} {unit}, {what}'
