"""Objects of CiA 402 for motions that the drive makes by itself: profiles, homing and halt."""

from isa_ros.fieldbus.device.axis import Axis, INCREMENT
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.objects import (
    DataType, Object, ObjectCode, ObjectEntry, variable)

HALT_OPTION = (0x605D, 0)
POSITION_WINDOW, WINDOW_TIME = (0x6067, 0), (0x6068, 0)
HOME_OFFSET, HOMING_METHOD = (0x607C, 0), (0x6098, 0)
PROFILE_SPEED, ACCELERATION, DECELERATION = (0x6081, 0), (0x6083, 0), (0x6084, 0)
QUICK_STOP_DECELERATION, DIGITAL_INPUTS = (0x6085, 0), (0x60FD, 0)
HALT_BY_RAMP, HALT_BY_QUICK_STOP = 1, 2
NO_METHOD, HERE_FORMER, HERE = 0, 35, 37
NO_WINDOW = 0xFFFFFFFF
_SHARE_OF_SPEED = 0.25
"""Profile velocity at power-on, of the speed at full opening: assumed."""
_I8, _I16, _I32 = DataType.INTEGER8, DataType.INTEGER16, DataType.INTEGER32
_U8, _U16, _U32 = DataType.UNSIGNED8, DataType.UNSIGNED16, DataType.UNSIGNED32


def motion_objects(axis: Axis) -> list[Object]:
    """Return the objects for an actuator."""
    length, speed, rate = (axis.unit(one) for one in ('m | rad', 'm/s | rad/s', 'm/s2 | rad/s2'))
    ramp = round(axis.sheet.reu.device.quick_stop_deceleration / INCREMENT)

    def acceleration(key: Key, name: str) -> Object:
        return variable(ObjectEntry(*key, name, _U32, 'rw', ramp, rate, INCREMENT, low=1,
                                    meaning='of modes 1 and 3', pdo='rx'))
    return [
        variable(ObjectEntry(
            *HALT_OPTION, 'Halt option code', _I16, 'rw', HALT_BY_RAMP,
            choices=(HALT_BY_RAMP, HALT_BY_QUICK_STOP),
            meaning='1: with 0x6084, 2: with 0x6085; the drive stays enabled')),
        variable(ObjectEntry(
            *POSITION_WINDOW, 'Position window', _U32, 'rw', NO_WINDOW, length, INCREMENT,
            meaning='of mode 1; 0xFFFFFFFF: the target is reached when the profile ends')),
        variable(ObjectEntry(*WINDOW_TIME, 'Position window time', _U16, 'rw', 0, 's', 1e-3)),
        variable(ObjectEntry(
            *HOME_OFFSET, 'Home offset', _I32, 'rw', 0, length, INCREMENT,
            meaning='position that homing gives to the place where the actuator is')),
        variable(ObjectEntry(
            *PROFILE_SPEED, 'Profile velocity', _U32, 'rw',
            round(_SHARE_OF_SPEED * axis.rated_speed / INCREMENT), speed, INCREMENT, pdo='rx',
            meaning='of mode 1')),
        acceleration(ACCELERATION, 'Profile acceleration'),
        acceleration(DECELERATION, 'Profile deceleration'),
        variable(ObjectEntry(0x6086, 0, 'Motion profile type', _I16, 'const', 0,
                             meaning='0: trapezoidal')),
        variable(ObjectEntry(
            *HOMING_METHOD, 'Homing method', _I8, 'rw', HERE,
            choices=(NO_METHOD, HERE_FORMER, HERE),
            meaning='35, 37: the present position; 0: none. The encoder is absolute')),
        Object(0x60E3, 'Supported homing methods', ObjectCode.ARRAY, (
            ObjectEntry(0x60E3, 0, 'Highest subindex', _U8, 'const', 2),
            ObjectEntry(0x60E3, 1, 'Method 1', _I8, 'const', HERE_FORMER),
            ObjectEntry(0x60E3, 2, 'Method 2', _I8, 'const', HERE))),
        variable(ObjectEntry(
            *DIGITAL_INPUTS, 'Digital inputs', _U32, pdo='tx',
            meaning='bit 0, 1: at or beyond the least, the largest software position limit'))]
