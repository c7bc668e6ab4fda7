"""
What a unit is given: command, load port and start, each a number with its range.

Their order is that of the library's inputs, and their names, in capitals, are its constants.
"""

from collections.abc import Iterable, Iterator, Mapping

from isa_ros.actuator.config import ConfiguredActuator
from isa_ros.actuator.requests import start_mode
from isa_ros.actuator.setpoint_range import (
    Bounds, load_positions, reference_bounds, setpoint_bounds)
from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.core.device import MODES
from isa_ros.core.signals import LOAD_PORT
from isa_ros.core.units import of_coordinate
from isa_ros.export.fmi.variables import Home, Type, UnitRole, Variable
from isa_ros.export.starting import start_forces
from isa_ros.reu.cascade import initial_gains
from isa_ros.reu.wiring import possible_modes
import numpy as np

PORT_FIELDS: Mapping[str, tuple[str, str, str]] = {
    'x0': ('position', 'm | rad',
           'of the load at the begin of the step; until it is set that of the start'),
    'v0': ('velocity', 'm/s | rad/s', 'of the load at the begin of the step'),
    'a0': ('acceleration', 'm/s2 | rad/s2',
           'of the reference motion of port.stiffness and port.damping'),
    'inverse_mass': ('inverse_mass', '1/kg | 1/(kg m2)',
                     '1/m by which the force accelerates the load within the step; 0: not at all'),
    'a_bias': ('bias', 'm/s2 | rad/s2', 'acceleration of the load within the step, without force'),
    'jerk': ('jerk', 'm/s3 | rad/s3', 'slope of port.bias'),
    'stiffness': ('stiffness', '1/s2', 'towards the reference motion, over the mass'),
    'damping': ('damping', '1/s', 'towards the speed of the reference motion, over the mass'),
}
"""Name, unit and meaning of each field of a `LOAD_PORT` but the pressures  (L1)."""
assert tuple(PORT_FIELDS) == (LOAD_PORT.names or ())[:len(PORT_FIELDS)]

SETPOINT = (
    ('position', 'm | rad', 'that piston or rotor is to have; until it is set start.position'),
    ('velocity', 'm/s | rad/s', 'that it is to have there'),
    ('effort', 'N | Nm', 'feed-forward; in mode force the setpoint'),
    ('stiffness', 'N/m | Nm/rad', 'of the impedance'),
    ('damping', 'Ns/m | Nms/rad', 'of the impedance'),
)
"""Fields of a `COMMAND` that are a setpoint and its gains, in their order there."""


def inputs(config: ConfiguredActuator, start: np.void) -> Iterator[Variable]:
    """
    Yield all that the unit is given; ``start`` is its `START` row.

    An actuator with a load of its own has no port.
    """
    port = _port(config, start) if config.load is None else ()
    for place, found in enumerate((*_command(config, start), *port, *_start(config, start))):
        yield found._replace(place=place)


def _input(name: str, type_: Type, meaning: str, unit: str, start: float,
           bounds: Bounds | None = None, enumeration: str = '') -> Variable:
    return Variable(
        name, type_, UnitRole.INPUT, Home.INPUT, 0, meaning, unit, start,
        None if bounds is None else bounds.low, None if bounds is None else bounds.high,
        enumeration)


def _command(config: ConfiguredActuator, start: np.void) -> Iterator[Variable]:
    sheet = config.sheet
    bounds = setpoint_bounds(sheet)
    stiffness, damping = initial_gains(sheet.reu)
    values = (float(start['position']), 0.0, 0.0, stiffness, damping)
    for (name, unit, meaning), value in zip(SETPOINT, values):
        yield _input(f'setpoint.{name}', Type.REAL, meaning,
                     of_coordinate(unit, sheet.is_rotary), value, bounds.get(name))
    yield _input('enable', Type.BOOLEAN, 'the device is enabled, or is to be', '1',
                 float(config.auto_enable))
    yield _input('clear_fault', Type.BOOLEAN, 'its rising edge clears a fault', '1', 0.0)
    yield _input('quick_stop', Type.BOOLEAN, 'its rising edge is a quick stop', '1', 0.0)
    mode, possible = start_mode(config.name, config.mode, sheet.reu), possible_modes(sheet.reu)
    yield _input('mode', Type.ENUMERATION, f'mode of the device: {modes_of(possible)}', '1',
                 float(mode), Bounds(float(possible[0]), float(possible[-1]), '', ''), 'Mode')
    yield _input('reference', Type.REAL, _references(sheet), '1', 0.0)


def modes_of(numbers: Iterable[int]) -> str:
    """Return modes with their numbers, as 1 current, 6 impedance."""
    return ', '.join(f'{number} {MODES[number]}' for number in numbers)


def _references(sheet: ActuatorSheet) -> str:
    """Return what the reference is in the modes that have one, with its range."""
    bounds = reference_bounds(sheet)
    named = [f'{MODES[mode]}, {bounds[mode].low:g} to {bounds[mode].high:g} {bounds[mode].unit}'
             for mode in possible_modes(sheet.reu) if mode in bounds]
    return f'setpoint of a mode: {"; ".join(named)}; not used in the others'


def _port(config: ConfiguredActuator, start: np.void) -> Iterator[Variable]:
    is_rotary = config.sheet.is_rotary
    bounds = None if config.sheet.is_endless else load_positions(config.sheet)
    for field, (name, unit, meaning) in PORT_FIELDS.items():
        unit = of_coordinate(unit, is_rotary)
        if field == 'x0':
            yield _input(f'port.{name}', Type.REAL, meaning, unit, _load_position(config, start),
                         bounds)
        else:
            yield _input(f'port.{name}', Type.REAL, meaning, unit, 0.0)._replace(
                low=0.0 if field == 'inverse_mass' else None)


def _load_position(config: ConfiguredActuator, start: np.void) -> float:
    """Return where the load is at the start: its force deflects the sensor  (S1), m or rad."""
    stiffness = config.sheet.plant.mechanics.sensor_stiffness
    return float(start['position'] - start['force'] / stiffness)


def _start(config: ConfiguredActuator, start: np.void) -> Iterator[Variable]:
    sheet = config.sheet
    length, force = ('rad', 'Nm') if sheet.is_rotary else ('m', 'N')
    position = setpoint_bounds(sheet).get('position')
    borne = float(start['force'])
    for found in (
            _input('start.position', Type.REAL, 'of piston or rotor at the start', length,
                   float(start['position']), position),
            _input('start.force', Type.REAL, 'that it holds at the start, > 0 pushes out', force,
                   borne, Bounds(*start_forces(config, borne), force, ''))):
        yield found._replace(role=UnitRole.START)
