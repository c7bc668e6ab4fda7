"""
One actuator behind MIT-mode frames: commands become objects of its CiA 402 drive.

The impedance mode (-1) is driven: target position and velocity in counts, stiffness, damping and
effort in SI. ``enable`` resets a fault and leads the drive to operation enabled, one state a tick;
``disable`` switches it off, and so does a fault until the next ``enable``. ``set zero`` makes the
present position 0 in the frames only: the encoder is absolute, and objects and bag keep theirs.
"""

from isa_ros.fieldbus.canopen.mit_frames import (
    answer_frame, command_of, DISABLE, ENABLE, MotorAnswer, Range, Ranges, SET_ZERO)
from isa_ros.fieldbus.device.abort import SdoAbort
from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.device.manufacturer_area import DAMPING, EFFORT, MIT_RANGES, STIFFNESS
from isa_ros.fieldbus.device.objects import Value

_CONTROL, _STATUS, _MODE = (0x6040, 0), (0x6041, 0), (0x6060, 0)
_TARGET_POSITION, _TARGET_VELOCITY = (0x607A, 0), (0x60FF, 0)
_POSITION, _VELOCITY, _FORCE = (0x6064, 0), (0x606C, 0), (0x2022, 1)
_IMPEDANCE = -1
_SUPPORTED, _HAS_IMPEDANCE = (0x6502, 0), 1 << 16
_SHUTDOWN, _SWITCH_ON, _ENABLE_OPERATION, _RESET_FAULT = 0x06, 0x07, 0x0F, 0x80
_IS_FAULTY, _DISABLED = 0x08, 0x40      # bits of the status word
_STATE_MASK, _READY, _SWITCHED_ON, _ENABLED = 0x6F, 0x21, 0x23, 0x27
_NEXT = {_READY: _SWITCH_ON, _SWITCHED_ON: _ENABLE_OPERATION, _ENABLED: _ENABLE_OPERATION}
"""Control word by the state that the status word shows."""


def has_impedance(device: BusDevice) -> bool:
    """Return whether a device has the impedance mode of the profile CiA 402."""
    if _SUPPORTED not in device.table:
        return False
    return bool(int.from_bytes(device.read(*_SUPPORTED), 'little') & _HAS_IMPEDANCE)


class MitMotor:
    """A motor on the bus."""

    def __init__(self, device: BusDevice, number: int) -> None:
        self.device, self.number = device, number
        self.is_on = False
        """Whether it has been enabled."""
        self.is_new = False
        """Whether a command has arrived since the last tick."""
        self._zero = 0
        self._word = 0
        self._is_operational = False
        self._may_reset = False
        self.take_ranges()

    def take_ranges(self) -> None:
        """Take the scales of the frames from the objects, which a master may have written."""
        ends = [float(self._value((MIT_RANGES, k))) for k in range(1, 6)]
        position, velocity, stiffness, damping, effort = ends
        self.ranges = Ranges(
            Range(-position, position), Range(-velocity, velocity), Range(0.0, stiffness),
            Range(0.0, damping), Range(-effort, effort))

    def special(self, kind: int) -> None:
        """Obey a special frame."""
        if kind == ENABLE:
            self._may_reset = self.is_on = True
            if not self._is_operational:
                self._is_operational = True
                self.device.begin_operation()
        elif kind == DISABLE:
            self.is_on = False
        elif kind == SET_ZERO:
            self._zero = int(self._value(_POSITION))

    def take(self, data: bytes) -> None:
        """Take a command, which is in force from the next tick on if the motor is enabled."""
        self.is_new = True
        if not self.is_on:
            return
        command = command_of(data, self.ranges)
        self._write(_MODE, _IMPEDANCE)
        self._write(_TARGET_POSITION,
                    round(command.position / self._scale(_TARGET_POSITION)) + self._zero)
        self._write(_TARGET_VELOCITY, round(command.velocity / self._scale(_TARGET_VELOCITY)))
        self._write(STIFFNESS, command.stiffness)
        self._write(DAMPING, command.damping)
        self._write(EFFORT, command.effort)

    def answer(self) -> bytes:
        """Return the frame with the state at the end of the last tick."""
        position = (int(self._value(_POSITION)) - self._zero) * self._scale(_POSITION)
        velocity = int(self._value(_VELOCITY)) * self._scale(_VELOCITY)
        return answer_frame(
            MotorAnswer(self.number & 0xFF, position, velocity, float(self._value(_FORCE))),
            self.ranges)

    def begin_tick(self) -> None:
        """Give the drive its control word."""
        self.is_new = False
        self._word = self._next_word()
        self._write(_CONTROL, self._word)

    def lose(self) -> None:
        """Take the bus as lost."""
        self.is_on = False
        if self._is_operational:
            self._is_operational = False
            self.device.end_operation(is_lost=True)

    def _next_word(self) -> int:
        if not self.is_on:
            return 0
        status = int(self._value(_STATUS))
        if status & _IS_FAULTY:
            self.is_on = self._may_reset
            return _RESET_FAULT if self.is_on and self._word != _RESET_FAULT else 0
        if status & _DISABLED:
            return _SHUTDOWN
        state = status & _STATE_MASK
        self._may_reset &= state != _ENABLED
        return _NEXT.get(state, 0)

    def _value(self, key: tuple[int, int]) -> Value:
        return self.device.table.entry(*key).data_type.unpack(self.device.read(*key))

    def _scale(self, key: tuple[int, int]) -> float:
        return self.device.table.entry(*key).scale

    def _write(self, key: tuple[int, int], value: float) -> None:
        """Write an object; a value that the drive refuses leaves the one before."""
        data = self.device.table.entry(*key).data_type.pack(value)
        try:
            self.device.write(*key, data, is_preoperational=False)
        except SdoAbort:
            return
