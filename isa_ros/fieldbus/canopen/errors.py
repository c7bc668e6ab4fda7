"""Errors of a node: emergency messages (EMCY), the error register and the history 0x1003."""

from collections.abc import Callable, Collection
import struct

from isa_ros.fieldbus.canopen.communication import Communication
from isa_ros.fieldbus.device.bus_device import Emergency
from isa_ros.fieldbus.device.can_identifiers import INVALID, LARGEST
from isa_ros.fieldbus.device.canopen_objects import EMERGENCY_ID
from isa_ros.fieldbus.device.communication_area import ERRORS_KEPT

# Codes of CiA 301, table 26.
NO_ERROR = 0x0000
BUS_OVERFULL = 0x8100       # communication, generic: NMT start refused
HEARTBEAT_LOST = 0x8130
RECOVERED = 0x8140          # from bus off
PDO_TOO_SHORT = 0x8210
PDO_TOO_LONG = 0x8220
SYNC_LENGTH = 0x8240
PDO_OVERDUE = 0x8250

GENERIC, COMMUNICATION = 0x01, 0x10     # bits of the error register
_MESSAGE = struct.Struct('<HB5s')
_INFORMATION_SHIFT = 16


class NodeErrors:
    """The errors of a node, of its device and of its communication."""

    def __init__(self, communication: Communication,
                 send: Callable[[int, bytes], None]) -> None:
        self._communication = communication
        self._send = send
        self._history: list[int] = []
        self._present: set[tuple[int, int]] = set()     # code, and what it is about
        self._device_register = 0

    def reset(self) -> None:
        """Forget all errors of communication, and the history."""
        self._present.clear()
        self.clear_history()

    def clear_history(self) -> None:
        """Empty the object 0x1003."""
        self._history.clear()
        self._communication.keep_errors([])

    @property
    def register(self) -> int:
        """Return the object 0x1001."""
        own = GENERIC | COMMUNICATION if self._present else 0
        return self._device_register | own

    def take(self, emergency: Emergency, *, is_sent: bool) -> None:
        """Take an emergency of the device: to the history, and to the bus if ``is_sent``."""
        self._device_register = emergency.register
        self._report(emergency.code, emergency.data, is_sent)

    def begin(self, code: int, source: int, *, is_sent: bool) -> None:
        """Begin an error of communication; ``source``: the node or PDO it is about, else 0."""
        self._present.add((code, source))
        self._report(code, bytes([source & 0xFF]), is_sent)

    def end(self, code: int, source: int, *, is_sent: bool) -> None:
        """End an error of communication; a message without error says that none is left."""
        if self.is_present(code, source):
            self._present.remove((code, source))
            if not self.register:
                self._report(NO_ERROR, b'', is_sent)

    def end_others(self, code: int, sources: Collection[int], *, is_sent: bool) -> None:
        """End the errors with a code that are about none of ``sources``."""
        present = {source for one, source in self._present if one == code}
        for source in sorted(present.difference(sources)):
            self.end(code, source, is_sent=is_sent)

    def is_present(self, code: int, source: int) -> bool:
        """Return whether an error of communication has begun and not ended."""
        return (code, source) in self._present

    def _report(self, code: int, data: bytes, is_sent: bool) -> None:
        if code != NO_ERROR:
            information = data[0] if data else 0
            self._history.insert(0, code | information << _INFORMATION_SHIFT)
            del self._history[ERRORS_KEPT:]
            self._communication.keep_errors(self._history)
        cob_id = self._communication.value(EMERGENCY_ID)
        if is_sent and not cob_id & INVALID:
            self._send(cob_id & LARGEST, _MESSAGE.pack(code, self.register, data))
