"""
Fieldbus memory management units: bits of the logical memory mapped to a slave's own memory.

An FMMU maps a run of bits, counted from the least significant bit of each byte. Whole bytes are
the usual case and are copied as such.
"""

import struct
from typing import NamedTuple

from isa_ros.fieldbus.ethercat.registers import FMMU, FMMU_SIZE, N_FMMUS

_LAYOUT = struct.Struct('<IHBBHBBB')
_READ, _WRITE, _ACTIVE = 1, 2, 1


class Fmmu(NamedTuple):
    """An active FMMU."""

    logical: int
    """First logical address."""
    length: int
    """Logical bytes that it touches."""
    start_bit: int
    end_bit: int
    """First and last bit in the first and in the last logical byte."""
    physical: int
    """First address in the slave's memory."""
    physical_bit: int
    reads: bool
    """The master reads through it."""
    writes: bool
    """The master writes through it."""

    @property
    def end(self) -> int:
        """Return the logical address behind it."""
        return self.logical + self.length

    @property
    def is_bytewise(self) -> bool:
        """Return whether it maps whole bytes."""
        return self.start_bit == 0 and self.end_bit == 7 and self.physical_bit == 0

    @property
    def bits(self) -> int:
        """Return how many bits it maps."""
        return 8 * (self.length - 1) + self.end_bit - self.start_bit + 1


class FmmuWindow(NamedTuple):
    """The part of an FMMU that a datagram reaches: bits in the datagram, bits in the memory."""

    first: int
    """First bit in the datagram's data."""
    physical: int
    """First bit in the slave's memory."""
    bits: int

    @property
    def addresses(self) -> tuple[int, int]:
        """Return the first address in the memory and the one behind the last."""
        return self.physical >> 3, self.physical + self.bits + 7 >> 3


def active_fmmus(memory: bytearray) -> list[Fmmu]:
    """Return the active FMMUs that the registers describe; those of no bits are left out."""
    found = []
    for k in range(N_FMMUS):
        logical, length, start, end, physical, bit, kind, active = _LAYOUT.unpack_from(
            memory, FMMU + k * FMMU_SIZE)
        fmmu = Fmmu(logical, length, start & 7, end & 7, physical, bit & 7, bool(kind & _READ),
                    bool(kind & _WRITE))
        if active & _ACTIVE and length and fmmu.bits > 0:
            found.append(fmmu)
    return found


def window(fmmu: Fmmu, logical: int, length: int) -> FmmuWindow | None:
    """Return what ``length`` bytes of data at a logical address reach of an FMMU."""
    mapped = 8 * fmmu.logical + fmmu.start_bit
    first = max(8 * logical, mapped)
    last = min(8 * (logical + length), mapped + fmmu.bits)
    if last <= first:
        return None
    return FmmuWindow(first - 8 * logical, 8 * fmmu.physical + fmmu.physical_bit + first - mapped,
                      last - first)


def copy_bits(
        source: bytes | bytearray, first: int, target: bytearray, at: int, bits: int) -> None:
    """Copy a run of bits between two places; the other bits of ``target`` stay."""
    taken = int.from_bytes(source[first >> 3:first + bits + 7 >> 3], 'little') >> (first & 7)
    start, end = at >> 3, at + bits + 7 >> 3
    mask = (1 << bits) - 1 << (at & 7)
    old = int.from_bytes(target[start:end], 'little')
    target[start:end] = (old & ~mask | taken << (at & 7) & mask).to_bytes(end - start, 'little')
