"""
Datagrams on logical memory, through the FMMUs of all slaves.

What a datagram copies between frame and slaves changes only when a master configures: it is
planned once and kept. Whole buffers of process data and the status of mailboxes are copied
directly; everything else, such as single bits, goes through the controller.
"""

from collections.abc import Sequence
from typing import NamedTuple

from isa_ros.fieldbus.ethercat.datagrams import Command, Datagram
from isa_ros.fieldbus.ethercat.fmmu import copy_bits, Fmmu, FmmuWindow, window
from isa_ros.fieldbus.ethercat.registers import (
    N_SYNC_MANAGERS, SYNC_MANAGER, SYNC_MANAGER_SIZE)
from isa_ros.fieldbus.ethercat.slave import READ, Slave, WRITTEN

_READ_COUNT = 1
_WRITE_COUNT = {Command.LWR: 1, Command.LRW: 2}
_READS, _WRITES = (Command.LRD, Command.LRW), (Command.LWR, Command.LRW)

Copy = tuple[int, int, int, int]
"""Addresses in the slave's memory from and to, offsets in the frame from and to."""


class SlaveAccess(NamedTuple):
    """What a datagram does at one slave."""

    slave: Slave
    memory: bytearray
    writes: tuple[Copy, ...]
    reads: tuple[Copy, ...]
    windows: tuple[tuple[Fmmu, FmmuWindow], ...]
    """If any of them needs the controller: all; else none."""
    increment: int
    """What the copies add to the working counter."""
    exchanged: int
    """Process data that the copies exchange: bits of `Slave.exchanged`."""


def plan(slaves: Sequence[Slave], datagram: Datagram) -> list[SlaveAccess]:
    """Return the steps of a datagram at the slaves that it reaches."""
    steps = []
    for slave in slaves:
        windows = tuple(_windows(slave, datagram))
        if windows:
            steps.append(_direct(slave, datagram, windows) or SlaveAccess(
                slave, slave.controller.memory, (), (), windows, 0, 0))
    return steps


def _windows(slave: Slave, datagram: Datagram) -> list[tuple[Fmmu, FmmuWindow]]:
    found = []
    for fmmu in slave.controller.fmmus:
        reached = window(fmmu, datagram.logical, datagram.end - datagram.data)
        if reached is not None and (
                (fmmu.reads and datagram.command in _READS)
                or (fmmu.writes and datagram.command in _WRITES)):
            found.append((fmmu, reached))
    return found


def _direct(slave: Slave, datagram: Datagram,
            windows: Sequence[tuple[Fmmu, FmmuWindow]]) -> SlaveAccess | None:
    """Return the copies of whole buffers, None if there is anything else to do."""
    writes: list[Copy] = []
    reads: list[Copy] = []
    exchanged = 0
    for fmmu, reached in windows:
        start, end = reached.addresses
        if not fmmu.is_bytewise or fmmu.reads == fmmu.writes:
            return None
        if slave.is_whole_buffer(start, end, fmmu.writes):
            exchanged |= WRITTEN if fmmu.writes else READ
        elif fmmu.writes or not _is_status(start, end):
            return None
        at = datagram.data + (reached.first >> 3)
        (writes if fmmu.writes else reads).append((start, end, at, at + end - start))
    count = (_WRITE_COUNT[Command(datagram.command)] if writes else 0) + (
        _READ_COUNT if reads else 0)
    return SlaveAccess(
        slave, slave.controller.memory, tuple(writes), tuple(reads), (), count, exchanged)


def _is_status(start: int, end: int) -> bool:
    """Return whether these are registers of sync managers, which a read does not change."""
    return SYNC_MANAGER <= start and end <= SYNC_MANAGER + N_SYNC_MANAGERS * SYNC_MANAGER_SIZE


def execute(steps: Sequence[SlaveAccess], frame: bytearray, datagram: Datagram) -> int:
    """Exchange a datagram's data with the slaves; return what to add to the working counter."""
    counter = 0
    for slave, memory, writes, reads, windows, increment, exchanged in steps:
        for start, end, at, behind in writes:
            memory[start:end] = frame[at:behind]
        for start, end, at, behind in reads:
            frame[at:behind] = memory[start:end]
        slave.exchanged |= exchanged
        counter += increment if not windows else _by_controller(slave, windows, frame, datagram)
    return counter


def _by_controller(slave: Slave, windows: Sequence[tuple[Fmmu, FmmuWindow]], frame: bytearray,
                   datagram: Datagram) -> int:
    """Exchange data through the controller, written before read; return the count."""
    received = bytes(frame[datagram.data:datagram.end])
    has_written = has_read = False
    for fmmu, reached in windows:
        if fmmu.writes and datagram.command in _WRITES:
            has_written |= _write(slave, reached, received)
    for fmmu, reached in windows:
        if fmmu.reads and datagram.command in _READS:
            has_read |= _read(slave, reached, frame, datagram)
    return (_READ_COUNT if has_read else 0) + (
        _WRITE_COUNT[Command(datagram.command)] if has_written else 0)


def _write(slave: Slave, reached: FmmuWindow, received: bytes) -> bool:
    start, end = reached.addresses
    content = bytearray(slave.controller.memory[start:end]).ljust(end - start, b'\0')
    copy_bits(received, reached.first, content, reached.physical & 7, reached.bits)
    return slave.controller.write(start, bytes(content))


def _read(slave: Slave, reached: FmmuWindow, frame: bytearray, datagram: Datagram) -> bool:
    start, end = reached.addresses
    content = slave.controller.read(start, end - start)
    if content is None:
        return False
    copy_bits(content, reached.physical & 7, frame, 8 * datagram.data + reached.first,
              reached.bits)
    return True
