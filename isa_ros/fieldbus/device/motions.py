"""
Motions that a CiA 402 drive makes by itself.

They are profile position (1), profile velocity (3), homing (6), and the halt of modes 1, 3, 8, 9.
Positions here are those of the encoder; ``origin`` is what homing has taken from them on the bus.
In modes 1 and 3 the force that was measured when the mode began bears the load: a setpoint without
it would let an impedance sink.
"""

from collections.abc import Mapping

from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.fieldbus.device import cia402_motion_objects as objects
from isa_ros.fieldbus.device.axis import Axis, COUNTS
from isa_ros.fieldbus.device.cia402_objects import (
    LARGEST_POSITION, LEAST_POSITION, MAX_SPEED, TARGET_POSITION, TARGET_VELOCITY)
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.objects import Value
from isa_ros.fieldbus.device.setpoints import Limiter
from isa_ros.fieldbus.device.trajectory import Trajectory

NEW, IMMEDIATELY, RELATIVE, HALT = 1 << 4, 1 << 5, 1 << 6, 1 << 8
"""Bits of the control word; bit 4 starts a homing too."""
REACHED, ACKNOWLEDGED, FAILED = 1 << 10, 1 << 12, 1 << 13
"""Bits of the status word: target reached; set-point acknowledged, speed 0 or homed; failed."""
_MS_NS = NS_PER_SECOND // 1000


class Motions:
    """The motions of one drive; ``values`` are those of its dictionary."""

    def __init__(self, axis: Axis, values: Mapping[Key, Value], limiter: Limiter) -> None:
        self._axis, self._values, self._limiter = axis, values, limiter
        self._trajectory = Trajectory(axis.step)
        self.origin = 0
        """Position of the encoder that is 0 on the bus, counts."""
        self.force = 0.0
        """Measured when the mode began, N or Nm."""
        self._target: int | None = None
        self._next: int | None = None
        self._control = self._within = 0
        self._is_acknowledged = self._is_homed = self._has_failed = False

    @property
    def position(self) -> float:
        """Return the position of the reference, m or rad."""
        return self._trajectory.position

    @property
    def velocity(self) -> float:
        """Return its velocity, m/s or rad/s."""
        return self._trajectory.velocity

    @property
    def has_target(self) -> bool:
        """Return whether mode 1 has got a target since it began."""
        return self._target is not None

    def begin(self, position: float, control: int) -> None:
        """Begin a mode at rest; a bit 4 that is set already starts nothing."""
        self._trajectory.begin(position)
        self.force = self._axis.field('force')
        self._target = self._next = None
        self._control, self._within = control, 0
        self._is_acknowledged = self._has_failed = False

    def follow(self, position: float) -> None:
        """Take the reference of another mode, so that a halt can brake it."""
        before = self._trajectory.position
        self._trajectory.begin(position, (position - before) / self._axis.step)

    def stop(self) -> None:
        """Brake for a tick, as the halt option code says."""
        is_ramp = self._values[objects.HALT_OPTION] == objects.HALT_BY_RAMP
        self._trajectory.stop(self._si(
            objects.DECELERATION if is_ramp else objects.QUICK_STOP_DECELERATION))
        self._hold_in_range()

    # Mode 1.

    def take_target(self, control: int) -> None:
        """Take a new target at a rising edge of bit 4; one may wait for the present one."""
        rises = control & NEW and not self._control & NEW
        self._control = control
        if rises and self._next is None:
            target = int(self._values[TARGET_POSITION])
            if control & RELATIVE:
                before = self._target if self._next is None else self._next
                target += round(self.position * COUNTS) - self.origin if before is None else before
            self._is_acknowledged = True
            if self._target is None or control & IMMEDIATELY or self._is_at_end:
                self._target, self._within = target, 0
            else:
                self._next = target
        elif not control & NEW and self._next is None:
            self._is_acknowledged = False

    def move_to_target(self) -> None:
        """Move towards the target for a tick."""
        if self._is_at_end and self._next is not None:
            self._target, self._next, self._within = self._next, None, 0
        if self._target is not None:
            self._move(self._in_range((self._target + self.origin) / COUNTS),
                       self._speed(self._si(objects.PROFILE_SPEED)))

    @property
    def _is_at_end(self) -> bool:
        if self._target is None or self.velocity:
            return False
        target = (self._target + self.origin) / COUNTS
        least, largest = self._range
        return self.position == min(max(target, least), largest)

    def watch(self) -> None:
        """Count for how long the axis has been in the position window."""
        window = int(self._values[objects.POSITION_WINDOW])
        is_within = self._is_at_end and (
            window == objects.NO_WINDOW
            or abs(round((self.position - self._axis.position) * COUNTS)) <= window)
        self._within = self._within + 1 if is_within else 0

    @property
    def _is_reached(self) -> bool:
        if int(self._values[objects.POSITION_WINDOW]) == objects.NO_WINDOW:
            return self._is_at_end and self._next is None
        time_ns = int(self._values[objects.WINDOW_TIME]) * _MS_NS
        return self._next is None and self._within * self._axis.step_ns > time_ns

    # Modes 3 and 6.

    def move_with_target(self) -> None:
        """Move with the target velocity for a tick; it brakes ahead of the position limits."""
        velocity = self._si(TARGET_VELOCITY)
        least, largest = self._range
        if velocity:
            limit, speed = largest if velocity > 0.0 else least, self._speed(abs(velocity))
            is_beyond = (limit - self.position) * velocity <= 0.0
            self._limiter.is_limited |= is_beyond or speed > self._trajectory.braked(
                limit, self._si(objects.DECELERATION))
            self._move(limit, speed)
        else:
            self._trajectory.stop(self._si(objects.DECELERATION))
            self._hold_in_range()

    def home(self, control: int) -> None:
        """Make the present position the home offset at a rising edge of bit 4."""
        rises = control & NEW and not self._control & NEW
        self._control = control
        if rises:
            self._has_failed = self._values[objects.HOMING_METHOD] == objects.NO_METHOD
            self._is_homed = not self._has_failed
            if self._is_homed:
                self.origin = round(self._axis.position * COUNTS) - int(
                    self._values[objects.HOME_OFFSET])

    def restart(self) -> None:
        """Forget the homing."""
        self.origin, self._is_homed = 0, False

    # Status word.

    def status_of_position(self, is_halted: bool) -> int:
        """Return the bits of mode 1."""
        is_reached = not self.velocity if is_halted else self._is_reached
        return REACHED * is_reached | ACKNOWLEDGED * self._is_acknowledged

    def status_of_velocity(self, is_halted: bool) -> int:
        """Return the bits of mode 3."""
        wanted = 0.0 if is_halted else self._si(TARGET_VELOCITY)
        return REACHED * (self.velocity == wanted) | ACKNOWLEDGED * (not self.velocity)

    def status_of_homing(self) -> int:
        """Return the bits of mode 6."""
        return REACHED | ACKNOWLEDGED * self._is_homed | FAILED * self._has_failed

    # Limits.

    def _si(self, key: Key) -> float:
        return int(self._values[key]) / COUNTS

    @property
    def _range(self) -> tuple[float, float]:
        return self._si(LEAST_POSITION), self._si(LARGEST_POSITION)

    def _in_range(self, position: float) -> float:
        return self._limiter.limited(position, *self._range)

    def _speed(self, speed: float) -> float:
        return self._limiter.limited(
            speed, 0.0, min(self._si(MAX_SPEED), self._axis.rated_speed))

    def _move(self, target: float, speed: float) -> None:
        self._trajectory.advance(
            target, speed, self._si(objects.ACCELERATION), self._si(objects.DECELERATION))

    def _hold_in_range(self) -> None:
        least, largest = self._range
        if not least <= self.position <= largest:
            self._trajectory.begin(self._in_range(self.position))
