"""
Layer setting services (LSS, CiA 305): a master gives nodes their numbers.

A node is known by its LSS address, the four numbers of object 0x1018. In the state waiting it
looks for itself in the frames of the master: by its whole address, by ranges of it, or by fast
scan, which finds one node without a number bit by bit. In the state configuration it takes a
number, which counts from the next reset of its communication on; a node without one begins with it
at once. What is stored returns at a reset of the node, until the run ends.
"""

from collections.abc import Mapping
import struct

from isa_ros.fieldbus.device.bus_device import Identity
from isa_ros.fieldbus.device.can_identifiers import FIRST_NODE, LAST_NODE

REQUEST, ANSWER = 0x7E5, 0x7E4
"""Identifiers of the frames from and to the master."""
UNCONFIGURED = 255
"""Number of a node that has none."""

_SIZE = 8
_SWITCH_ALL, _NODE, _BIT_TIMING, _STORE = 0x04, 0x11, 0x13, 0x17
_SELECT, _SELECTED = (0x40, 0x41, 0x42, 0x43), 0x44
_IDENTIFY, _IDENTIFIED = (0x46, 0x47, 0x48, 0x49, 0x4A, 0x4B), 0x4F
_IDENTIFY_UNCONFIGURED, _IS_UNCONFIGURED = 0x4C, 0x50
_FAST_SCAN, _BEGINS_SCAN = 0x51, 0x80
_INQUIRE, _INQUIRE_NODE = (0x5A, 0x5B, 0x5C, 0x5D), 0x5E
_DONE, _REFUSED = 0, 1
_STANDARD_TABLE = 0
RATES: Mapping[int, int] = {
    0: 1_000_000, 1: 800_000, 2: 500_000, 3: 250_000, 4: 125_000, 6: 50_000, 7: 20_000, 8: 10_000}
"""Bit rates of the standard table."""
_REQUEST = struct.Struct('<BI')
_SCAN = struct.Struct('<BIBBB')


class LssNode:
    """The side of one node; ``number`` is that it begins with, of 1 to 127 or `UNCONFIGURED`."""

    def __init__(self, address: Identity, number: int, bitrate: int) -> None:
        self.pending = number
        """Number that counts from the next reset of the communication on."""
        self.is_waiting = True
        """Whether it is in the state waiting, not configuration."""
        self._address, self._bitrate, self._stored = address, bitrate, number
        self._selected = self._identified = self._scanned = 0

    def restore(self) -> None:
        """Return to what is stored."""
        self.pending = self._stored

    def answer(self, request: bytes, number: int) -> bytes | None:
        """Return the answer of a node with this number to a frame; None: there is none."""
        if len(request) != _SIZE:
            return None
        command, value = _REQUEST.unpack_from(request)
        if command == _SWITCH_ALL:
            self._enter(is_waiting=request[1] == 0)
        elif command in _SELECT:
            return self._select(_SELECT.index(command), value)
        elif command in _IDENTIFY:
            return self._identify(_IDENTIFY.index(command), value)
        elif command == _IDENTIFY_UNCONFIGURED:
            return _frame(_IS_UNCONFIGURED) if number == UNCONFIGURED else None
        elif command == _FAST_SCAN:
            return self._scan(request, number)
        elif not self.is_waiting:
            return self._configure(command, request, number)
        return None

    def _enter(self, *, is_waiting: bool) -> None:
        self.is_waiting = is_waiting
        self._selected = self._identified = self._scanned = 0

    def _select(self, part: int, value: int) -> bytes | None:
        """Enter configuration when the four parts of its address have come in their order."""
        if not self.is_waiting:
            return None
        is_next = part == self._selected and value == self._address[part]
        self._selected = self._selected + 1 if is_next else 0
        if self._selected < len(self._address):
            return None
        self._enter(is_waiting=False)
        return _frame(_SELECTED)

    def _identify(self, part: int, value: int) -> bytes | None:
        """Answer when vendor, product and both ranges have come in their order."""
        vendor, product, revision, serial = self._address
        fits = (value == vendor, value == product, value <= revision, revision <= value,
                value <= serial, serial <= value)[part]
        self._identified = self._identified + 1 if part == self._identified and fits else 0
        if self._identified < len(_IDENTIFY):
            return None
        self._identified = 0
        return _frame(_IDENTIFIED)

    def _scan(self, request: bytes, number: int) -> bytes | None:
        """Answer if the bits of a part of the address above a place are those of the master."""
        _, value, bit, part, following = _SCAN.unpack(request)
        if number != UNCONFIGURED or not self.is_waiting:
            return None
        if bit == _BEGINS_SCAN:
            self._scanned = 0
            return _frame(_IDENTIFIED)
        if bit > 31 or part >= len(self._address) or part != self._scanned \
                or (self._address[part] ^ value) >> bit:
            return None
        if bit == 0:
            if following < part:
                self._enter(is_waiting=False)
            else:
                self._scanned = following
        return _frame(_IDENTIFIED)

    def _configure(self, command: int, request: bytes, number: int) -> bytes | None:
        if command in _INQUIRE:
            return _frame(command, *self._address[_INQUIRE.index(command)].to_bytes(4, 'little'))
        if command == _INQUIRE_NODE:
            return _frame(command, number)
        if command == _NODE:
            is_number = FIRST_NODE <= request[1] <= LAST_NODE or request[1] == UNCONFIGURED
            if is_number:
                self.pending = request[1]
            return _frame(command, _DONE if is_number else _REFUSED)
        if command == _BIT_TIMING:      # the rate is that of the bus, and cannot be changed
            is_own = request[1] == _STANDARD_TABLE and RATES.get(request[2]) == self._bitrate
            return _frame(command, _DONE if is_own else _REFUSED)
        if command == _STORE:
            self._stored = self.pending
            return _frame(command, _DONE)
        return None     # activating the bit timing has no answer


def _frame(*content: int) -> bytes:
    return bytes(content).ljust(_SIZE, b'\0')
