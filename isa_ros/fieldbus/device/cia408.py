"""
A CiA 408 device on top of the REU's own device: what valves for fluid power follow.

In HOLD the REU is enabled with the hold setpoint: of an axis the position measured when it was
entered. In ACTIVE it has the setpoint of the bus.
"""

from isa_ros.core.device import ENABLED, FAULT, FAULT_REACTION, INITIALISING, PRESSURE
from isa_ros.fieldbus.device import cia408_objects as objects
from isa_ros.fieldbus.device.axis import Axis, COUNTS, FULL_SCALE
from isa_ros.fieldbus.device.cia408_objects import AXIS_POSITION, AXIS_VELOCITY, PQ
from isa_ros.fieldbus.device.cia408_states import (
    control_of, Event408, FAULTS, FOLLOWING, HOLDING, HOLDS, level_of, MAY_ACT, MAY_ENABLE, R,
    State408, WAS_DISABLED, WAS_INIT)
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.drive import Drive
from isa_ros.fieldbus.device.faults import Faults
from isa_ros.fieldbus.device.objects import Value
from isa_ros.fieldbus.device.setpoints import reference, setpoint
from isa_ros.fieldbus.device.states import Transition
import numpy as np

PRESSURE_CONTROLS, LIMITED = 1 << 8, 1 << 10
"""Further bits of the status word."""


class Drive408(Drive):
    """The device of one actuator."""

    following = FOLLOWING
    fault, reaction_ends, reset, left = (
        Event408.FAULT, Event408.REACTION_ENDS, Event408.RESET, Event408.LEFT)
    first_state = State408.INIT
    faults, control, reset_bit = FAULTS, objects.CONTROL, R
    faulty = (*faults, State408.FAULT_REACTION)
    mode_words = 'control mode'

    def __init__(self, axis: Axis, values: dict[Key, Value], faults: Faults) -> None:
        super().__init__(
            axis, values, faults, State408.NOT_READY, objects.CONTROL_MODE, objects.modes_of(axis),
            int(values[objects.CONTROL_MODE]))
        self._before = 0
        self._is_blocked = self._is_held = False
        self.actuals = {
            objects.STATUS: self.status, objects.CONTROL_MODE: lambda: self._mode,
            objects.PRESSURE_ACTUAL: self._pressure,
            objects.POSITION_DEMAND: lambda: round(self._demand * COUNTS)}

    # Side of the bus.

    def end_operation(self, is_lost: bool) -> None:
        """Leave it: hold, and with a fault if the bus is lost."""
        self._values[objects.CONTROL] = control_of(min(self.state.level, State408.HOLD.level))
        self._is_held |= self.state is State408.ACTIVE and not is_lost
        super().end_operation(is_lost)

    def restart(self, is_whole: bool) -> None:
        """Enter INIT at once; H must fall before the REU is enabled again."""
        super().restart(is_whole)
        if self.state is State408.INIT:
            self._is_blocked = True

    def _begin_at_position(self) -> None:
        self._demand = self._axis.position
        self._values[objects.POSITION_SETPOINT] = round(self._demand * COUNTS)

    def status(self) -> int:
        """Return the status word."""
        word = self.state.bits
        if self.state is State408.ACTIVE:
            word |= PRESSURE_CONTROLS * (self._mode == PQ)
            word |= LIMITED * self._limiter.is_limited
        return word

    def _pressure(self) -> int:
        axis = self._axis
        difference = axis.field('pressure_a') - axis.field('pressure_b')
        return round(difference / axis.pressure_range * FULL_SCALE)

    # Side of the run.

    def take_sample(self) -> None:
        """Follow what the REU reports."""
        axis = self._axis
        if not self._has_start:
            self._has_start = True
            self._begin_at_position()
        self._happens(Event408.INITIALISED)
        self._is_stopping &= axis.is_on
        has_tripped = axis.state in (FAULT_REACTION, FAULT) and not self._clears
        if self.state is State408.FAULT_REACTION:
            if axis.is_off or axis.state == ENABLED:
                self._happens(Event408.REACTION_ENDS)
        elif has_tripped:
            self._happens(Event408.FAULT)
            self._end_reaction()
        if not has_tripped and not self._faults.has_own:
            self._happens(Event408.RESET)
        if self.state in (State408.HOLD, State408.ACTIVE):
            if axis.state != ENABLED and (self._was_on or axis.has_emergency_stop):
                self._is_blocked = True
                self._happens(Event408.DROPPED)
            self._was_on = axis.state == ENABLED

    def fill_command(self, command: np.void) -> None:
        """Write the `COMMAND` of a tick; what dropped may be enabled again once H has fallen."""
        if self._is_remote:
            wanted = level_of(int(self._values[objects.CONTROL]))
            self._is_blocked &= wanted >= State408.HOLD.level
            self._is_held &= wanted >= State408.ACTIVE.level
        super().fill_command(command)

    def _obey(self, control: int) -> None:
        wanted = level_of(control)
        if wanted != self.state.level:
            self._happens(Event408.RISE if wanted > self.state.level else Event408.FALL)

    def _kinds(self, command: np.void) -> int:
        axis = self._axis
        has_tripped = axis.state in (FAULT_REACTION, FAULT)
        if self.state in HOLDING and not has_tripped:
            return self._operate(command)
        if self._is_stopping:
            return self._stopped(command)
        if has_tripped or not (axis.is_on or axis.state == INITIALISING):
            return 0
        return self._off(command)

    def _operate(self, command: np.void) -> int:
        wanted = self._modes[self._mode]
        kinds = self._enabled(command, wanted)
        if self._mode in (AXIS_VELOCITY, AXIS_POSITION):
            return kinds | self._axis_setpoint(command)
        return kinds | self._valve_reference(command, wanted)

    # Setpoints of the modes.

    def _axis_setpoint(self, command: np.void) -> int:
        velocity = 0.0
        if self.state is State408.ACTIVE:
            largest = self._axis.rated_speed
            velocity = self._limiter.limited(
                int(self._values[objects.VELOCITY_SETPOINT]) / COUNTS, -largest, largest)
            position = int(self._values[objects.POSITION_SETPOINT]) / COUNTS
            if self._mode == AXIS_VELOCITY:
                position = self._demand + velocity * self._axis.step
            self._demand = self._limiter.limited(position, 0.0, self._axis.stroke)
        return setpoint(command, self._demand, velocity)

    def _valve_reference(self, command: np.void, mode: int) -> int:
        keys = (objects.SPOOL_SETPOINT, objects.SPOOL_HOLD)
        full = self._axis.references[mode].high
        if mode == PRESSURE:
            keys = (objects.PRESSURE_SETPOINT, objects.PRESSURE_HOLD)
        key = keys[self.state is not State408.ACTIVE]
        value = int(self._values[key]) / FULL_SCALE * full
        return reference(command, mode, self._limiter.limited(value, -full, full))

    # States.

    def _enters(self, row: Transition) -> None:
        if row.event is Event408.FAULT:
            self._before = self.state.level
        if row.following in (State408.HOLD, State408.FAULT_REACTION):
            self._demand = self._axis.position
        if row.state is State408.DISABLED:
            self._was_on = False

    def _holds(self, guard: str) -> bool:
        if guard == MAY_ENABLE:
            return (self._axis.is_disabled and not self._is_blocked
                    and not self._axis.has_emergency_stop)
        if guard == MAY_ACT:
            return not self._is_held
        if guard == HOLDS:
            return self._axis.state == ENABLED
        if guard in (WAS_DISABLED, WAS_INIT):
            return (self._before == 0) == (guard == WAS_INIT)
        return True
