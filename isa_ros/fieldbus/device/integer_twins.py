"""
Integer twins of objects that are real numbers, for masters that map integers only.

0x2011 has the gains and the effort of 0x2010: what is written last to either counts, and both show
it. 0x2027 has signals that are REAL32 elsewhere.
"""

from collections.abc import Callable, Iterable, Mapping
import math

from isa_ros.core.fields import units_of
from isa_ros.core.signals import SAMPLE_FIELDS
from isa_ros.core.units import MICRO, MILLI
from isa_ros.fieldbus.device.axis import Axis
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.manufacturer_area import DAMPING, EFFORT, STIFFNESS
from isa_ros.fieldbus.device.objects import DataType, Object, ObjectEntry, record_of, Value

IMPEDANCE, SIGNALS = 0x2011, 0x2027
STIFFNESS_TWIN, DAMPING_TWIN, EFFORT_TWIN = (IMPEDANCE, 1), (IMPEDANCE, 2), (IMPEDANCE, 3)
PRESSURE_A_TWIN, PRESSURE_B_TWIN, SPOOL_TWIN = (SIGNALS, 1), (SIGNALS, 2), (SIGNALS, 4)
TWINS: Mapping[Key, Key] = {
    STIFFNESS_TWIN: STIFFNESS, DAMPING_TWIN: DAMPING, EFFORT_TWIN: EFFORT}
"""The real number of each."""
KEEPS = 0xFFFFFFFF
"""Gain that stays the one in force, as NaN does in 0x2010."""

_U32, _I32, _I16 = DataType.UNSIGNED32, DataType.INTEGER32, DataType.INTEGER16
_SIGNALS = (
    ('pressure_a', 'Pressure of chamber A', _I32, 1.0),
    ('pressure_b', 'Pressure of chamber B', _I32, 1.0),
    ('supply_pressure', 'Supply pressure', _I32, 1.0),
    ('spool', 'Spool position', _I32, 1e-9), ('current', 'Current of the amplifier', _I32, MICRO),
    ('force', 'Measured force', _I32, MILLI), ('temperature', 'Oil in the actuator', _I16, 0.01))
"""Field of `SAMPLE`, name, type, and SI of one count."""


def twin_objects(axis: Axis) -> list[Object]:
    """Return 0x2011 and 0x2027 for an actuator."""
    gain = MILLI if axis.sheet.is_rotary else 1.0
    units = units_of(SAMPLE_FIELDS, axis.sheet.is_rotary)

    def twin(key: Key, name: str, data_type: DataType, unit: str, scale: float,
             meaning: str, high: float = math.inf) -> ObjectEntry:
        return ObjectEntry(*key, name, data_type, 'rw', 0, axis.unit(unit), scale, 'rx', meaning,
                           high=high)
    words = 'of mode -1, as 0x2010; 0xFFFFFFFF: the one in force'
    return [
        record_of(IMPEDANCE, 'Impedance, integers', [
            twin(STIFFNESS_TWIN, 'Stiffness', _U32, 'N/m | Nm/rad', gain, words),
            twin(DAMPING_TWIN, 'Damping', _U32, 'Ns/m | Nms/rad', gain, words),
            twin(EFFORT_TWIN, 'Effort', _I32, 'N | Nm', MILLI, 'added to target torque and '
                 'torque offset')]),
        record_of(SIGNALS, 'Signals, integers', [
            ObjectEntry(SIGNALS, k, name, data_type, unit=units[field], scale=scale, pdo='tx',
                        source=field)
            for k, (field, name, data_type, scale) in enumerate(_SIGNALS, 1)])]


def take_twins(
        values: dict[Key, Value], keys: Iterable[Key], entries: Mapping[Key, ObjectEntry]) -> None:
    """Give the integers at ``keys`` that were written to the real numbers that they stand for."""
    for key in keys:
        if key in TWINS:
            count = int(values[key])
            keeps = count == KEEPS and key != EFFORT_TWIN
            values[TWINS[key]] = math.nan if keeps else count * entries[key].scale


def twin_actuals(
        values: Mapping[Key, Value], entries: Mapping[Key, ObjectEntry]
        ) -> dict[Key, Callable[[], Value]]:
    """Return the functions that show real numbers as integers; beyond the type they saturate."""
    def shown(key: Key) -> Callable[[], Value]:
        scale, (low, high) = entries[key].scale, entries[key].data_type.limits

        def count() -> Value:
            value = float(values[TWINS[key]])
            if math.isnan(value):
                return KEEPS if key != EFFORT_TWIN else 0
            return round(min(max(value / scale, low), high))
        return count
    return {key: shown(key) for key in TWINS}
