"""
The state machine of a slave (ETG.1000.6): AL control, AL status and AL status code.

Up it goes one state at a time and each step is checked; down it goes at once. After an error the
state stays until the master acknowledges, but INIT is always accepted.
"""

from enum import IntEnum
from typing import Protocol

from isa_ros.fieldbus.ethercat import al_codes
from isa_ros.fieldbus.ethercat.registers import (
    AL_CONTROL, AL_STATUS, AL_STATUS_CODE, STATION_ALIAS)


class AlState(IntEnum):
    """States by their numbers; BOOTSTRAP is refused."""

    INIT = 1
    PREOP = 2
    BOOTSTRAP = 3
    SAFEOP = 4
    OP = 8


_STATE, ERROR, _IDENTIFY = 0x0F, 0x10, 0x20
"""Bits of AL control and AL status; ERROR is the acknowledgement in AL control."""
_ABOVE = {AlState.INIT: AlState.PREOP, AlState.PREOP: AlState.SAFEOP, AlState.SAFEOP: AlState.OP}


class Application(Protocol):
    """What a change of state is checked by and acts on."""

    def refusal(self, state: AlState) -> int:
        """Return why a state cannot be, as a code of `al_codes`; 0 if it can."""

    def change(self, old: AlState, new: AlState, is_lost: bool) -> None:
        """Act on a change of state; ``is_lost``: the master did not ask for it."""


class ApplicationLayer:
    """The state of a slave."""

    def __init__(self, memory: bytearray, application: Application) -> None:
        self._memory, self._application = memory, application
        self.state = AlState.INIT

    @property
    def has_error(self) -> bool:
        """Return whether an error waits for its acknowledgement."""
        return bool(self._memory[AL_STATUS.address] & ERROR)

    def control(self) -> None:
        """Do what the master has written into AL control."""
        wanted = AL_CONTROL.value(self._memory)
        if self.has_error and not wanted & ERROR and wanted & _STATE != AlState.INIT:
            return
        code = self._refusal(wanted & _STATE)
        if code:
            self._show(code)
            return
        self._enter(AlState(wanted & _STATE), is_lost=False)
        self._show(al_codes.NO_ERROR)
        if wanted & _IDENTIFY:
            self._memory[AL_STATUS.address] |= _IDENTIFY
            AL_STATUS_CODE.put(self._memory, STATION_ALIAS.value(self._memory))

    def _refusal(self, wanted: int) -> int:
        """Return the code by which a requested state is refused, 0 for none."""
        if wanted == AlState.BOOTSTRAP:
            return (al_codes.NO_BOOTSTRAP if self.state == AlState.INIT
                    else al_codes.INVALID_CHANGE)
        if wanted not in (AlState.INIT, AlState.PREOP, AlState.SAFEOP, AlState.OP):
            return al_codes.UNKNOWN_STATE
        if wanted <= self.state:
            return al_codes.NO_ERROR
        if wanted != _ABOVE[self.state]:
            return al_codes.INVALID_CHANGE
        return self._application.refusal(AlState(wanted))

    def fall(self, state: AlState, code: int) -> None:
        """Fall to a lower state with an error, unasked."""
        if state < self.state:
            self._enter(state, is_lost=True)
            self._show(code)

    def _enter(self, state: AlState, is_lost: bool) -> None:
        old, self.state = self.state, state
        if old != state:
            self._application.change(old, state, is_lost)

    def _show(self, code: int) -> None:
        """Set AL status and its code."""
        AL_STATUS.put(self._memory, self.state | (ERROR if code else 0))
        AL_STATUS_CODE.put(self._memory, code)
