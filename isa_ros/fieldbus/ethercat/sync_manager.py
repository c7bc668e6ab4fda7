"""
Sync managers: buffers in a slave's memory that master and application hand to each other.

In mailbox mode a buffer is either full or empty: a write to a full one and a read of an empty one
are refused. In buffered mode both sides always have access, and what is read is consistent. In
either mode an access opens a buffer at its first byte and passes it on at its last one.
"""

from typing import NamedTuple

from isa_ros.fieldbus.ethercat.registers import (
    END, MEMORY, N_SYNC_MANAGERS, SYNC_MANAGER, SYNC_MANAGER_SIZE)

MAILBOX_OUT, MAILBOX_IN, OUTPUTS, INPUTS = range(4)
"""Sync managers by their use: mail from the master, to it, process data from it, to it."""

_MODE, _BUFFERED, _MAILBOX = 0x03, 0x00, 0x02
_DIRECTION, _FROM_MASTER = 0x0C, 0x04
_WATCHDOG = 0x40
_ACTIVE, _REPEAT = 1, 2
_LOCKED, _REPEATED = 1, 2
_WRITTEN_EVENT, _READ_EVENT, _FULL = 0x01, 0x02, 0x08
_NO_BUFFER = 0x30


class SyncManagerSetup(NamedTuple):
    """What a master configures of a sync manager."""

    start: int
    length: int
    is_mailbox: bool
    is_from_master: bool
    has_watchdog: bool
    is_active: bool


def read_setup(memory: bytearray, number: int) -> SyncManagerSetup:
    """Return how the registers configure a sync manager."""
    at = SYNC_MANAGER + number * SYNC_MANAGER_SIZE
    control = memory[at + 4]
    return SyncManagerSetup(
        memory[at] | memory[at + 1] << 8, memory[at + 2] | memory[at + 3] << 8,
        control & _MODE == _MAILBOX, control & _DIRECTION == _FROM_MASTER,
        bool(control & _WATCHDOG), bool(memory[at + 6] & _ACTIVE))


class SyncManager:
    """One sync manager; `is_open` is True while an access of the master is under way."""

    def __init__(self, memory: bytearray, number: int) -> None:
        self._memory = memory
        self._at = SYNC_MANAGER + number * SYNC_MANAGER_SIZE
        self.number = number
        self.is_open = False
        self._waiting: bytes | None = None
        self.configure()

    def configure(self) -> None:
        """Take the registers; a sync manager that is off is reset."""
        self.setup = read_setup(self._memory, self.number)
        self.start, self.end = self.setup.start, self.setup.start + self.setup.length
        if not self.setup.is_active:
            self.reset()

    def reset(self) -> None:
        """Empty the buffer."""
        self.is_open, self._waiting = False, None
        self._memory[self._at + 5] = 0 if self.setup.is_mailbox else _NO_BUFFER

    @property
    def covers(self) -> bool:
        """Return whether the sync manager protects its buffer."""
        return self.setup.is_active and MEMORY <= self.start < self.end <= END

    @property
    def is_locked(self) -> bool:
        """Return whether the application denies every access of the master."""
        return bool(self._memory[self._at + 7] & _LOCKED)

    @property
    def is_full(self) -> bool:
        """Return whether a mailbox contains a mail."""
        return bool(self._memory[self._at + 5] & _FULL)

    def lock(self, is_locked: bool) -> None:
        """Deny the master access, or allow it; what was in the buffer is gone."""
        if is_locked != self.is_locked:
            self._memory[self._at + 7] ^= _LOCKED
            self.reset()

    @property
    def is_repeat_wanted(self) -> bool:
        """Return whether the master wants the last mail again."""
        return bool((self._memory[self._at + 6] ^ self._memory[self._at + 7]) & _REPEAT)

    def acknowledge_repeat(self) -> None:
        """Tell the master that the last mail is there again."""
        self._memory[self._at + 7] ^= _REPEATED

    def allows(self, start: int, is_write: bool) -> bool:
        """Return whether the master may access the buffer from this address on."""
        if self.is_locked or is_write != self.setup.is_from_master:
            return False
        if self.setup.is_mailbox and self.is_full == is_write:
            return False
        return self.is_open or start <= self.start

    def note_access(self, end: int) -> bool:
        """Note that the master has accessed up to an address; return whether that was the last."""
        self.is_open = end < self.end
        if self.is_open:
            return False
        if self.setup.is_from_master:
            self._note_write()
        else:
            self._note_read()
            if self._waiting is not None:
                self.put(self._waiting)
                self._waiting = None
        return True

    def take(self) -> bytes:
        """Return the content for the application; a mailbox is empty then."""
        self._note_read()
        return bytes(self._memory[self.start:self.end])

    def put(self, content: bytes) -> None:
        """Fill the buffer for the master; one that is being read changes when that is done."""
        if self.is_open:
            self._waiting = content
            return
        self._memory[self.start:self.end] = content.ljust(self.setup.length, b'\0')
        self._note_write()

    def _note_write(self) -> None:
        """Set the status of a buffer that was written."""
        self._memory[self._at + 5] = _WRITTEN_EVENT | (_FULL if self.setup.is_mailbox else 0)

    def _note_read(self) -> None:
        """Set the status of a buffer that was read."""
        self._memory[self._at + 5] = _READ_EVENT


def sync_managers(memory: bytearray) -> list[SyncManager]:
    """Return all sync managers of a slave."""
    return [SyncManager(memory, number) for number in range(N_SYNC_MANAGERS)]
