"""Numbers that processes share."""

import threading
from typing import NamedTuple

from isa_ros.core.bound import Bound
from isa_ros.core.kernel import IS_COMPILED, kernel
from isa_ros.core.pointers import add_at, load_at
import numpy as np
import pytest

pytestmark = pytest.mark.skipif(not IS_COMPILED, reason='they are machine code')
TIMES = 200_000


class Shared(NamedTuple):
    """A number of 4 bytes beside others, its address, and what was found."""

    numbers: np.ndarray
    address: np.ndarray
    found: np.ndarray


@kernel
def add_often(own):
    for _ in range(own.found[0]):
        add_at(own.address[0], 1)
    return 0


@kernel
def load_and_add(own):
    own.found[0] = load_at(own.address[0])
    own.found[1] = add_at(own.address[0], own.found[2])
    return 0


def shared(value: int, *found: int) -> Shared:
    numbers = np.array([7, value, 9], np.int32)
    return Shared(numbers, np.array([numbers[1:].ctypes.data]), np.array(found))


@pytest.mark.parametrize(('value', 'added', 'expected'), [
    (5, 3, 8), (-12, 1, -11), (-1, 1, 0), (-3, 2**20, 2**20 - 3)])
def test_a_number_is_loaded_and_added_to_with_its_sign(value, added, expected):
    own = shared(value, 0, 0, added)
    Bound(load_and_add, own).run()
    assert own.found.tolist() == [value, expected, added]
    assert own.numbers.tolist() == [7, expected, 9]


def test_nothing_is_lost_where_several_add():
    """Bound kernels run at the same time on threads."""
    own = shared(0, TIMES)
    threads = [threading.Thread(target=Bound(add_often, own).run) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert own.numbers[1] == 4 * TIMES
