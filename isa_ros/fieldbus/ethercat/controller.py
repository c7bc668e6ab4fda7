"""
The controller of a slave: its memory, and what an access to it does.

A read or write is refused as a whole if a sync manager refuses any part of it; the datagram's
working counter shows that.
"""

from collections.abc import Callable

from isa_ros.fieldbus.ethercat.clock import DistributedClock
from isa_ros.fieldbus.ethercat.eeprom import Eeprom
from isa_ros.fieldbus.ethercat.fmmu import active_fmmus
from isa_ros.fieldbus.ethercat.registers import (
    AL_CONTROL, AL_STATUS, DL_CONTROL, DL_STATUS, EEPROM_CONTROL, END, EVENT_MASK, EVENTS,
    FMMU_ENTRY, FORWARDED_ERRORS, LOST_LINKS, MEMORY, N_SYNC_MANAGERS, PDI_ERRORS,
    PDI_WATCHDOG_COUNTER, power_on, RECEIVE_TIMES, Register, RX_ERRORS, SPEED_START,
    STATION_ADDRESS, STATION_ALIAS, SYNC_ACTIVATION, SYNC_MANAGER, SYNC_MANAGER_SETUP,
    SYNC_MANAGER_SIZE, SYSTEM_TIME, TIME_DELAY, TIME_OFFSET, UNIT_ERRORS, WATCHDOG_COUNTER,
    writable)
from isa_ros.fieldbus.ethercat.sync_manager import sync_managers, SyncManager

_WRITABLE = writable()
_CLEARED = (RX_ERRORS, FORWARDED_ERRORS, UNIT_ERRORS, PDI_ERRORS, LOST_LINKS, WATCHDOG_COUNTER,
            PDI_WATCHDOG_COUNTER)
_USE_ALIAS = 0x01
"""Bit 24 of DL control, in its last byte."""
DL_EVENT, AL_EVENT = 0x04, 0x08
_MOST = 0xFF
_LAST_SYNC_MANAGER = SYNC_MANAGER + N_SYNC_MANAGERS * SYNC_MANAGER_SIZE
_SYSTEM_TIME, _SYSTEM_TIME_END = SYSTEM_TIME.address, SYSTEM_TIME.end


def irq_of(memory: bytearray) -> int:
    """Return the events of a slave that the master wants to see."""
    return EVENT_MASK.value(memory) & EVENTS.value(memory)


class SlaveController:
    """Registers and process memory of one slave."""

    def __init__(self, sii: bytearray) -> None:
        self.memory = power_on()
        self.eeprom = Eeprom(self.memory, sii)
        self.sync = sync_managers(self.memory)
        self.fmmus = active_fmmus(self.memory)
        self.addresses: tuple[int, ...] = (0,)
        """Station address, and the alias if DL control allows it."""
        self._protected: list[SyncManager] = []

    def attach(self, clock: DistributedClock, *, on_control: Callable[[], None],
               on_buffer: Callable[[SyncManager], None], on_setup: Callable[[], None]) -> None:
        """
        Connect the clock and the application.

        ``on_control``: AL control was written; ``on_buffer``: the master has filled or emptied a
        buffer; ``on_setup``: FMMUs or sync managers have changed.
        """
        self._clock = clock
        self._effects: tuple[tuple[int, int, Callable[[], None]], ...] = tuple(
            (register.address, register.end, effect) for register, effect in (
                (STATION_ADDRESS, self._take_addresses), (DL_CONTROL, self._take_addresses),
                (AL_CONTROL, on_control), (EEPROM_CONTROL, self._use_eeprom),
                (FMMU_ENTRY, self._take_fmmus), (RECEIVE_TIMES, clock.latch),
                (TIME_OFFSET, clock.restart), (TIME_DELAY, clock.restart),
                (SPEED_START, clock.restart),
                (SYNC_ACTIVATION, clock.note_activation),
                *((one, self._clearing(one)) for one in _CLEARED)))
        self._on_buffer, self._on_setup = on_buffer, on_setup

    def read(self, address: int, length: int) -> bytes | None:
        """Return what a master reads, None if it may not."""
        end = address + length
        if address >= MEMORY:
            return self._read_buffer(address, end)
        if end > MEMORY:
            return None
        if address < _SYSTEM_TIME_END and end > _SYSTEM_TIME:
            self._clock.refresh()
        content = bytes(self.memory[address:end])
        if self.memory[EVENTS.address]:
            self._note_status_read(address, end)
        return content

    def write(self, address: int, content: bytes) -> bool:
        """Write as a master; return whether any of it can be written."""
        if address == _SYSTEM_TIME:
            self._clock.follow(content)
            return True
        end = address + len(content)
        if address >= MEMORY:
            return self._write_buffer(address, end, content)
        if end > MEMORY:
            return False
        mask = _WRITABLE[address:end]
        if not any(mask):
            return False
        if address < _LAST_SYNC_MANAGER and end > SYNC_MANAGER:
            self._write_sync_managers(address, content, mask)
            return True
        self._write_masked(address, content, mask)
        for start, behind, effect in self._effects:
            if address < behind and end > start:
                effect()
        return True

    def note_event(self, event: int) -> None:
        """Set an event that lasts until the master reads its cause."""
        self.memory[EVENTS.address] |= event

    def _note_status_read(self, address: int, end: int) -> None:
        """Clear the events whose cause is read."""
        for register, event in ((DL_STATUS, DL_EVENT), (AL_STATUS, AL_EVENT)):
            if address <= register.address < end:
                self.memory[EVENTS.address] &= ~event

    def count(self, register: Register, offset: int = 0) -> None:
        """Count an error in a register, up to 255."""
        at = register.address + offset
        self.memory[at] = min(self.memory[at] + 1, _MOST)

    def lose_link(self, port: int) -> None:
        """Count that the link of a port was lost."""
        self.count(LOST_LINKS, port)
        self.note_event(DL_EVENT)

    def _write_masked(self, address: int, content: bytes, mask: bytes) -> None:
        """Write the bytes of registers that can be written."""
        for at, (byte, access) in enumerate(zip(content, mask), address):
            if access == 1:
                self.memory[at] = byte

    def _write_sync_managers(self, address: int, content: bytes, mask: bytes) -> None:
        """Write sync managers; those that are active keep all but their activation."""
        allowed = bytearray(mask)
        for manager in self.sync:
            start = SYNC_MANAGER + manager.number * SYNC_MANAGER_SIZE
            for at in range(start, start + SYNC_MANAGER_SETUP.size):
                if manager.setup.is_active and 0 <= at - address < len(allowed):
                    allowed[at - address] = 0
        self._write_masked(address, content, bytes(allowed))
        self.take_sync_managers()

    def take_sync_managers(self) -> None:
        """Take the registers of the sync managers."""
        for manager in self.sync:
            manager.configure()
        self._protected = [manager for manager in self.sync if manager.covers]
        self._on_setup()

    def _take_fmmus(self) -> None:
        self.fmmus = active_fmmus(self.memory)
        self._on_setup()

    def _take_addresses(self) -> None:
        station = (STATION_ADDRESS.value(self.memory),)
        uses_alias = self.memory[DL_CONTROL.end - 1] & _USE_ALIAS
        self.addresses = station + (
            (STATION_ALIAS.value(self.memory),) if uses_alias else ())

    def _use_eeprom(self) -> None:
        self.eeprom.execute()
        self._take_addresses()

    def _clearing(self, register: Register) -> Callable[[], None]:
        return lambda: register.put(self.memory, 0)

    def _touched(self, start: int, end: int) -> list[SyncManager]:
        """Return the sync managers whose buffers these addresses touch."""
        return [one for one in self._protected if start < one.end and end > one.start]

    def _read_buffer(self, address: int, end: int) -> bytes | None:
        touched = self._touched(address, end)
        if end > END or not all(one.allows(address, False) for one in touched):
            return None
        content = bytes(self.memory[address:end])
        for one in touched:
            if one.note_access(end):
                self._on_buffer(one)
        return content

    def _write_buffer(self, address: int, end: int, content: bytes) -> bool:
        touched = self._touched(address, end)
        if end > END or not all(one.allows(address, True) for one in touched):
            return False
        self.memory[address:end] = content
        for one in touched:
            if one.note_access(end):
                self._on_buffer(one)
        return True
