"""
Setpoints of a CiA 402 drive by its mode of operation.

Positions on the bus are those of the encoder less the origin that homing has set.
"""

from collections.abc import Mapping
import math

from isa_ros.core.units import MILLI
from isa_ros.fieldbus.device import cia402_objects as objects
from isa_ros.fieldbus.device.axis import Axis, COUNTS
from isa_ros.fieldbus.device.cia402_objects import (
    CSP, CST, CSV, HOMING, IMPEDANCE_MODE, NO_MODE, PP, PV)
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.force_limits import ForceLimits
from isa_ros.fieldbus.device.manufacturer_area import DAMPING, EFFORT, GAINS_OF_CSP, STIFFNESS
from isa_ros.fieldbus.device.motions import Motions
from isa_ros.fieldbus.device.objects import Value
from isa_ros.fieldbus.device.setpoints import (
    ImpedanceGains, KEPT, Limiter, setpoint)
import numpy as np


class ModeSetpoints:
    """Writes the setpoint of a mode; ``values`` are those of the dictionary."""

    def __init__(
            self, axis: Axis, values: Mapping[Key, Value], limiter: Limiter, limits: ForceLimits,
            motions: Motions) -> None:
        self._axis, self._values, self._limiter = axis, values, limiter
        self._limits, self._motions = limits, motions
        self._gains = ImpedanceGains(axis, values)
        self._control = 0
        self._demand = 0.0
        self._modes = {
            NO_MODE: self._holding, CSP: self._position, CSV: self._velocity, CST: self._torque,
            IMPEDANCE_MODE: self._impedance, PP: self._profile_position,
            PV: self._profile_velocity, HOMING: self._homing}

    def write(self, command: np.void, mode: int, control: int, demand: float,
              is_halted: bool) -> tuple[int, float]:
        """
        Write the setpoint of a tick; return its kinds, and the position demanded, m or rad.

        ``demand`` is that of the tick before.
        """
        self._control, self._demand = control, demand
        if is_halted:
            return self._moved(command, mode in (PP, PV)), self._demand
        kinds = self._modes[mode](command)
        if mode in (CSP, CSV):
            self._motions.follow(self._demand)
        return kinds, self._demand

    def _si(self, key: Key) -> float:
        return int(self._values[key]) / COUNTS

    def _limited_position(self, position: float) -> float:
        return self._limiter.limited(
            position, self._si(objects.LEAST_POSITION), self._si(objects.LARGEST_POSITION))

    def _target(self) -> float:
        """Return the target position with its offset, of the encoder."""
        return (int(self._values[objects.TARGET_POSITION]) + self._motions.origin
                + int(self._values[objects.POSITION_OFFSET])) / COUNTS

    def _force(self, *keys: Key, load: float = 0.0) -> float:
        """Return the sum of efforts, limited; N or Nm."""
        per_mille = self._axis.rated_force * MILLI
        value = load + sum(int(self._values[key]) for key in keys) * per_mille
        effort = float(self._values[EFFORT])
        value += 0.0 if math.isnan(effort) else effort
        out, into = self._limits.sides
        return self._limiter.limited(
            value, -min(into, self._axis.force_in), min(out, self._axis.force_out))

    def _setpoint(
            self, command: np.void, position: float, velocity: float, effort: float,
            gains: tuple[float, float] = KEPT) -> int:
        """Write a setpoint with a velocity that the actuator can have; return the kinds."""
        largest = self._axis.rated_speed
        return setpoint(command, position, self._limiter.limited(velocity, -largest, largest),
                        effort, gains)

    def _holding(self, command: np.void) -> int:
        return 0

    def _position(self, command: np.void) -> int:
        self._demand = self._limited_position(self._target())
        gains = self._commanded_gains() if self._values[GAINS_OF_CSP] else self._gains.of_block()
        return self._setpoint(command, self._demand, self._si(objects.VELOCITY_OFFSET),
                              self._force(objects.TORQUE_OFFSET), gains)

    def _velocity(self, command: np.void) -> int:
        largest = self._si(objects.MAX_SPEED)
        velocity = self._limiter.limited(
            self._si(objects.TARGET_VELOCITY) + self._si(objects.VELOCITY_OFFSET),
            -largest, largest)
        self._demand = self._limited_position(self._demand + velocity * self._axis.step)
        return self._setpoint(command, self._demand, velocity, self._force(objects.TORQUE_OFFSET),
                              self._gains.of_block())

    def _profile_position(self, command: np.void) -> int:
        self._motions.take_target(self._control)
        self._motions.move_to_target()
        return self._moved(command, True) if self._motions.has_target else 0

    def _profile_velocity(self, command: np.void) -> int:
        self._motions.move_with_target()
        return self._moved(command, True)

    def _homing(self, command: np.void) -> int:
        self._motions.home(self._control)
        return 0

    def _moved(self, command: np.void, bears_load: bool) -> int:
        """Write the setpoint of a motion that the drive makes by itself."""
        motions = self._motions
        self._demand = motions.position
        load = motions.force if bears_load else 0.0
        return self._setpoint(command, self._demand, motions.velocity,
                              self._force(objects.TORQUE_OFFSET, load=load),
                              self._gains.of_block())

    def _torque(self, command: np.void) -> int:
        return self._setpoint(command, self._axis.position, 0.0,
                              self._force(objects.TARGET_TORQUE, objects.TORQUE_OFFSET))

    def _impedance(self, command: np.void) -> int:
        self._demand = self._limited_position(self._target())
        return self._setpoint(command, self._demand, self._si(objects.TARGET_VELOCITY),
                              self._force(objects.TARGET_TORQUE, objects.TORQUE_OFFSET),
                              self._commanded_gains())

    def _commanded_gains(self) -> tuple[float, float]:
        return self._gains.commanded(
            float(self._values[STIFFNESS]), float(self._values[DAMPING]), self._limiter)
