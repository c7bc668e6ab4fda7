"""
A CiA 408 device on top of the REU's own device: what valves for fluid power follow.

In HOLD the REU is enabled with the hold setpoint: of an axis the position measured when it was
entered. In ACTIVE it has the setpoint of the bus.
"""

from collections.abc import Callable

from isa_ros.core.device import ENABLED, FAULT, FAULT_REACTION, INITIALISING, PRESSURE
from isa_ros.core.signals import HAS_CLEAR_FAULT, HAS_ENABLE
from isa_ros.fieldbus.device import cia408_objects as objects
from isa_ros.fieldbus.device.axis import Axis, COUNTS, FULL_SCALE
from isa_ros.fieldbus.device.cia408_objects import AXIS_POSITION, AXIS_VELOCITY, PQ
from isa_ros.fieldbus.device.cia408_states import (
    control_of, Event, FAULTS, FOLLOWING, HOLDING, HOLDS, level_of, MAY_ENABLE, R, State,
    WAS_DISABLED, WAS_INIT)
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.faults import BUS_LOST, Faults
from isa_ros.fieldbus.device.manufacturer_area import note_refusal
from isa_ros.fieldbus.device.objects import Entry, Value
from isa_ros.fieldbus.device.setpoints import change_mode, enable, Limiter, reference, setpoint
import numpy as np

PRESSURE_CONTROLS, LIMITED = 1 << 8, 1 << 10
"""Further bits of the status word."""


class Drive408:
    """The device of one actuator; ``values`` are those of its dictionary."""

    def __init__(self, axis: Axis, values: dict[Key, Value], faults: Faults) -> None:
        self.state = State.NOT_READY
        self._axis, self._values, self._faults = axis, values, faults
        self._modes = objects.modes_of(axis)
        self._mode = int(values[objects.CONTROL_MODE])
        self._control = 0
        self._limiter = Limiter()
        self._demand = 0.0
        self._before = 0
        self._was_on = self._is_blocked = self._has_start = False
        self.actuals: dict[Key, Callable[[], Value]] = {
            objects.STATUS: self.status, objects.CONTROL_MODE: lambda: self._mode,
            objects.PRESSURE_ACTUAL: self._pressure,
            objects.POSITION_DEMAND: lambda: round(self._demand * COUNTS)}
        """Functions of the values that this device computes."""

    # Side of the bus.

    def admit(self, entry: Entry, value: Value) -> None:
        """Refuse a value that is written: here the choices of the table are enough."""

    def received(self) -> None:
        """Take what the master has written: the control mode counts at once."""
        mode = int(self._values[objects.CONTROL_MODE])
        if mode == self._mode:
            return
        if mode in self._modes:
            self._mode = mode
            self._demand = self._axis.position
        else:
            known = ', '.join(map(str, sorted(self._modes)))
            note_refusal(
                self._values, f'control mode {mode} does not exist here; there are {known}')

    def begin_operation(self) -> None:
        """Enter the state operational; nothing depends on it."""

    def end_operation(self, is_lost: bool) -> None:
        """Leave it: hold, and with a fault if the bus is lost."""
        self._values[objects.CONTROL] = control_of(min(self.state.level, State.HOLD.level))
        if is_lost:
            self._faults.add(BUS_LOST)
            self._happens(Event.FAULT)
            if self._axis.is_off:
                self._happens(Event.REACTION_ENDS)

    def status(self) -> int:
        """Return the status word."""
        word = self.state.bits
        if self.state is State.ACTIVE:
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
            self._demand = axis.position
            self._values[objects.POSITION_SETPOINT] = round(axis.position * COUNTS)
        self._happens(Event.INITIALISED)
        has_tripped = axis.state in (FAULT_REACTION, FAULT)
        if self.state is State.FAULT_REACTION:
            if axis.is_off or axis.state == ENABLED:
                self._happens(Event.REACTION_ENDS)
        elif has_tripped:
            self._happens(Event.FAULT)
            if axis.is_off:
                self._happens(Event.REACTION_ENDS)
        if not has_tripped and not self._faults.has_own:
            self._happens(Event.RESET)
        if self.state in (State.HOLD, State.ACTIVE):
            if self._was_on and axis.state != ENABLED:
                self._is_blocked = True
                self._happens(Event.DROPPED)
            self._was_on = axis.state == ENABLED

    def fill_command(self, command: np.void) -> None:
        """Write the command of a tick."""
        control = int(self._values[objects.CONTROL])
        is_reset = bool(control & ~self._control & R)
        self._control = control
        kinds, wanted = 0, level_of(control)
        self._is_blocked &= wanted >= State.HOLD.level
        if self.state in FAULTS and is_reset:
            kinds |= self._reset()
        elif wanted > self.state.level:
            self._happens(Event.RISE)
        elif wanted < self.state.level:
            self._happens(Event.FALL)
        command['kinds'] = kinds | self._kinds(command)

    def _reset(self) -> int:
        """Reset a fault: that of the bus at once, that of the REU by a command."""
        self._faults.clear()
        if self._axis.state == FAULT:
            return HAS_CLEAR_FAULT
        self._happens(Event.RESET)
        return 0

    def _kinds(self, command: np.void) -> int:
        """Write what the state demands of the REU; return the kinds."""
        axis = self._axis
        has_tripped = axis.state in (FAULT_REACTION, FAULT)
        is_off_in_reaction = self.state is State.FAULT_REACTION and not axis.is_on
        if self.state in HOLDING and not has_tripped and not is_off_in_reaction:
            return self._operate(command)
        if has_tripped or not (axis.is_on or axis.state == INITIALISING):
            return 0
        command['is_enabled'] = 0
        return HAS_ENABLE

    def _operate(self, command: np.void) -> int:
        wanted, kinds = self._modes[self._mode], 0
        if self._axis.state != ENABLED:
            self._demand = self._axis.position
            kinds = enable(command, wanted)
        elif int(self._axis.field('device_mode')) != wanted:
            kinds = change_mode(command, wanted)
        self._limiter.is_limited = False
        if self._mode in (AXIS_VELOCITY, AXIS_POSITION):
            return kinds | self._axis_setpoint(command)
        return kinds | self._valve_reference(command, wanted)

    # Setpoints of the modes.

    def _axis_setpoint(self, command: np.void) -> int:
        velocity = 0.0
        if self.state is State.ACTIVE:
            velocity = int(self._values[objects.VELOCITY_SETPOINT]) / COUNTS
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
        key = keys[self.state is not State.ACTIVE]
        value = int(self._values[key]) / FULL_SCALE * full
        return reference(command, mode, self._limiter.limited(value, -full, full))

    # States.

    def _happens(self, event: Event) -> None:
        """Let an event happen; without a row whose guard holds nothing changes."""
        for row in FOLLOWING.get((self.state, event), ()):
            if self._holds(row.guard):
                break
        else:
            return
        if row.event is Event.FAULT:
            self._before = self.state.level
        if row.following in (State.HOLD, State.FAULT_REACTION):
            self._demand = self._axis.position
        if row.state is State.DISABLED:
            self._was_on = False
        self.state = row.following
        if event is Event.RESET:
            self._faults.end()

    def _holds(self, guard: str) -> bool:
        if guard == MAY_ENABLE:
            return self._axis.is_disabled and not self._is_blocked
        if guard == HOLDS:
            return self._axis.state == ENABLED
        if guard in (WAS_DISABLED, WAS_INIT):
            return (self._before == 0) == (guard == WAS_INIT)
        return True
