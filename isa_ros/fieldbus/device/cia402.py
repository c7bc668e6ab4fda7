"""
A CiA 402 drive on top of the REU's own device.

States above `switch on disabled` are the drive's; the REU is enabled in `operation enabled` only.
The control word counts at the start of a tick, the sample at its end.
"""

from collections.abc import Mapping

from isa_ros.core.device import ENABLED, FAULT, FAULT_REACTION, INITIALISING, QUICK_STOP
from isa_ros.core.signals import HAS_QUICK_STOP
from isa_ros.fieldbus.device import cia402_objects as objects
from isa_ros.fieldbus.device.abort import INCOMPATIBLE, OUT_OF_RANGE, SdoAbort
from isa_ros.fieldbus.device.axis import Axis, COUNTS
from isa_ros.fieldbus.device.cia402_motion_objects import DIGITAL_INPUTS
from isa_ros.fieldbus.device.cia402_objects import (
    CSP, CSV, HOMING, IMPEDANCE_MODE, NO_MODE, PP, PV, REFUSED_MODES)
from isa_ros.fieldbus.device.cia402_states import (
    CAUSE_GONE, command_of, ENDS_OFF, Event402, FAULT_RESET, FOLLOWING, RELEASED, REU_DISABLED,
    State402, STAYS)
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.drive import Drive
from isa_ros.fieldbus.device.faults import Faults, FOLLOWING_ERROR
from isa_ros.fieldbus.device.following_error import FollowingError
from isa_ros.fieldbus.device.force_limits import ForceLimits
from isa_ros.fieldbus.device.mode_setpoints import ModeSetpoints
from isa_ros.fieldbus.device.motions import HALT, Motions
from isa_ros.fieldbus.device.objects import ObjectEntry, Value
from isa_ros.fieldbus.device.rest import Rest
from isa_ros.fieldbus.device.setpoints import enable
from isa_ros.fieldbus.device.states import Transition
import numpy as np

VOLTAGE, WARNING, REMOTE, LIMITED, FOLLOWS, LATE = (1 << bit for bit in (4, 7, 9, 11, 12, 13))
"""Further bits of the status word."""
_HALTED = (PP, PV, CSP, CSV)
"""Modes with a reference that a halt brakes, and whose following error is watched."""
_LEAVING = {Event402.SHUTDOWN: objects.SHUTDOWN_OPTION, Event402.SWITCH_ON: objects.DISABLE_OPTION}
"""Option codes by the command that leaves operation."""
_STOP_WORD = 0x02
"""Control word of a quick stop."""


class Drive402(Drive):
    """The drive of one actuator."""

    following = FOLLOWING
    fault, reaction_ends, reset, left = (
        Event402.FAULT, Event402.REACTION_ENDS, Event402.RESET, Event402.LEFT)
    first_state = State402.SWITCH_ON_DISABLED
    faults, control, reset_bit = (State402.FAULT,), objects.CONTROL, FAULT_RESET
    faulty = (*faults, State402.FAULT_REACTION)

    def __init__(
            self, axis: Axis, values: dict[Key, Value], faults: Faults,
            supply_low: int) -> None:
        super().__init__(axis, values, faults, State402.NOT_READY, objects.MODE,
                         objects.modes_of(axis), NO_MODE)
        self._supply_low = supply_low
        self._limits = ForceLimits(axis, values)
        self._following_error = FollowingError(axis.step_ns, values)
        self._has_left = self._is_held = False
        self._motions = Motions(axis, values, self._limiter)
        self._rest = Rest(axis)
        self._moved_in: int | None = None
        self._setpoints = ModeSetpoints(
            axis, values, self._limiter, self._limits, self._motions)
        self.actuals = {
            objects.STATUS: self.status, objects.MODE_SHOWN: lambda: self._mode,
            objects.POSITION: lambda: self._counted(axis.position),
            objects.POSITION_DEMAND: lambda: self._counted(self._shown_demand),
            DIGITAL_INPUTS: self._digital_inputs,
            objects.FOLLOWING_ERROR: lambda: round(self._following_error.value * COUNTS)}

    # Side of the bus.

    def admit(self, entry: ObjectEntry, value: Value) -> None:
        """Refuse modes that do not exist, and a range that is none; raises `SdoAbort`."""
        key = entry.index, entry.subindex
        if key == objects.MODE and value not in self._modes:
            raise SdoAbort(OUT_OF_RANGE, self._refusal(int(value)))
        if key in (objects.LEAST_POSITION, objects.LARGEST_POSITION):
            least, largest = (
                value if key == one else self._values[one]
                for one in (objects.LEAST_POSITION, objects.LARGEST_POSITION))
            if float(least) > float(largest):
                raise SdoAbort(INCOMPATIBLE, f'0x607D: least position {least} above largest '
                               f'position {largest}, um | urad')

    def _refusal(self, mode: int) -> str:
        return REFUSED_MODES.get(mode, super()._refusal(mode))

    def end_operation(self, is_lost: bool) -> None:
        """Leave it: stop as by a quick stop, and with a fault if the bus is lost."""
        self._values[objects.CONTROL] = _STOP_WORD
        super().end_operation(is_lost)
        self._has_left = self.state is State402.QUICK_STOP

    def restart(self, is_whole: bool) -> None:
        """Return to power-on, as `Drive.restart`; with ``is_whole`` without a homing."""
        if is_whole:
            self._motions.restart()
        super().restart(is_whole)
        self._is_stopping &= self._values[objects.QUICK_STOP_OPTION] != objects.OFF_AT_ONCE

    def _begin_at_position(self) -> None:
        self._values[objects.TARGET_POSITION] = self._counted(self._axis.position)
        self._following_error.forget()
        self._has_left = False
        self._moved_in = None

    def status(self) -> int:
        """Return the status word."""
        axis, state = self._axis, self.state
        word = state.bits | REMOTE * self._is_remote
        warnings = int(axis.field('warnings'))
        word |= WARNING * bool(warnings)
        word |= VOLTAGE * (not (warnings | int(axis.field('trips'))) & self._supply_low)
        if state is State402.OPERATION_ENABLED:
            word |= LIMITED * self._limiter.is_limited
            if axis.state == ENABLED:
                word |= self._status_of_mode()
        word |= LATE * self._following_error.is_late
        return word

    def _status_of_mode(self) -> int:
        """Return the bits of the status word whose meaning depends on the mode."""
        is_halted = self._is_halted
        if self._mode == PP:
            return self._motions.status_of_position(is_halted)
        if self._mode == PV:
            return self._motions.status_of_velocity(is_halted)
        if self._mode == HOMING:
            return self._motions.status_of_homing()
        return FOLLOWS * (self._mode != NO_MODE and not is_halted)

    @property
    def _is_halted(self) -> bool:
        return self._mode in _HALTED and bool(self._control & HALT)

    def _counted(self, position: float) -> int:
        """Return a position of the encoder as the bus counts it."""
        return round(position * COUNTS) - self._motions.origin

    def _digital_inputs(self) -> int:
        position = round(self._axis.position * COUNTS)
        return (int(position <= int(self._values[objects.LEAST_POSITION]))
                | int(position >= int(self._values[objects.LARGEST_POSITION])) << 1)

    def limited(self, changes: dict[str, float]) -> dict[str, float]:
        """Return changes of the REU with its forces limited by the objects of the drive."""
        return self._limits.limited(changes)

    def foreign(self, values: Mapping[str, float]) -> Mapping[str, float]:
        """Return values in force but for limits of the drive's own."""
        return self._limits.foreign(values)

    # Side of the run.

    def take_sample(self) -> None:
        """Follow what the REU reports."""
        axis = self._axis
        if not self._has_start:
            self._has_start = True
            self._begin_at_position()
        self._happens(Event402.INITIALISED)
        self._watch_deviation()
        self._motions.watch()
        self._rest.watch()
        self._is_stopping &= axis.is_on
        if axis.state in (FAULT_REACTION, FAULT) and not self._clears or self._faults.has_own:
            self._happens(Event402.FAULT)
        self._end_reaction()
        if axis.is_disabled:
            self._happens(Event402.STOPPED)
            if not self._faults.has_own:
                self._happens(Event402.RESET)
        if self.state is State402.OPERATION_ENABLED:
            if axis.state == QUICK_STOP:
                self._happens(Event402.LOCAL_STOP)
            elif axis.is_disabled and self._was_on:
                self._happens(Event402.DROPPED)
            self._was_on |= axis.state == ENABLED
        if axis.has_emergency_stop:     # of which the REU tells that it stops
            self._happens(Event402.EMERGENCY_STOP)
            self._has_left |= self.state is State402.QUICK_STOP

    def _obey(self, control: int) -> None:
        if (event := command_of(control)) is not None:
            self._happens(event)

    def _kinds(self, command: np.void) -> int:
        axis, state = self._axis, self.state
        if state is State402.OPERATION_ENABLED:
            return self._operate(command)
        if state in (State402.QUICK_STOP, State402.FAULT_REACTION):
            if axis.state != ENABLED:
                if self._rest.is_over and (state is State402.FAULT_REACTION or not self._stays):
                    return self._off(command)
                return self._held(command) if state is State402.QUICK_STOP else 0
            if self._is_held and self._stays:
                return 0
            option = (objects.FAULT_OPTION if state is State402.FAULT_REACTION
                      else objects.QUICK_STOP_OPTION)
            if self._values[option] != objects.OFF_AT_ONCE:
                return HAS_QUICK_STOP
        elif self._is_stopping:
            return self._stopped(command)
        elif not (axis.is_on or axis.state == INITIALISING):
            return 0
        return self._off(command)

    def _held(self, command: np.void) -> int:
        """Let the REU hold once its stop has ended, by option code 6; return the kinds."""
        if self._is_held or not (self._stays and self._axis.is_disabled
                                 and self._axis.position_mode):
            return 0
        self._is_held = True
        return enable(command, self._axis.position_mode)

    @property
    def _stays(self) -> bool:
        return (self._values[objects.QUICK_STOP_OPTION] == objects.QUICK_STOP_STAYS
                and not self._has_left)

    def _operate(self, command: np.void) -> int:
        kinds = self._enabled(command, self._modes[self._mode])
        if self._axis.state != ENABLED or self._moved_in != self._mode:
            self._motions.begin(self._demand, self._control)
            self._moved_in = self._mode
        if self._is_halted:
            self._motions.stop()
        own, self._demand = self._setpoints.write(
            command, self._mode, self._control, self._demand, self._is_halted)
        return kinds | own

    # Following error.

    @property
    def _has_demand(self) -> bool:
        return self.state is State402.OPERATION_ENABLED and self._mode in (
            *_HALTED, IMPEDANCE_MODE)

    @property
    def _shown_demand(self) -> float:
        return self._demand if self._has_demand else self._axis.position

    def _watch_deviation(self) -> None:
        """Watch the following error, which stays as it was in a fault."""
        if self.state in self.faulty:
            return
        error = self._following_error
        error.watch(self._shown_demand - self._axis.position,
                    self._has_demand and self._mode in _HALTED)
        if error.is_late:
            self._faults.add(FOLLOWING_ERROR)

    # States.

    def _enters(self, row: Transition) -> None:
        self._was_on = False
        if row.event in _LEAVING and row.state is State402.OPERATION_ENABLED:
            option = self._values[_LEAVING[row.event]]
            self._is_stopping = option == objects.STOPS_THEN_OFF
        elif row.event is Event402.DISABLE_VOLTAGE:
            self._is_stopping = False
        if row.event is Event402.RESET:
            self._following_error.forget()
        if row.state is State402.QUICK_STOP:
            self._has_left = self._is_held = False
            self._demand = self._axis.position
            self._moved_in = None

    def _holds(self, guard: str) -> bool:
        if guard == ENDS_OFF:
            return not self._stays
        if guard == STAYS:
            return self._stays and (self._axis.is_disabled or self._is_held)
        if guard == RELEASED:
            return not self._axis.has_emergency_stop
        return guard not in (REU_DISABLED, CAUSE_GONE) or self._axis.is_disabled
