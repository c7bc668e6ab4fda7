"""
The memory of bound kernels as one block, in which everything is found by its distance from 0.

Arrays that share memory, as the states of an actuator and the same as floats, share it in the
block too. A block is filled from an image; the tables of its kernels get its own address.
"""

from bisect import bisect_right
from collections.abc import Iterable, Iterator
import sys
from typing import Any, NamedTuple

from isa_ros.core.bound import arrays_of
import numpy as np
from numpy.typing import NDArray

ALIGNED = 16    # bytes, as malloc() gives them


class Region(NamedTuple):
    """Arrays that overlap: addresses of their first byte and behind their last, and the place."""

    first: int
    end: int
    place: int


class Word(NamedTuple):
    """A number of a kernel's table: a place in the block, or the length of an axis."""

    value: int
    is_place: bool


class MemoryLayout:
    """Places of the arrays of ``memories``, in their order: bytes from the begin of a block."""

    def __init__(self, memories: Iterable[Any]) -> None:
        self._arrays = [
            array for memory in memories for array in arrays_of(memory) if array.size]
        self._regions: list[Region] = []
        self.size = 0
        """Of the block, a multiple of `ALIGNED`."""
        joined: list[tuple[int, int]] = []
        for first, end in sorted(map(_span, self._arrays)):
            if joined and first < joined[-1][1]:
                joined[-1] = joined[-1][0], max(end, joined[-1][1])
            else:
                joined.append((first, end))
        for own, _ in map(_span, self._arrays):
            first, end = joined[bisect_right(joined, (own, sys.maxsize)) - 1]
            if all(region.first != first for region in self._regions):
                self._regions.append(Region(first, end, self.size))
                self.size += -(-(end - first) // ALIGNED) * ALIGNED

    def place(self, array: NDArray[Any]) -> int:
        """
        Return the place of an array or of a part of one.

        Raises
        ------
        ValueError
            It is not in the block.

        """
        first, end = _span(array)
        for region in self._regions:
            if region.first <= first and end <= region.end:
                return region.place + first - region.first
        raise ValueError(f'an array of {array.dtype} is not in the block')

    def table(self, memory: Any) -> Iterator[Word]:
        """Yield the table of a kernel's memory, as `isa_ros.core.bound.table_of`."""
        for array in arrays_of(memory):
            yield Word(self.place(array), True) if array.size else Word(0, True)
            yield from (Word(length, False) for length in array.shape)

    def image(self) -> NDArray[np.uint64]:
        """Return what the arrays hold now, as words of the block."""
        block = np.zeros(self.size, np.uint8)
        for array in self._arrays:
            place = self.place(array)
            block[place:place + array.nbytes] = np.frombuffer(array.tobytes(), np.uint8)
        return block.view(np.uint64)


def _span(array: NDArray[Any]) -> tuple[int, int]:
    first = array.ctypes.data
    return first, first + array.nbytes
