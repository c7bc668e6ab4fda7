"""
Objects of the profile CiA 408 (fluid power), scaled for one actuator.

16384 counts are 100 %: of the spool its stop, of the pressure the range of the sensors. Positions
and velocities are counted as in CiA 402.
"""

from collections.abc import Mapping

from isa_ros.core.device import CURRENT, PRESSURE, SPOOL
from isa_ros.fieldbus.device.axis import Axis, FULL_SCALE, INCREMENT
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.integer_twins import PRESSURE_A_TWIN, PRESSURE_B_TWIN
from isa_ros.fieldbus.device.objects import DataType, Object, ObjectEntry, record_of, variable
from isa_ros.fieldbus.device.process_data import (
    ETHERCAT_PDO, INTEGER_PDO, Mapped, RECEIVE, TRANSMIT)

DEVICE_TYPE = 0x00000198
"""Profile 408."""
ERROR_CODE, CONTROL, STATUS = (0x603F, 0), (0x6040, 0), (0x6041, 0)
DEVICE_MODE, CONTROL_MODE = (0x6042, 0), (0x6043, 0)
SPOOL_SETPOINT, SPOOL_ACTUAL, SPOOL_HOLD = (0x6300, 1), (0x6301, 1), (0x6314, 1)
PRESSURE_SETPOINT, PRESSURE_ACTUAL, PRESSURE_HOLD = (0x6380, 1), (0x6381, 1), (0x6394, 1)
VELOCITY_SETPOINT, VELOCITY_ACTUAL = (0x6500, 1), (0x6501, 1)
POSITION_SETPOINT, POSITION_ACTUAL, POSITION_DEMAND = (0x6600, 1), (0x6601, 1), (0x6610, 1)
_PRESSURE_A, _PRESSURE_B, _FORCE = (0x2020, 1), (0x2020, 2), (0x2022, 1)

FROM_BUS = 1
"""Device mode: the setpoint comes from the bus."""
OPEN_LOOP, CLOSED_LOOP, PQ, AXIS_VELOCITY, AXIS_POSITION = 1, 2, 5, 7, 9
MODE_NAMES: Mapping[int, str] = {
    OPEN_LOOP: 'spool position, open loop', CLOSED_LOOP: 'spool position, closed loop',
    PQ: 'p/Q: the pressure difference', AXIS_VELOCITY: 'velocity of the axis',
    AXIS_POSITION: 'position of the axis'}
"""The control modes of which a wiring of the REU may have some."""

PDOS_408: Mapping[int, Mapped] = {
    RECEIVE: (CONTROL, CONTROL_MODE, SPOOL_SETPOINT, PRESSURE_SETPOINT),
    RECEIVE + 1: (POSITION_SETPOINT, VELOCITY_SETPOINT),
    RECEIVE + 2: (), RECEIVE + 3: (),
    RECEIVE + ETHERCAT_PDO: (
        CONTROL, CONTROL_MODE, 8, POSITION_SETPOINT, VELOCITY_SETPOINT, SPOOL_SETPOINT,
        PRESSURE_SETPOINT),
    TRANSMIT: (STATUS, CONTROL_MODE, SPOOL_ACTUAL, PRESSURE_ACTUAL),
    TRANSMIT + 1: (POSITION_ACTUAL, VELOCITY_ACTUAL),
    TRANSMIT + 2: (_PRESSURE_A, _PRESSURE_B),
    TRANSMIT + 3: (_FORCE, ERROR_CODE),
    TRANSMIT + ETHERCAT_PDO: (
        STATUS, CONTROL_MODE, 8, POSITION_ACTUAL, VELOCITY_ACTUAL, SPOOL_ACTUAL,
        PRESSURE_ACTUAL, ERROR_CODE, 16, _PRESSURE_A, _PRESSURE_B),
    TRANSMIT + INTEGER_PDO: (
        STATUS, CONTROL_MODE, 8, POSITION_ACTUAL, VELOCITY_ACTUAL, SPOOL_ACTUAL,
        PRESSURE_ACTUAL, ERROR_CODE, 16, PRESSURE_A_TWIN, PRESSURE_B_TWIN)}
"""Mappings by default."""

_I8, _I16, _I32 = DataType.INTEGER8, DataType.INTEGER16, DataType.INTEGER32
_METRE, _RADIAN, _MICRO_PREFIX = 0x01, 0x10, -6
"""Units of CiA 303-2."""


def modes_of(axis: Axis) -> dict[int, int]:
    """Return the control modes that an actuator has, and the mode of its REU for each."""
    inner = {OPEN_LOOP: CURRENT, CLOSED_LOOP: SPOOL, PQ: PRESSURE}
    found = {mode: own for mode, own in inner.items() if own in axis.modes}
    if axis.position_mode:
        found[AXIS_VELOCITY] = found[AXIS_POSITION] = axis.position_mode
    return found


def cia408_objects(axis: Axis) -> list[Object]:
    """Return the objects of the profile for an actuator."""
    return [*_control_objects(axis), *_valve_objects(axis), *_axis_objects(axis)]


def _control_objects(axis: Axis) -> list[Object]:
    modes = tuple(sorted(modes_of(axis)))
    unsigned = DataType.UNSIGNED16
    return [
        variable(ObjectEntry(*ERROR_CODE, 'Error code', unsigned, pdo='tx',
                             meaning='of the fault; 0: none')),
        variable(ObjectEntry(*CONTROL, 'Control word', unsigned, 'rw', pdo='rx',
                             meaning='bits 0 D, 1 H, 2 M, 3 R (reset of a fault)')),
        variable(ObjectEntry(*STATUS, 'Status word', unsigned, pdo='tx',
                             meaning='bits 0 D, 1 H, 2 M, 3 R (ready), 8 pressure controller, '
                                     '10 limited')),
        variable(ObjectEntry(*DEVICE_MODE, 'Device mode', _I8, 'rw', FROM_BUS, choices=(FROM_BUS,),
                             meaning='1: the setpoint comes from the bus')),
        variable(ObjectEntry(*CONTROL_MODE, 'Control mode', _I8, 'rw', modes[-1], pdo='both',
                             choices=modes, meaning=', '.join(
                                 f'{mode} {MODE_NAMES[mode]}' for mode in modes)))]


def _valve_objects(axis: Axis) -> list[Object]:
    def value(key: Key, name: str, access: str, pdo: str, source: str = '') -> ObjectEntry:
        is_pressure = key[0] >= PRESSURE_SETPOINT[0]
        unit, full = ('Pa', axis.pressure_range) if is_pressure else ('m', axis.spool_stop)
        return ObjectEntry(
            *key, name, _I16, access, 0, unit, full / FULL_SCALE, pdo, source=source)

    def only(key: Key, name: str, access: str, pdo: str, source: str = '') -> Object:
        return record_of(key[0], name, [value(key, name, access, pdo, source)])
    return [
        only(SPOOL_SETPOINT, 'Spool position setpoint', 'rw', 'rx'),
        only(SPOOL_ACTUAL, 'Spool position actual value', 'ro', 'tx', 'spool'),
        only(SPOOL_HOLD, 'Spool position hold setpoint', 'rw', ''),
        only(PRESSURE_SETPOINT, 'Pressure setpoint', 'rw', 'rx'),
        only(PRESSURE_ACTUAL, 'Pressure actual value', 'ro', 'tx'),
        only(PRESSURE_HOLD, 'Pressure hold setpoint', 'rw', '')]


def _axis_objects(axis: Axis) -> list[Object]:
    length, speed = axis.unit('m | rad'), axis.unit('m/s | rad/s')
    code = _RADIAN if axis.sheet.is_rotary else _METRE

    def position(
            key: Key, name: str, access: str, pdo: str, source: str = '') -> Object:
        index = key[0]
        return record_of(index, name, [
            ObjectEntry(*key, name, _I32, access, 0, length, INCREMENT, pdo, source=source),
            ObjectEntry(index, 2, 'Unit', DataType.UNSIGNED8, 'const', code,
                        meaning='of CiA 303-2'),
            ObjectEntry(index, 3, 'Prefix', _I8, 'const', _MICRO_PREFIX, meaning='power of ten')])

    def velocity(key: Key, name: str, access: str, pdo: str, source: str = '') -> Object:
        return record_of(key[0], name, [
            ObjectEntry(*key, name, _I32, access, 0, speed, INCREMENT, pdo, source=source)])
    return [
        velocity(VELOCITY_SETPOINT, 'Velocity setpoint', 'rw', 'rx'),
        velocity(VELOCITY_ACTUAL, 'Velocity actual value', 'ro', 'tx', 'velocity'),
        position(POSITION_SETPOINT, 'Position setpoint', 'rw', 'rx'),
        position(POSITION_ACTUAL, 'Position actual value', 'ro', 'tx', 'position'),
        position(POSITION_DEMAND, 'Position demand value', 'ro', 'tx')]
