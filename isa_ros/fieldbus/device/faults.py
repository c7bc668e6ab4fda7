"""
Errors as a bus reports them: conditions of the device as error codes, EMCY and error register.

A trip whose reaction stops the actuator is a fault: its code stays in 0x603F until the fault is
reset. Every trip sends an emergency message, and one with code 0 follows when the last is gone.
An open emergency stop is an error from outside, and no fault: it has a code as long as it is open.
"""

from collections.abc import Callable, Mapping

from isa_ros.core.conditions import BITS, COMMUNICATION, CONDITIONS, ErrorCode, FAULTS, PROFILE
from isa_ros.fieldbus.device.bus_device import Emergency
from isa_ros.fieldbus.device.communication_area import ERROR_FIELD, ERRORS_KEPT
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.objects import Value
from isa_ros.reu.protection_sheet import changed_reactions, Protection, reaction_of

_GENERIC = 1

BUS_LOST = ErrorCode(0x8180, COMMUNICATION, 'communication: the bus is lost')
FOLLOWING_ERROR = ErrorCode(0x8611, PROFILE, 'following error')
PDO_LENGTH = ErrorCode(0x8210, COMMUNICATION, 'PDO not processed due to length error')
NO_ERROR = ErrorCode(0, 0, 'no error')
EMERGENCY_STOP = ErrorCode(0x9000, 0, 'external error: the emergency stop')
OWN_CODES = (BUS_LOST, FOLLOWING_ERROR, PDO_LENGTH, EMERGENCY_STOP)
"""Errors that the bus interface finds by itself."""

_WORD = 0xFFFF
_DATA_BYTES = 5


def stopping_bits(sheet: Protection) -> int:
    """Return the conditions whose trip stops the actuator, as a bit set."""
    return sum(1 << bit for name, bit in BITS.items() if reaction_of(sheet, name) in FAULTS)


class Faults:
    """
    The errors of one device.

    ``values`` are those of its dictionary, with the error field; ``note`` is called with each
    error that begins.
    """

    def __init__(self, sheet: Protection, values: dict[Key, Value],
                 note: Callable[[ErrorCode], object] = lambda error: None) -> None:
        self._note = note
        self._stopping = stopping_bits(sheet)
        self._values = values
        self._trips = 0
        self._own: list[ErrorCode] = []
        self._is_stopped = False
        self._new: list[Emergency] = []
        self._code = 0

    @property
    def code(self) -> int:
        """Return 0x603F: the code of the fault, else of an open emergency stop, or 0."""
        return self._code or EMERGENCY_STOP.code * self._is_stopped

    @property
    def has_own(self) -> bool:
        """Return whether an error of the bus interface keeps the fault."""
        return bool(self._own)

    @property
    def register(self) -> int:
        """Return the error register 0x1001."""
        found = _GENERIC * self._is_stopped
        for bit, condition in enumerate(CONDITIONS):
            if self._trips >> bit & 1:
                found |= condition.error.register | _GENERIC
        for error in self._own:
            found |= error.register | _GENERIC
        return found

    def take_trips(self, trips: int) -> None:
        """Take the bit set of a sample: report what is new, and when all is gone."""
        if trips == self._trips:
            return
        new, self._trips = trips & ~self._trips, trips
        for bit, condition in enumerate(CONDITIONS):
            if new >> bit & 1:
                if not self._code and self._stopping >> bit & 1:
                    self._code = condition.error.code
                self._report(condition.error)
        if not new:
            self._report_end()

    def take_reactions(self, values: Mapping[str, float]) -> None:
        """Take the reactions among changed values of the REU, by their names."""
        for condition, reaction in changed_reactions(values):
            bit = 1 << BITS[condition]
            self._stopping = (self._stopping | bit if reaction in FAULTS
                              else self._stopping & ~bit)

    def take_emergency_stop(self, is_open: bool) -> None:
        """Report that the line of the emergency stop is open, and that it is closed again."""
        if is_open and not self._is_stopped:
            self._is_stopped = True
            self._report(EMERGENCY_STOP)
        elif self._is_stopped and not is_open:
            self._is_stopped = False
            self._report_end()

    def add(self, error: ErrorCode) -> None:
        """Add an error of the bus interface, which lasts until `clear`."""
        if error not in self._own:
            self._own.append(error)
            self._code = self._code or error.code
            self._report(error)

    def note(self, error: ErrorCode) -> None:
        """Report an error that does not last."""
        self._report(error, error.register | _GENERIC)

    def clear(self) -> None:
        """Forget the errors of the bus interface; those of the device stay."""
        if self._own:
            self._own.clear()
            self._report_end()

    def end(self) -> None:
        """Forget the code: the fault has been reset."""
        self._code = 0

    def restart(self) -> None:
        """Forget everything, unsent messages too; a trip that lasts is reported anew."""
        self._trips = self._code = 0
        self._own.clear()
        self._new.clear()
        delete_errors(self._values)

    def emergencies(self) -> list[Emergency]:
        """Return the messages since the last call."""
        found, self._new = self._new, []
        return found

    def _report_end(self) -> None:
        if not (self._trips or self._own or self._is_stopped):
            self._report(NO_ERROR)

    def _report(self, error: ErrorCode, register: int = 0) -> None:
        code, data = error.code, self._trips.to_bytes(_DATA_BYTES, 'little')
        self._new.append(Emergency(code, self.register | register, data))
        if code:
            self._note(error)
            kept = [int(self._values[ERROR_FIELD, k]) for k in range(1, ERRORS_KEPT)]
            for k, value in enumerate([code | (self._trips & _WORD) << 16, *kept]):
                self._values[ERROR_FIELD, k + 1] = value
            count = int(self._values[ERROR_FIELD, 0])
            self._values[ERROR_FIELD, 0] = min(count + 1, ERRORS_KEPT)


def delete_errors(values: dict[Key, Value]) -> None:
    """Delete the pre-defined error field of a dictionary."""
    for k in range(ERRORS_KEPT + 1):
        values[ERROR_FIELD, k] = 0
