"""
Frames of EtherCAT: Ethernet header, EtherCAT header, datagrams (ETG.1000.4).

A datagram is command (1 byte), index (1), address (4), length and flags (2), IRQ (2), data and the
working counter (2).
"""

from collections.abc import Iterator, Sequence
from enum import IntEnum
import struct
from typing import NamedTuple

ETHERTYPE = 0x88A4
ETHERNET_HEADER, FRAME_HEADER, DATAGRAM_HEADER, COUNTER = 14, 2, 10, 2
FIRST_DATAGRAM = ETHERNET_HEADER + FRAME_HEADER
LENGTH = 0x07FF
"""Bits of a datagram's length."""
HAS_NEXT = 0x8000
"""Flag: another datagram follows."""
TYPE_DATAGRAMS = 1
"""Type of a frame in the top four bits of its header."""

_PROTOCOL, _ADDRESS, _IRQ = 12, 2, 8
"""Offsets: of the protocol in a frame, of address and IRQ in a datagram."""
HEADER = struct.Struct('<BBHHHH')
"""Command, index, slave or low address, offset or high address, length and flags, IRQ."""


class Command(IntEnum):
    """What a datagram does."""

    NOP = 0
    APRD = 1
    APWR = 2
    APRW = 3
    FPRD = 4
    FPWR = 5
    FPRW = 6
    BRD = 7
    BWR = 8
    BRW = 9
    LRD = 10
    LWR = 11
    LRW = 12
    ARMW = 13
    FRMW = 14


LOGICAL_WRITES = (Command.LWR, Command.LRW)


class Datagram(NamedTuple):
    """Place and header of a datagram in a frame."""

    command: int
    at: int
    """Offset of the header."""
    slave: int
    """Position or station address; the low half of a logical address."""
    offset: int
    """Address in the slave's memory; the high half of a logical address."""
    data: int
    """Offset of the data."""
    end: int
    """End of the data, where the working counter is."""

    @property
    def logical(self) -> int:
        """Return the logical address."""
        return self.slave | self.offset << 16


class Datagrams(NamedTuple):
    """The datagrams of a frame up to the first that does not fit."""

    found: tuple[Datagram, ...]
    is_whole: bool
    """Whether the frame contains all the datagrams it announces."""
    writes: tuple[tuple[int, int], ...]
    """Logical addresses that are written: the first one, and the one behind the last."""
    size: int
    """Bytes of the frame."""
    headers: tuple[tuple[int, bytes], ...]
    """Where the frame says how it is laid out, and what it says there."""

    def describe(self, frame: bytearray, size: int) -> bool:
        """Return whether another frame has the same datagrams, with any data."""
        if size != self.size:
            return False
        for at, header in self.headers:
            if frame[at:at + len(header)] != header:
                return False
        return True


def is_ethercat(frame: bytearray, size: int) -> bool:
    """Return whether an Ethernet frame contains EtherCAT datagrams."""
    return (size >= FIRST_DATAGRAM and frame[12] == ETHERTYPE >> 8
            and frame[13] == ETHERTYPE & 0xFF and frame[15] >> 4 == TYPE_DATAGRAMS)


def datagrams(frame: bytearray, size: int) -> Datagrams:
    """Return the datagrams of an EtherCAT frame of ``size`` bytes."""
    found: list[Datagram] = []
    limit = FIRST_DATAGRAM + ((frame[14] | frame[15] << 8) & LENGTH)
    at = FIRST_DATAGRAM if limit <= size else limit
    has_next = True
    while has_next and at + DATAGRAM_HEADER + COUNTER <= limit:
        command, _, slave, offset, length, _ = HEADER.unpack_from(frame, at)
        start = at + DATAGRAM_HEADER
        end = start + (length & LENGTH)
        if end + COUNTER > limit:
            break
        found.append(Datagram(command, at, slave, offset, start, end))
        has_next = bool(length & HAS_NEXT)
        at = end + COUNTER
    return Datagrams(
        tuple(found), not has_next,
        tuple((one.logical, one.logical + one.end - one.data) for one in found
              if one.command in LOGICAL_WRITES),
        size, tuple(_headers(frame, found)))


def _headers(frame: bytearray, found: Sequence[Datagram]) -> Iterator[tuple[int, bytes]]:
    """Yield what datagrams with other data have in common: all but index and IRQ."""
    yield _PROTOCOL, bytes(frame[_PROTOCOL:FIRST_DATAGRAM])
    for one in found:
        yield one.at, bytes(frame[one.at:one.at + 1])
        yield one.at + _ADDRESS, bytes(frame[one.at + _ADDRESS:one.at + _IRQ])
