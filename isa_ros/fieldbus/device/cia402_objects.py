"""Objects of the profile CiA 402 (IEC 61800-7-201), scaled for one actuator."""

from collections.abc import Mapping
import math

from isa_ros.core.device import FORCE, IMPEDANCE
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.core.units import MILLI
from isa_ros.fieldbus.device.axis import Axis, INCREMENT, PER_MILLE
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.integer_twins import (
    DAMPING_TWIN, PRESSURE_A_TWIN, PRESSURE_B_TWIN, SPOOL_TWIN, STIFFNESS_TWIN)
from isa_ros.fieldbus.device.manufacturer_area import DAMPING, STIFFNESS
from isa_ros.fieldbus.device.objects import DataType, Object, ObjectEntry, record_of, variable
from isa_ros.fieldbus.device.process_data import (
    ETHERCAT_PDO, INTEGER_PDO, Mapped, RECEIVE, TRANSMIT)

DEVICE_TYPE = 0x00020192
"""Profile 402, servo drive."""
ERROR_CODE, CONTROL, STATUS = (0x603F, 0), (0x6040, 0), (0x6041, 0)
QUICK_STOP_OPTION, SHUTDOWN_OPTION, DISABLE_OPTION = (0x605A, 0), (0x605B, 0), (0x605C, 0)
FAULT_OPTION = (0x605E, 0)
MODE, MODE_SHOWN = (0x6060, 0), (0x6061, 0)
POSITION_DEMAND, POSITION, FOLLOWING_ERROR = (0x6062, 0), (0x6064, 0), (0x60F4, 0)
WINDOW, TIMEOUT = (0x6065, 0), (0x6066, 0)
TARGET_TORQUE, MAX_TORQUE = (0x6071, 0), (0x6072, 0)
LARGEST_OUT, LARGEST_IN = (0x60E0, 0), (0x60E1, 0)
TORQUE_DEMAND, TORQUE = (0x6074, 0), (0x6077, 0)
TARGET_POSITION, LEAST_POSITION, LARGEST_POSITION = (0x607A, 0), (0x607D, 1), (0x607D, 2)
MAX_SPEED = (0x607F, 0)
POSITION_OFFSET, VELOCITY_OFFSET, TORQUE_OFFSET = (0x60B0, 0), (0x60B1, 0), (0x60B2, 0)
TARGET_VELOCITY, VELOCITY = (0x60FF, 0), (0x606C, 0)
PRESSURE_A, PRESSURE_B, SPOOL = (0x2020, 1), (0x2020, 2), (0x2021, 1)

NO_MODE, IMPEDANCE_MODE, PP, PV, HOMING, CSP, CSV, CST = 0, -1, 1, 3, 6, 8, 9, 10
MODE_NAMES: Mapping[int, str] = {
    NO_MODE: 'no mode: holds the position', IMPEDANCE_MODE: 'impedance (manufacturer)',
    PP: 'profile position', PV: 'profile velocity', HOMING: 'homing, methods 35 and 37',
    CSP: 'cyclic synchronous position', CSV: 'cyclic synchronous velocity',
    CST: 'cyclic synchronous torque'}
REFUSED_MODES: Mapping[int, str] = {
    2: 'velocity is a mode of frequency converters: use mode 9',
    4: 'profile torque has no ramp in the drive: send one in mode 10',
    7: 'interpolated position needs a buffer in the drive: send every tick in mode 8'}
"""Why the other modes of the profile are refused."""

_SUPPORTED_BITS = {
    PP: 1 << 0, PV: 1 << 2, HOMING: 1 << 5, CSP: 1 << 7, CSV: 1 << 8, CST: 1 << 9,
    IMPEDANCE_MODE: 1 << 16}
QUICK_STOP_OFF, QUICK_STOP_ENDS_OFF, QUICK_STOP_STAYS = 0, 2, 6
QUICK_STOP_BY = {
    'close': QUICK_STOP_OFF, 'ramp': QUICK_STOP_ENDS_OFF, 'ramp_and_hold': QUICK_STOP_STAYS}
"""The option code that an REU starts with, by its `quick_stop`."""
OFF_AT_ONCE, STOPS_THEN_OFF, FAULT_STOPS = 0, 1, 2
"""Option codes of shutdown, of disable operation and of a fault."""
_I8, _I16, _I32 = DataType.INTEGER8, DataType.INTEGER16, DataType.INTEGER32
_U8, _U16, _U32 = DataType.UNSIGNED8, DataType.UNSIGNED16, DataType.UNSIGNED32
NOT_WATCHED = 0xFFFFFFFF
"""Window that is off, speed without a limit."""
_MICRO_METRES, _MICRO_RADIANS = 0xFA010000, 0xFA100000
"""Units of CiA 303-2: prefix 10^-6, metre or radian."""
_PER_SECOND = 0x0300
_SHORTEST_EXPONENT = 9

PDOS_402: Mapping[int, Mapped] = {
    RECEIVE: (CONTROL, MODE, TARGET_TORQUE),
    RECEIVE + 1: (TARGET_POSITION, TARGET_VELOCITY),
    RECEIVE + 2: (STIFFNESS, DAMPING),
    RECEIVE + 3: (VELOCITY_OFFSET, TORQUE_OFFSET),
    RECEIVE + ETHERCAT_PDO: (
        CONTROL, MODE, 8, TARGET_POSITION, TARGET_VELOCITY, VELOCITY_OFFSET, TARGET_TORQUE,
        TORQUE_OFFSET, STIFFNESS, DAMPING),
    RECEIVE + INTEGER_PDO: (
        CONTROL, MODE, 8, TARGET_POSITION, TARGET_VELOCITY, VELOCITY_OFFSET, TARGET_TORQUE,
        TORQUE_OFFSET, STIFFNESS_TWIN, DAMPING_TWIN),
    TRANSMIT: (STATUS, MODE_SHOWN, TORQUE),
    TRANSMIT + 1: (POSITION, VELOCITY),
    TRANSMIT + 2: (PRESSURE_A, PRESSURE_B),
    TRANSMIT + 3: (SPOOL, ERROR_CODE),
    TRANSMIT + ETHERCAT_PDO: (
        STATUS, MODE_SHOWN, 8, POSITION, VELOCITY, TORQUE, ERROR_CODE, PRESSURE_A, PRESSURE_B,
        SPOOL),
    TRANSMIT + INTEGER_PDO: (
        STATUS, MODE_SHOWN, 8, POSITION, VELOCITY, TORQUE, ERROR_CODE, PRESSURE_A_TWIN,
        PRESSURE_B_TWIN, SPOOL_TWIN)}
"""Mappings by default."""


def modes_of(axis: Axis) -> dict[int, int]:
    """Return the modes of operation that an actuator has, and the mode of its REU for each."""
    found: dict[int, int] = {NO_MODE: 0}
    if axis.position_mode == IMPEDANCE:
        found[IMPEDANCE_MODE] = IMPEDANCE
    if axis.position_mode:
        found |= dict.fromkeys((PP, PV, HOMING, CSP, CSV), axis.position_mode)
    if FORCE in axis.modes:
        found[CST] = FORCE
    return found


def interpolation_period(step_ns: int) -> tuple[int, int] | None:
    """
    Return the tick as 0x60C2 has it: a number of 8 bits, and the power of ten of its seconds.

    None: it has more digits.
    """
    for exponent in range(_SHORTEST_EXPONENT + 1):
        unit_ns = NS_PER_SECOND // 10 ** exponent
        if step_ns % unit_ns == 0:
            value = step_ns // unit_ns
            return (value, -exponent) if value <= _U8.limits[1] else None
    raise AssertionError('a tick is a whole number of nanoseconds')


def cia402_objects(axis: Axis) -> list[Object]:
    """Return the objects of the profile for an actuator."""
    return [*_control_objects(axis), *_position_objects(axis), *_velocity_objects(axis),
            *_torque_objects(axis), *_unit_objects(axis)]


def _one(
        key: Key, name: str, data_type: DataType, access: str = 'ro', default: int = 0, *,
        unit: str = '', scale: float = 1.0, pdo: str = '', meaning: str = '', source: str = '',
        choices: tuple[int, ...] = (), low: float = -math.inf, high: float = math.inf) -> Object:
    return variable(ObjectEntry(
        *key, name, data_type, access, default, unit, scale, pdo, meaning, low, high, choices,
        source))


def _control_objects(axis: Axis) -> list[Object]:
    bits = sum(_SUPPORTED_BITS.get(mode, 0) for mode in modes_of(axis))
    leaving = ((OFF_AT_ONCE, STOPS_THEN_OFF)
               if QUICK_STOP_BY[axis.sheet.reu.device.quick_stop] == QUICK_STOP_ENDS_OFF
               else (OFF_AT_ONCE,))
    return [
        _one((0x6007, 0), 'Abort connection option code', _I16, 'const', 3,
             meaning='3: quick stop, then fault 0x8180'),
        _one(ERROR_CODE, 'Error code', _U16, pdo='tx', meaning='of the fault; 0: none'),
        _one(CONTROL, 'Controlword', _U16, 'rw', pdo='rx'),
        _one(STATUS, 'Statusword', _U16, pdo='tx'),
        _one(QUICK_STOP_OPTION, 'Quick stop option code', _I16, 'rw',
             QUICK_STOP_BY[axis.sheet.reu.device.quick_stop],
             choices=(QUICK_STOP_OFF, QUICK_STOP_ENDS_OFF, QUICK_STOP_STAYS),
             meaning='0: off at once, 2: quick stop, then switch on disabled, 6: quick stop, '
                     'then quick stop active: it holds'),
        *(_one(key, f'{name} option code', _I16, 'rw', OFF_AT_ONCE, choices=leaving,
               meaning='0: off at once, 1: quick stop, then off; not 1 where quick_stop of '
                       'the REU is not ramp')
          for key, name in ((SHUTDOWN_OPTION, 'Shutdown'), (DISABLE_OPTION, 'Disable operation'))),
        _one(FAULT_OPTION, 'Fault reaction option code', _I16, 'rw', FAULT_STOPS,
             choices=(OFF_AT_ONCE, FAULT_STOPS),
             meaning='of a bus that is lost and of the following error; 0: off at once, 2: quick '
                     'stop; of a trip the reaction of its condition'),
        _one(MODE, 'Modes of operation', _I8, 'rw', pdo='rx',
             meaning='others are refused, with the reason in 0x2003'),
        _one(MODE_SHOWN, 'Modes of operation display', _I8, pdo='tx'),
        _one((0x6502, 0), 'Supported drive modes', _U32, 'const', bits,
             meaning='bit 0 PP, 2 PV, 5 HM, 7 CSP, 8 CSV, 9 CST, 16 impedance')]


def _position_objects(axis: Axis) -> list[Object]:
    length, stroke = axis.unit('m | rad'), round(axis.stroke / INCREMENT)

    def position(key: Key, name: str, access: str = 'ro', pdo: str = '', source: str = '',
                 meaning: str = '') -> Object:
        return _one(key, name, _I32, access, unit=length, scale=INCREMENT, pdo=pdo,
                    source=source, meaning=meaning)
    return [
        position(POSITION_DEMAND, 'Position demand value', pdo='tx'),
        position(POSITION, 'Position actual value', pdo='tx', source='position'),
        _one(WINDOW, 'Following error window', _U32, 'rw', NOT_WATCHED, unit=length,
             scale=INCREMENT, meaning='0xFFFFFFFF: not watched'),
        _one(TIMEOUT, 'Following error time out', _U16, 'rw', unit='s', scale=MILLI,
             meaning='longer than that beyond the window is a fault'),
        position(TARGET_POSITION, 'Target position', 'rw', 'rx',
                 meaning='at first the position at t = 0'),
        position(POSITION_OFFSET, 'Position offset', 'rw', 'rx',
                 meaning='added to the target of modes 8 and -1'),
        record_of(0x607D, 'Software position limit', [
            ObjectEntry(0x607D, 1, 'Least position', _I32, 'rw', 0, length, INCREMENT, low=0,
                        high=stroke, meaning='of the encoder: homing does not move it'),
            ObjectEntry(0x607D, 2, 'Largest position', _I32, 'rw', stroke, length, INCREMENT,
                        low=0, high=stroke)]),
        position(FOLLOWING_ERROR, 'Following error actual value', pdo='tx',
                 meaning='in a fault that at its begin')]


def _velocity_objects(axis: Axis) -> list[Object]:
    speed = axis.unit('m/s | rad/s')
    deceleration = axis.sheet.reu.device.quick_stop_deceleration
    return [
        _one(VELOCITY, 'Velocity actual value', _I32, unit=speed, scale=INCREMENT, pdo='tx',
             source='velocity'),
        _one(MAX_SPEED, 'Max profile velocity', _U32, 'rw', NOT_WATCHED, unit=speed,
             scale=INCREMENT, meaning='largest velocity of modes 1, 3 and 9'),
        _one((0x6085, 0), 'Quick stop deceleration', _U32, 'const',
             round(deceleration / INCREMENT), unit=axis.unit('m/s2 | rad/s2'), scale=INCREMENT),
        _one(VELOCITY_OFFSET, 'Velocity offset', _I32, 'rw', unit=speed, scale=INCREMENT,
             pdo='rx', meaning='velocity of the target position; added in mode 9'),
        _one(TARGET_VELOCITY, 'Target velocity', _I32, 'rw', unit=speed, scale=INCREMENT,
             pdo='rx')]


def _torque_objects(axis: Axis) -> list[Object]:
    force, scale = axis.unit('N | Nm'), axis.rated_force * PER_MILLE
    rated_current = round(axis.rated_current / MILLI)
    return [
        _one(TARGET_TORQUE, 'Target torque', _I16, 'rw', unit=force, scale=scale, pdo='rx'),
        *(_one(key, name, _U16, 'rw', 1000, unit=force, scale=scale, high=1000, pdo='rx',
               meaning=meaning) for key, name, meaning in (
            (MAX_TORQUE, 'Max torque', 'of efforts, and of the force towards a position'),
            (LARGEST_OUT, 'Positive torque limit value', 'the same, pushing out only'),
            (LARGEST_IN, 'Negative torque limit value', 'the same, pulling in only'))),
        _one(TORQUE_DEMAND, 'Torque demand', _I16, unit=force, scale=scale, pdo='tx',
             source='force_reference'),
        _one((0x6075, 0), 'Motor rated current', _U32, 'const', rated_current, unit='A',
             scale=MILLI, meaning='range of the current sensor'),
        _one((0x6076, 0), 'Motor rated torque', _U32, 'const',
             round(axis.rated_force / MILLI), unit=force, scale=MILLI),
        _one(TORQUE, 'Torque actual value', _I16, unit=force, scale=scale, pdo='tx',
             source='force'),
        _one((0x6078, 0), 'Current actual value', _I16, unit='A',
             scale=axis.rated_current * PER_MILLE, pdo='tx', source='current'),
        _one(TORQUE_OFFSET, 'Torque offset', _I16, 'rw', unit=force, scale=scale, pdo='rx')]


def _unit_objects(axis: Axis) -> list[Object]:
    unit = _MICRO_RADIANS if axis.sheet.is_rotary else _MICRO_METRES
    words = 'CiA 303-2: micrometre or microradian'
    units = [
        _one((0x60A8, 0), 'SI unit position', _U32, 'const', unit, meaning=words),
        _one((0x60A9, 0), 'SI unit velocity', _U32, 'const', unit | _PER_SECOND,
             meaning=f'{words} per second')]
    period = interpolation_period(axis.step_ns)
    if period is None:
        return units
    value, exponent = period
    return [*units, record_of(0x60C2, 'Interpolation time period', [
        ObjectEntry(0x60C2, 1, 'Value', _U8, 'rw', value, choices=(value,), meaning='of the tick'),
        ObjectEntry(0x60C2, 2, 'Exponent', _I8, 'rw', exponent, choices=(exponent,),
                    meaning='power of ten, s')])]
