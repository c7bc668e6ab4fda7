"""
The range of an actuator's setpoints: stroke, rated force, usable gains, valve and modes.

A setpoint that leaves the range is refused, or limited to it where the configuration says
``beyond_range: limit``; both are reported. Setpoints of topics, of Python and of controllers are
checked at every one, those of scenarios when the file is read.
"""

from collections.abc import Iterator, Mapping
import math
from typing import NamedTuple

from isa_ros.actuator.ratings import ratings_of
from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.actuator.tunable import GAINS, tunables
from isa_ros.core.changeable import sound
from isa_ros.core.device import CURRENT, FORCE, IMPEDANCE, MODES, POSITION, PRESSURE, SPOOL
from isa_ros.core.remembered import remembered
from isa_ros.core.signals import HAS_GAINS, HAS_MODE, HAS_REFERENCE, HAS_SETPOINT, Records
from isa_ros.core.units import MILLI, MPA
from isa_ros.errors import ConfigError, SetpointError
from isa_ros.plant.coil import coil_record
from isa_ros.plant.plant import plant_record
from isa_ros.reu.impedance import Impedance
from isa_ros.reu.wiring import mode_of, Off
import numpy as np

LIMIT = 'limit'
BEYOND_RANGE = ('refuse', LIMIT)
"""What happens to a setpoint beyond the range: the first is the default."""
NUMBERS = {
    FORCE: ('effort',), POSITION: ('position', 'velocity'),
    IMPEDANCE: ('position', 'velocity', 'effort')}
"""What each mode uses of position, velocity and effort; the inner modes may use the effort."""
MOST_TURNS = 1e4
"""Largest position of a motor either way."""
LOAD_BEYOND = 0.5
"""Of the stroke, for a load that a program moves beyond its end; end stops yield far less."""


class Bounds(NamedTuple):
    """The range of one field of a setpoint, SI."""

    low: float
    high: float
    unit: str
    what: str


@remembered
def setpoint_bounds(sheet: ActuatorSheet) -> Mapping[str, Bounds]:
    """Return the ranges by field of a `COMMAND`; a field that no block uses has none."""
    position = sheet.reu.position
    if isinstance(position, Off):
        return {}
    length, force = ('rad', 'Nm') if sheet.is_rotary else ('m', 'N')
    speed = ratings_of(plant_record(sound(sheet.plant))[0]).speed
    bounds = {
        'position': positions(sheet),
        'velocity': Bounds(-speed, speed, f'{length}/s', 'the speed at full opening')}
    if isinstance(position, Impedance):
        bounds['effort'] = Bounds(
            -position.force_in, position.force_out, force, 'the rated force')
    known = tunables(sheet)
    for name, gain in GAINS.items():
        if name in known:
            bounds[gain] = Bounds(
                0.0, known[name].bounds['le'], known[name].unit, 'the usable gains')
    return bounds


def positions(sheet: ActuatorSheet) -> Bounds:
    """Return where an actuator can be."""
    length = 'rad' if sheet.is_rotary else 'm'
    if sheet.is_endless:
        most = MOST_TURNS * sheet.plant.drive.stroke
        return Bounds(-most, most, length, f'{MOST_TURNS:g} turns')
    return Bounds(0.0, sheet.plant.drive.stroke, length, 'the stroke')


def load_positions(sheet: ActuatorSheet) -> Bounds:
    """Return where a load may be that a program moves; that of a motor may turn without end."""
    own = positions(sheet)
    if sheet.is_endless:
        return Bounds(-math.inf, math.inf, own.unit, 'any number of turns')
    beyond = LOAD_BEYOND * (own.high - own.low)
    return Bounds(own.low - beyond, own.high + beyond, own.unit, 'half a stroke beyond the ends')


def reference_bounds(sheet: ActuatorSheet) -> Mapping[int, Bounds]:
    """Return the ranges of the references by their mode."""
    valve, pressure = sheet.plant.valve, sheet.plant.sensors.pressure_range_mpa * MPA
    spool = valve.spool_stop_mm * MILLI
    current = coil_record(sheet.plant.coil).parallel * spool / valve.spool_gain_mm_per_ma
    return {
        SPOOL: Bounds(-spool, spool, 'm', 'the stop of the spool'),
        CURRENT: Bounds(-current, current, 'A', 'the stop of the spool'),
        PRESSURE: Bounds(-pressure, pressure, 'Pa', 'the range of the pressure sensors')}


class Beyond(NamedTuple):
    """A field of a setpoint that leaves its range."""

    field: str
    name: str
    """As users know the field: a reference has the name of its mode."""
    value: float
    bounds: Bounds

    @property
    def shown(self) -> str:
        """Return name, value and unit."""
        return f'{self.name} = {self.value:g} {self.bounds.unit}'

    @property
    def nearest(self) -> float:
        """Return the value of the range that is nearest."""
        return min(max(self.value, self.bounds.low), self.bounds.high)

    @property
    def refusal(self) -> str:
        """Return what the value must be."""
        low, high, unit, what = self.bounds
        return f'must be {low:g} to {high:g} {unit}, {what}'

    @property
    def limitation(self) -> str:
        """Return what the value is limited to."""
        return f'limited to {self.nearest:g} {self.bounds.unit}, {self.bounds.what}'


class SetpointRange:
    """
    Checks the setpoints of actuator ``name``.

    ``beyond``: one of `BEYOND_RANGE`, None for the default.
    """

    def __init__(self, name: str, sheet: ActuatorSheet, beyond: str | None = None) -> None:
        self._name = name
        self.limits = beyond == LIMIT
        """Whether a setpoint beyond the range is limited to it; otherwise it is refused."""
        self.bounds = setpoint_bounds(sheet)
        """The range of each field that has one."""
        self._reu = sheet.reu
        self._references = reference_bounds(sheet)

    def beyond(self, command: np.void) -> Iterator[Beyond]:
        """Return the fields of a `COMMAND` row that leave their range."""
        kinds = int(command['kinds'])
        if kinds & (HAS_SETPOINT | HAS_GAINS):
            for field, bounds in self.bounds.items():
                if not kinds & HAS_SETPOINT and field not in GAINS.values():
                    continue
                yield from _beyond(field, field, command, bounds)
        mode = int(command['mode'])
        if kinds & HAS_REFERENCE and mode in self._references:
            yield from _beyond('reference', MODES[mode], command, self._references[mode])

    def admit(self, command: np.void, mode: int | None = None) -> str:
        """
        Limit the fields of a `COMMAND` row in place, and return what was limited, or ''.

        ``mode`` is the one in force at the next tick, without this command; None: not known.

        Raises
        ------
        SetpointError
            A field is beyond its range and is not limited, the mode needs one that is NaN, the
            wiring does not have the mode, or a reference is of another mode; the whole setpoint is
            refused.

        """
        self._refuse_mode(command, mode)
        self._refuse_absent(command, mode)
        limited = []
        for found in self.beyond(command):
            text = f'{self._name}: setpoint {found.shown}'
            if not self.limits:
                raise SetpointError(
                    f'{text}, {found.refusal}; the key beyond_range: {LIMIT} of the actuator '
                    'limits it instead')
            command[found.field] = found.nearest
            limited.append(f'{text}, {found.limitation}')
        return '; '.join(limited)

    def limit(self, commands: Records) -> None:
        """Limit the fields of `COMMAND` rows of one kind and mode in place, (n,)."""
        kinds, mode = int(commands['kinds'][0]), int(commands['mode'][0])
        bounds = dict(self.bounds) if kinds & HAS_SETPOINT else {}
        if kinds & HAS_REFERENCE:
            bounds['reference'] = self._references[mode]
        for name, own in bounds.items():
            np.clip(commands[name], own.low, own.high, out=commands[name])

    def _refuse_mode(self, command: np.void, mode: int | None) -> None:
        kinds, own = int(command['kinds']), int(command['mode'])
        if kinds & HAS_MODE:
            try:
                mode_of(MODES[own], self._reu, f'{self._name}: mode')
            except ConfigError as error:
                raise SetpointError(str(error)) from error
        elif kinds & HAS_REFERENCE and mode is not None and own != mode:
            raise SetpointError(
                f'{self._name}: setpoint {MODES[own]} is not of the mode in force, '
                f'{MODES[mode]}; change the mode first')

    def _refuse_absent(self, command: np.void, mode: int | None) -> None:
        """Refuse a setpoint in which a number that its mode uses is NaN: it is not given."""
        kinds = int(command['kinds'])
        if not kinds & HAS_SETPOINT:
            return
        own = int(command['mode']) if kinds & HAS_MODE else mode
        needed = NUMBERS[IMPEDANCE] if own is None else NUMBERS.get(own, NUMBERS[FORCE])
        for field in needed:
            if math.isnan(command[field]):
                raise SetpointError(
                    f'{self._name}: setpoint {field} is missing or NaN, must be given in mode '
                    f'{MODES[own or IMPEDANCE]}')


def complete(command: np.void, position: float) -> None:
    """
    Replace the numbers of a setpoint that are NaN, which its mode does not use, in place.

    Its position becomes ``position``, velocity and effort zero.
    """
    if int(command['kinds']) & HAS_SETPOINT:
        for field, value in (('position', position), ('velocity', 0.0), ('effort', 0.0)):
            if math.isnan(command[field]):
                command[field] = value


def _beyond(field: str, name: str, command: np.void, bounds: Bounds) -> Iterator[Beyond]:
    """Yield the field if its value leaves its range; NaN keeps a gain."""
    value = float(command[field])
    if not math.isnan(value) and not bounds.low <= value <= bounds.high:
        yield Beyond(field, name, value, bounds)
