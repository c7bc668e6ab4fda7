"""
Mailbox of a slave (ETG.1000.4): header, counter, repetition, errors; one protocol, CoE.

A mail is length (2 bytes), address (2), channel (1), type and counter (1) and that many bytes.
Answers wait in order until the master has read those before; while many wait, the mailbox from
the master stays full, so that a further mail is refused with working counter 0.
"""

from collections import deque
from collections.abc import Iterable
import struct
from typing import Protocol

from isa_ros.fieldbus.device.bus_device import Emergency
from isa_ros.fieldbus.ethercat.layout import MAILBOX_LENGTH
from isa_ros.fieldbus.ethercat.sync_manager import SyncManager

_HEADER = struct.Struct('<HHBB')
CAPACITY = MAILBOX_LENGTH - _HEADER.size
"""Bytes that a mail can carry."""
MOST_WAITING = 16
"""Answers and emergencies that wait, beyond which no further mail is taken."""

ERROR, COE = 0x00, 0x03
"""Types of mails; others (AoE 1, EoE 2, FoE 4, SoE 5, VoE 15) are refused."""
SYNTAX, UNSUPPORTED_PROTOCOL, INVALID_CHANNEL, UNSUPPORTED_SERVICE = 1, 2, 3, 4
INVALID_HEADER, TOO_SHORT, OUT_OF_MEMORY, INVALID_SIZE = 5, 6, 7, 8
"""Details of the errors that a mailbox answers (ETG.1000.4)."""
_COMMAND_ERROR = 1
_TYPE, _COUNTER, _COUNTERS = 0x0F, 0x07, 7


class MailError(Exception):
    """A mail that is answered with an error of the mailbox itself."""

    def __init__(self, detail: int) -> None:
        super().__init__(f'mailbox error {detail}')
        self.detail = detail


class MailProtocol(Protocol):
    """The protocol of mails of type `COE`."""

    def answers(self, request: bytes) -> Iterable[bytes]:
        """Return the answers to a mail's content; raises `MailError`."""

    def emergency(self, emergency: Emergency) -> bytes:
        """Return the content of a mail for an emergency."""

    def reset(self) -> None:
        """Give up a transfer that is under way."""


class SlaveMailbox:
    """Two sync managers in mailbox mode, and the mails that wait between them."""

    def __init__(self, out: SyncManager, into: SyncManager, protocol: MailProtocol) -> None:
        self._out, self._into, self._protocol = out, into, protocol
        self.stop()

    def start(self) -> None:
        """Allow the master access."""
        self._out.lock(False)
        self._into.lock(False)

    def stop(self) -> None:
        """Discard all mails and deny the master access."""
        self._out.lock(True)
        self._into.lock(True)
        self._protocol.reset()
        self._waiting: deque[bytes] = deque()
        self._present = self._read = b''
        self._sent_counter = self._received_counter = 0

    def receive(self) -> None:
        """Answer the mail in the mailbox, unless too many answers wait."""
        if not self._out.is_full or len(self._waiting) >= MOST_WAITING:
            return
        mail = self._out.take()
        length, _, _, kind = _HEADER.unpack_from(mail)
        counter = kind >> 4 & _COUNTER
        if counter and counter == self._received_counter:
            return  # the master has repeated a mail whose acknowledgement it lost
        self._received_counter = counter
        try:
            for answer in self._answers(length, kind & _TYPE, mail[_HEADER.size:]):
                self._post(COE, answer)
        except MailError as error:
            self._post(ERROR, struct.pack('<HH', _COMMAND_ERROR, error.detail))

    def _answers(self, length: int, kind: int, content: bytes) -> Iterable[bytes]:
        if kind != COE:
            raise MailError(UNSUPPORTED_PROTOCOL)
        if length > len(content):
            raise MailError(INVALID_SIZE)
        return self._protocol.answers(content[:length])

    def post_emergency(self, emergency: Emergency) -> None:
        """Send an emergency; it is lost if too many mails wait."""
        if len(self._waiting) < MOST_WAITING:
            self._post(COE, self._protocol.emergency(emergency))

    def _post(self, kind: int, content: bytes) -> None:
        self._sent_counter = self._sent_counter % _COUNTERS + 1
        self._waiting.append(
            _HEADER.pack(len(content), 0, 0, kind | self._sent_counter << 4) + content)
        self._fill()

    def _fill(self) -> None:
        """Put the next mail into the empty mailbox."""
        if self._waiting and not self._into.is_full:
            self._present = self._waiting.popleft()
            self._into.put(self._present)

    def note_read(self) -> None:
        """Go on after the master has read a mail."""
        self._read, self._present = self._present, b''
        self._fill()
        self.receive()

    def repeat(self) -> None:
        """Put back the mail read last, if the master has asked for it by the repeat bit."""
        if not self._into.is_repeat_wanted:
            return
        if self._read:
            if self._present:
                self._waiting.appendleft(self._present)
            self._present = self._read
            self._into.put(self._present)
        self._into.acknowledge_repeat()
