"""The memory of kernels as one block: places, tables and what it holds."""

from typing import NamedTuple

from isa_ros.core.bound import table_of
from isa_ros.export.layout import ALIGNED, MemoryLayout, Word
import numpy as np
import pytest


class Rows(NamedTuple):
    """Rows and the same memory as numbers."""

    rows: np.ndarray
    numbers: np.ndarray


class Memory(NamedTuple):
    """A memory with another one in it."""

    first: np.ndarray
    below: Rows
    none: np.ndarray
    last: np.ndarray


PAIR = np.dtype([('x', 'f8'), ('n', 'i8')])


def memory():
    """Return a memory of distinct numbers."""
    rows = np.zeros(3, PAIR)
    rows['x'], rows['n'] = [1.5, 2.5, 3.5], [4, 5, 6]
    return Memory(np.array([7, 8, 9], np.int32), Rows(rows[1:], rows.view('f8').reshape(3, 2)),
                  np.zeros((0, 2)), np.array([[10.5], [11.5]]))


def test_arrays_that_share_memory_share_it_in_the_block():
    own = memory()
    layout = MemoryLayout([own])
    assert layout.place(own.first) == 0 and layout.place(own.first[2:]) == 8
    assert layout.place(own.below.numbers) == 16 and layout.place(own.below.rows) == 32
    assert layout.place(own.below.rows['n'][1:]) == 56
    assert layout.place(own.last) == 64 and layout.size == 80 and layout.size % ALIGNED == 0


def test_places_follow_the_order_of_the_arrays():
    """Not that of their addresses, which differ in each process."""
    arrays = [np.zeros(2) for _ in range(8)]
    for order in (arrays, arrays[::-1]):
        layout = MemoryLayout([tuple(order)])
        assert [layout.place(array) for array in order] == [16 * k for k in range(8)]


def test_neighbours_and_parts():
    """Arrays that only touch are apart; a part of one does not end it."""
    own = np.arange(6.0)
    layout = MemoryLayout([(own[:1], own[1:2])])
    assert layout.place(own[1:2]) == 16 and layout.size == 32
    layout = MemoryLayout([(own[:4], own[1:2])])
    assert layout.place(own[3:4]) == 24 and layout.size == 32


def test_an_array_that_is_not_in_the_block():
    own = np.arange(6.0)
    layout = MemoryLayout([(own[1:4],)])
    assert layout.place(own[1:3]) == 0 and layout.place(own[3:4]) == 16
    for other in (np.zeros(1), own[:2], own[3:5], own[4:]):
        with pytest.raises(ValueError, match='an array of float64 is not in the block'):
            layout.place(other)


def test_the_table_is_that_of_a_bound_kernel():
    own = memory()
    layout = MemoryLayout([own])
    table, addresses = list(layout.table(own)), table_of(own)
    assert len(table) == len(addresses)
    first = own.first.ctypes.data
    for word, number in zip(table, addresses.tolist()):
        if not word.is_place:
            assert word.value == number
    assert [word for word in table if word.is_place] == [
        Word(place, True) for place in (0, 32, 16, 0, 64)]
    assert addresses[0] == first


def test_the_image_is_what_the_arrays_hold():
    own = memory()
    layout = MemoryLayout([own, own])
    image = layout.image().view(np.uint8)
    assert image.nbytes == layout.size
    for array in (own.first, own.below.rows, own.below.numbers, own.last):
        place = layout.place(array)
        assert image[place:place + array.nbytes].tobytes() == array.tobytes()
    assert not image[12:16].any()
