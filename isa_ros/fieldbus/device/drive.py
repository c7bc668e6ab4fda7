"""What the profiles share: a drive on top of the REU's own device, by a table of states."""

from collections.abc import Callable, Mapping
from enum import Enum

from isa_ros.core.device import ENABLED, FAULT, FAULT_REACTION
from isa_ros.core.signals import HAS_CLEAR_FAULT, HAS_ENABLE, HAS_QUICK_STOP
from isa_ros.fieldbus.device.axis import Axis
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.faults import BUS_LOST, Faults
from isa_ros.fieldbus.device.manufacturer_area import note_refusal
from isa_ros.fieldbus.device.objects import ObjectEntry, Value
from isa_ros.fieldbus.device.setpoints import change_mode, enable, Limiter
from isa_ros.fieldbus.device.states import DeviceState, Following, Transition
import numpy as np

_CLEARING = 2
"""Ticks in which a restart clears a fault: of a reaction the first ends it."""


class Drive:
    """
    A profile: what control words and targets mean for the REU.

    ``values`` are those of the dictionary; ``modes`` are those of the actuator, with the mode of
    the REU for each; ``mode`` is the first.
    """

    following: Following
    fault: Enum
    reaction_ends: Enum
    reset: Enum
    left: Enum
    """Events of the table."""
    first_state: DeviceState
    """After power-on, once there is a sample."""
    faults: tuple[DeviceState, ...]
    """States that a reset ends."""
    faulty: tuple[DeviceState, ...]
    """These, and the reaction before them."""
    control: Key
    reset_bit: int
    """Of the control word; a reset is its rising edge."""
    mode_words = 'mode'

    def __init__(
            self, axis: Axis, values: dict[Key, Value], faults: Faults, state: DeviceState,
            mode_key: Key, modes: Mapping[int, int], mode: int) -> None:
        self.state = state
        self.actuals: dict[Key, Callable[[], Value]] = {}
        """Functions of the values that this drive computes."""
        self._axis, self._values, self._faults = axis, values, faults
        self._mode_key, self._modes, self._mode = mode_key, modes, mode
        self._first_mode = mode
        self._control = 0
        self._limiter = Limiter()
        self._demand = 0.0
        self._was_on = self._has_start = False
        self._is_remote = self._is_stopping = False
        self._clears = 0

    # Side of the bus.

    def admit(self, entry: ObjectEntry, value: Value) -> None:
        """Refuse a value that is written; raises `SdoAbort`. The choices of the table hold."""

    def received(self) -> None:
        """Take what the master has written: the mode counts at once."""
        mode = int(self._values[self._mode_key])
        if mode == self._mode:
            return
        if mode in self._modes:
            self._mode = mode
            self._demand = self._axis.position
        else:
            self._values[self._mode_key] = self._mode
            note_refusal(self._values, self._refusal(mode))

    def _refusal(self, mode: int) -> str:
        known = ', '.join(map(str, sorted(self._modes)))
        return f'{self.mode_words} {mode} does not exist here; there are {known}'

    def limited(self, changes: dict[str, float]) -> dict[str, float]:
        """Return changes of the REU's gains and limits, SI, as the profile lets them be."""
        return changes

    def foreign(self, values: Mapping[str, float]) -> Mapping[str, float]:
        """Return those of values in force, SI, that `limited` has not put in force."""
        return values

    def begin_operation(self) -> None:
        """Enter the state operational of the bus."""
        self._is_remote = True

    def end_operation(self, is_lost: bool) -> None:
        """
        Leave the state operational of the bus, with a fault if it is lost.

        The state changes here and not at the next tick: until then the bus may be operational
        again, with the control word that it had before.
        """
        self._is_remote = False
        if is_lost:
            self._faults.add(BUS_LOST)
            self._happens(self.fault)
            self._end_reaction()
        else:
            self._happens(self.left)

    def restart(self, is_whole: bool) -> None:
        """
        Enter the state after power-on at once; with ``is_whole`` with outputs off, without faults.

        Otherwise a fault stays, and the REU ends its stop before it can be enabled.
        """
        axis = self._axis
        self._control = 0
        if is_whole:
            self._clears = _CLEARING * (axis.state in (FAULT_REACTION, FAULT))
            self._mode = self._first_mode
        elif self.state in self.faulty:
            return
        self._is_stopping = axis.is_on and not is_whole
        self._was_on = False
        if self._has_start:
            self.state = self.first_state
            self._begin_at_position()

    def _begin_at_position(self) -> None:
        """Make the measured position the target."""
        raise NotImplementedError

    # Side of the run.

    def take_sample(self) -> None:
        """Follow the new sample of the axis."""
        raise NotImplementedError

    def fill_command(self, command: np.void) -> None:
        """Write the `COMMAND` of a tick."""
        control = int(self._values[self.control])
        is_reset = bool(control & ~self._control & self.reset_bit)
        self._control = control
        kinds = 0
        if self._clears:
            self._clears -= 1
            command['kinds'] = HAS_CLEAR_FAULT | self._off(command)
            return
        if is_reset and self.state in self.faults:
            kinds = self._reset()
        else:
            self._obey(control)
        command['kinds'] = kinds | self._kinds(command)

    def _obey(self, control: int) -> None:
        """Let happen what a control word wants."""
        raise NotImplementedError

    def _kinds(self, command: np.void) -> int:
        """Write what the state demands of the REU; return the kinds."""
        raise NotImplementedError

    def _off(self, command: np.void) -> int:
        """Switch the REU off at once; return the kinds."""
        command['is_enabled'] = 0
        return HAS_ENABLE

    def _stopped(self, command: np.void) -> int:
        """Let the REU stop before it is off; return the kinds."""
        return HAS_QUICK_STOP if self._axis.state == ENABLED else 0

    def _reset(self) -> int:
        """Reset a fault: that of the bus at once, that of the REU by a command."""
        self._faults.clear()
        if self._axis.state == FAULT:
            return HAS_CLEAR_FAULT
        self._happens(self.reset)
        return 0

    def _enabled(self, command: np.void, wanted: int) -> int:
        """Enable the REU in a mode, or change to it; 0: any. Return the kinds."""
        self._limiter.is_limited = False
        if self._axis.state != ENABLED:
            self._demand = self._axis.position
            return enable(command, wanted)
        if wanted and int(self._axis.field('device_mode')) != wanted:
            return change_mode(command, wanted)
        return 0

    # States.

    def _end_reaction(self) -> None:
        if self._axis.is_off:
            self._happens(self.reaction_ends)

    def _happens(self, event: Enum) -> None:
        """Let an event happen; without a row whose guard holds nothing changes."""
        for row in self.following.get((self.state, event), ()):
            if self._holds(row.guard):
                self._enters(row)
                self.state = row.following
                if event is self.reset:
                    self._faults.end()
                return

    def _holds(self, guard: str) -> bool:
        """Return whether a guard of the table holds."""
        raise NotImplementedError

    def _enters(self, row: Transition) -> None:
        """Note that a row of the table takes place."""
