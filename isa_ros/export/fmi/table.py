"""The table of a unit's variables: what it is given, what it shows, its parameters, and time."""

from collections.abc import Iterable, Iterator, Sequence

from isa_ros.config.listing import ListedValue, rows
from isa_ros.config.runs.supplies import SupplyConfig
from isa_ros.core.fields import Field
from isa_ros.core.signals import LOAD_REPLY, SAMPLE_FIELDS
from isa_ros.core.timebase import FORCE_WINDOWS
from isa_ros.core.units import of_coordinate
from isa_ros.export.chosen import ChosenActuator, value_of
from isa_ros.export.fmi.inputs import inputs
from isa_ros.export.fmi.tuned import TunedValue
from isa_ros.export.fmi.variables import Home, Type, UnitRole, Variable
from isa_ros.surroundings.supply_sample import SUPPLY_FIELDS
import numpy as np

_ENUMERATED = {
    'device_state': 'DeviceState', 'device_mode': 'Mode', 'device_event': 'DeviceEvent'}
_WHOLE = ('warnings', 'trips', 'first_trip', 'last_trip', 'unused_setpoints', 'refused_requests',
          'frames_lost_down', 'frames_lost_up', 'commands_dropped')
_YES_OR_NO = ('is_stale',)


def variables(
        chosen: ChosenActuator, supply: SupplyConfig, start: np.void,
        may_change: Sequence[TunedValue]) -> list[Variable]:
    """
    Return all variables of the unit of an actuator with its supply.

    ``start`` is its `START` row; ``may_change`` are the parameters that may be set at any time.
    """
    config = chosen.config
    given = list(inputs(config, start))
    changing = {own.name: own for own in may_change}
    constants = {own.name: own for own in _parameters(chosen, supply)}
    given += [
        constants.pop(name)._replace(
            role=UnitRole.TUNED, home=Home.INPUT, place=len(given) + k, low=own.low, high=own.high)
        for k, (name, own) in enumerate(changing.items())]
    return [
        *given, *_outputs(config.sheet.is_rotary), *_placed(constants.values()),
        Variable('time', Type.REAL, UnitRole.TIME, Home.TIME, 0, 'simulated time', 's')]


def _outputs(is_rotary: bool) -> Iterator[Variable]:
    yield from _sampled(SAMPLE_FIELDS, '', Home.SAMPLE, is_rotary)
    yield from _sampled(SUPPLY_FIELDS, 'supply.', Home.SUPPLY, is_rotary)
    force, length, speed = (of_coordinate(unit, is_rotary)
                            for unit in ('N | Nm', 'm | rad', 'm/s | rad/s'))
    for k in range(FORCE_WINDOWS):
        yield _reply(f'port.mean_force[{k + 1}]', 'mean_forces', k, force,
                     'mean on the load over this part of the last tick, > 0 pushes out')
    yield _reply('port.force', 'force', 0, force, 'on the load at the end of the last tick')
    yield _reply('rod.position', 'position', 0, length, 'of piston or rotor, exact')
    yield _reply('rod.velocity', 'velocity', 0, speed, 'of piston or rotor, exact')


def _sampled(
        fields: Sequence[Field], prefix: str, home: Home, is_rotary: bool) -> Iterator[Variable]:
    """Yield the fields of a sample; each is one number."""
    for place, field in enumerate(fields):
        kind = (Type.ENUMERATION if field.name in _ENUMERATED else
                Type.INTEGER if field.name in _WHOLE else
                Type.BOOLEAN if field.name in _YES_OR_NO else Type.REAL)
        yield Variable(
            f'{prefix}{field.name}', kind, UnitRole.OUTPUT, home, place, field.meaning,
            of_coordinate(field.unit, is_rotary), enumeration=_ENUMERATED.get(field.name, ''))


def _reply(name: str, field: str, place: int, unit: str, meaning: str) -> Variable:
    offset = LOAD_REPLY.fields[field][1] if LOAD_REPLY.fields is not None else 0
    return Variable(name, Type.REAL, UnitRole.OUTPUT, Home.REPLY,
                    offset // np.dtype(float).itemsize + place, meaning, unit)


def _parameters(chosen: ChosenActuator, supply: SupplyConfig) -> Iterator[Variable]:
    """Yield the parameters as `isa params` has them; their places are not known yet."""
    of_supply = [(row._replace(parameter=f'supply.{row.parameter}'), value_of(supply.sheet, row))
                 for row in rows(supply.sheet, {})]
    for row, value in (*chosen.parameters(), *of_supply):
        yield _constant(row, value, chosen.config.sheet.is_rotary)


def _constant(row: ListedValue, value: float | str, is_rotary: bool) -> Variable:
    meaning = f'{row.meaning} ({row.source})' if row.source else row.meaning
    kind, home = ((Type.TEXT, Home.TEXT) if isinstance(value, str) else
                  (Type.REAL, Home.NUMBER))
    return Variable(row.parameter, kind, UnitRole.CONSTANT, home, 0, meaning,
                    of_coordinate(row.unit, is_rotary), value)


def _placed(constants: Iterable[Variable]) -> Iterator[Variable]:
    """Yield constants with their places in the tables of numbers and of texts."""
    counts = {Home.NUMBER: 0, Home.TEXT: 0}
    for own in constants:
        yield own._replace(place=counts[own.home])
        counts[own.home] += 1
