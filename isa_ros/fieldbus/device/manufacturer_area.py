"""Objects 0x2000 to 0x5FFF: increments, further signals, and the gains and limits of the REU."""

from collections.abc import Mapping, Sequence
import math

from isa_ros.actuator.tunable import tunables
from isa_ros.core.changeable import Changeable
from isa_ros.core.fields import units_of
from isa_ros.core.signals import SAMPLE_FIELDS
from isa_ros.fieldbus.device.axis import Axis, FULL_SCALE, INCREMENT, PER_MILLE
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.objects import (
    DataType, Object, ObjectEntry, record_of, Value, variable)
from isa_ros.reu.wiring import VARIABLES

LAST_REFUSAL = (0x2003, 0)
"""Why the last request of the master was refused, as a text."""
_LONGEST = 255
STIFFNESS, DAMPING, EFFORT = (0x2010, 1), (0x2010, 2), (0x2010, 3)
GAINS_OF_CSP = (0x2012, 0)
"""Whether mode 8 of CiA 402 takes the gains of mode -1."""
MIT_RANGES = 0x2002
"""Object with the ranges of MIT-mode frames."""
_GAIN_RANGE = 10.0
_LEAST_RANGE = 1e-6
_REU = 0x2030
"""Object of the position block; those of the inner blocks follow."""
_F32 = DataType.REAL32
_BITS = 'bit set, see docs/protection.md'

_SIGNALS: Sequence[tuple[int, str, Mapping[str, str]]] = (
    (0x2020, 'Pressures', {
        'pressure_a': 'Pressure of chamber A', 'pressure_b': 'Pressure of chamber B'}),
    (0x2021, 'Valve', {
        'spool': 'Spool position', 'spool_velocity': 'Spool velocity',
        'current': 'Current of the amplifier', 'spool_reference': 'Spool reference',
        'current_reference': 'Current reference'}),
    (0x2022, 'Force', {'force': 'Measured force', 'force_reference': 'Force reference'}),
    (0x2023, 'Temperature', {'temperature': 'Oil in the actuator'}),
    (0x2024, 'Supply', {
        'supply_flow': 'Flow drawn, mean of the tick', 'supply_volume': 'Oil drawn',
        'power': 'Power of the oil', 'peak_power': 'Peak power of the oil',
        'supply_pressure': 'Supply pressure'}),
)
"""Index and name of a record, and the names of its entries by field of `SAMPLE`."""
_STATES = (
    ('device_state', 'State', DataType.UNSIGNED8), ('device_mode', 'Mode', DataType.UNSIGNED8),
    ('device_event', 'Last event', DataType.UNSIGNED8))


def note_refusal(values: dict[Key, Value], reason: str) -> None:
    """Keep why a request was refused, in the values of a dictionary."""
    values[LAST_REFUSAL] = reason[:_LONGEST]


def manufacturer_objects(axis: Axis) -> list[Object]:
    """Return the objects of the manufacturer's area of an actuator."""
    units = units_of(SAMPLE_FIELDS, axis.sheet.is_rotary)
    return [
        _increments(axis), _ranges(axis), _mit_ranges(axis),
        variable(ObjectEntry(*LAST_REFUSAL, 'Last refusal', DataType.VISIBLE_STRING, 'ro', '',
                             meaning='why the last request was refused', longest=_LONGEST)),
        _impedance(axis),
        variable(ObjectEntry(*GAINS_OF_CSP, 'Gains of mode 8', DataType.UNSIGNED8, 'rw',
                             choices=(0, 1), meaning='0: those of the block; 1: those of 0x2010, '
                             'as in mode -1, for masters without negative modes')),
        *(record_of(index, name, [
            ObjectEntry(index, subindex, words, _F32, unit=units[field], pdo='tx', source=field)
            for subindex, (field, words) in enumerate(signals.items(), 1)])
          for index, name, signals in _SIGNALS),
        record_of(0x2025, 'Conditions', [
            ObjectEntry(0x2025, 1, 'Warnings', DataType.UNSIGNED32, pdo='tx', source='warnings',
                        meaning=_BITS),
            ObjectEntry(0x2025, 2, 'Trips', DataType.UNSIGNED32, pdo='tx', source='trips',
                        meaning=_BITS)]),
        record_of(0x2026, 'Device of the REU', [
            *(ObjectEntry(0x2026, k + 1, name, data_type, pdo='tx', source=field,
                          meaning='number, see docs/device.md')
              for k, (field, name, data_type) in enumerate(_STATES)),
            ObjectEntry(0x2026, 4, 'Since', _F32, unit='s', pdo='tx', source='state_since')]),
        *_tunable_objects(axis)]


def _increments(axis: Axis) -> Object:
    def entry(subindex: int, name: str, unit: str, value: float) -> ObjectEntry:
        return ObjectEntry(0x2000, subindex, name, _F32, 'const', value, axis.unit(unit))
    return record_of(0x2000, 'Increments', [
        entry(1, 'Position per count', 'm | rad', INCREMENT),
        entry(2, 'Velocity per count', 'm/s | rad/s', INCREMENT),
        entry(3, 'Force per mille', 'N | Nm', axis.rated_force * PER_MILLE),
        entry(4, 'Spool per count of CiA 408', 'm', axis.spool_stop / FULL_SCALE),
        entry(5, 'Pressure per count of CiA 408', 'Pa', axis.pressure_range / FULL_SCALE)])


def _ranges(axis: Axis) -> Object:
    def entry(subindex: int, name: str, unit: str, value: float) -> ObjectEntry:
        return ObjectEntry(0x2001, subindex, name, _F32, 'const', value, axis.unit(unit))
    return record_of(0x2001, 'Ranges', [
        entry(1, 'Stroke', 'm | rad', axis.stroke),
        entry(2, 'Rated force, pushing out', 'N | Nm', axis.force_out),
        entry(3, 'Rated force, pulling in', 'N | Nm', axis.force_in)])


def _mit_ranges(axis: Axis) -> Object:
    """Return the scales of MIT-mode frames, whose 12 bits need ranges near what is used."""
    def entry(subindex: int, name: str, unit: str, value: float, meaning: str) -> ObjectEntry:
        return ObjectEntry(MIT_RANGES, subindex, name, _F32, 'rw', value, axis.unit(unit),
                           meaning=meaning, low=_LEAST_RANGE)
    stiffness, damping = axis.gains
    return record_of(MIT_RANGES, 'Ranges of MIT-mode frames', [
        entry(1, 'Position', 'm | rad', axis.stroke, 'plus and minus; at first the stroke'),
        entry(2, 'Velocity', 'm/s | rad/s', axis.rated_speed,
              'plus and minus; at first that at full opening with the relief pressure'),
        entry(3, 'Stiffness', 'N/m | Nm/rad', _GAIN_RANGE * stiffness or 1.0,
              'from 0; at first 10 times the gain of the configuration'),
        entry(4, 'Damping', 'Ns/m | Nms/rad', _GAIN_RANGE * damping or 1.0,
              'from 0; at first 10 times the gain of the configuration'),
        entry(5, 'Effort', 'N | Nm', axis.rated_force, 'plus and minus; at first the rated')])


def _impedance(axis: Axis) -> Object:
    stiffness, damping = axis.gains
    return record_of(0x2010, 'Impedance', [
        ObjectEntry(*STIFFNESS, 'Stiffness', _F32, 'rw', stiffness, axis.unit('N/m | Nm/rad'),
                    pdo='rx', meaning='of mode -1; NaN in a PDO: the one in force', low=0.0,
                    high=axis.largest_gains[0]),
        ObjectEntry(*DAMPING, 'Damping', _F32, 'rw', damping, axis.unit('Ns/m | Nms/rad'),
                    pdo='rx', meaning='of mode -1; NaN in a PDO: the one in force', low=0.0,
                    high=axis.largest_gains[1]),
        ObjectEntry(*EFFORT, 'Effort', _F32, 'rw', 0.0, axis.unit('N | Nm'), pdo='rx',
                    meaning='added to target torque and torque offset')])


def tunable_keys(axis: Axis) -> dict[Key, Changeable]:
    """Return the gains and limits of the REU by their place in the dictionary."""
    found: dict[Key, Changeable] = {}
    for tunable in tunables(axis.sheet).values():
        index = _REU + VARIABLES.index(tunable.name.partition('.')[0])
        found[index, 1 + sum(key[0] == index for key in found)] = tunable
    return found


def _tunable_objects(axis: Axis) -> list[Object]:
    blocks: dict[int, list[ObjectEntry]] = {}
    for (index, subindex), one in tunable_keys(axis).items():
        low = one.bounds.get('ge', one.bounds.get('gt', -math.inf))
        high = one.bounds.get('le', one.bounds.get('lt', math.inf))
        blocks.setdefault(index, []).append(ObjectEntry(
            index, subindex, one.name, _F32, 'rw', one.value, one.unit, low=low, high=high,
            meaning=one.doc))
    return [record_of(index, f'REU: {VARIABLES[index - _REU]} block', entries)
            for index, entries in blocks.items()]
