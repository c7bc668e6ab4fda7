"""Kernels over their memory: the same from Python, in a program, and as plain functions."""

import subprocess
import sys
from typing import NamedTuple
from weakref import ref

from isa_ros.core.bound import _with_attributes, arrays_of, Bound, Program, Rebound, table_of
from isa_ros.core.kernel import kernel
import numpy as np
import pytest

MASS = np.dtype([('x', 'f8'), ('v', 'f8')])


class Rows(NamedTuple):
    """A memory in a memory."""

    numbers: np.ndarray


class Masses(NamedTuple):
    """Arrays of every form."""

    masses: np.ndarray
    table: np.ndarray
    rows: Rows
    last: np.ndarray


@kernel
def move(own):
    """Move the masses of the rows; return how many are beyond 5."""
    found = 0
    for k in range(len(own.rows.numbers)):
        mass = own.masses[own.rows.numbers[k]]
        mass.x += mass.v
        own.table[k, 2] += mass.x
        if mass.x > 5.0:
            found += 1
    own.last[0] = own.table.shape[0] * 100 + own.table.shape[1]
    return found


@kernel
def count(own):
    """Count the calls."""
    own.numbers[0] += 1
    return 0


def memory():
    """Return two masses, the second one twice as fast as the first."""
    masses = np.zeros(3, MASS)
    masses['v'] = 1.0, 7.0, 2.0
    return Masses(masses, np.zeros((2, 4)), Rows(np.array([0, 2])), np.zeros(1, np.int32))


def expected(n):
    """Return places of the masses and sums of places after n moves."""
    return [n, 0.0, 2.0 * n], [n * (n + 1) / 2, n * (n + 1)]


def test_a_call_changes_the_memory_in_place():
    own = memory()
    bound = Bound(move, own)
    assert [bound.run() for _ in range(6)] == [0, 0, 1, 1, 1, 2]
    places, sums = expected(6)
    assert own.masses['x'].tolist() == places and own.table[:, 2].tolist() == sums
    assert own.last[0] == 204 and not own.table[:, [0, 1, 3]].any()


def test_two_memories_of_a_kernel_are_apart():
    first, second = memory(), memory()
    bound = Bound(move, first), Bound(move, second)
    bound[0].run(), bound[1].run(), bound[1].run()
    assert first.masses['x'].tolist() == [1.0, 0.0, 2.0]
    assert second.masses['x'].tolist() == [2.0, 0.0, 4.0]


def test_a_call_alone_keeps_all_that_it_reads():
    """Of a bound kernel that is not kept, neither table nor memory gives way to others."""
    bound = Bound(count, Rows(np.zeros(1, np.int64)))
    table, numbers, run = ref(bound.table), ref(bound.memory.numbers), bound.run
    del bound
    assert run() == 0 and table() is not None
    assert numbers().tolist() == [1]
    del run
    assert table() is None and numbers() is None


def test_a_program_ends_at_the_kernel_that_finds_something():
    own, calls = memory(), Rows(np.zeros(2, np.int64))
    after = Rows(np.zeros(1, np.int64))
    program = Program([Bound(count, calls), Bound(move, own), Bound(count, after)])
    assert program.run(2) == (2, -1, 0)
    assert program.run(10) == (0, 1, 1)     # the first beyond 5 is that of the third round
    assert calls.numbers.tolist() == [3, 0] and after.numbers.tolist() == [2]
    own.masses['v'] = -3.0, 0.0, 0.0
    own.masses['x'] = 9.0, 0.0, 0.0
    assert program.run(10) == (0, 1, 1)
    assert program.run(10) == (10, -1, 0)
    assert calls.numbers.tolist() == [14, 0] and after.numbers.tolist() == [12]
    assert own.masses['x'].tolist() == [9.0 - 33.0, 0.0, 0.0]
    assert Program([]).run(3) == (3, -1, 0)
    assert program.run(0) == (0, -1, 0) and after.numbers.tolist() == [12]


def test_arrays_may_be_given_at_each_call():
    own = memory()
    rebound = Rebound(move, lambda table, last: own._replace(table=table, last=last))
    other = own.table.copy()
    first = rebound.to(own.table, own.last)
    assert rebound.to(own.table, own.last) is first
    first.run()
    second = rebound.to(other, own.last)
    assert second is not first and rebound.to(other, own.last) is second
    second.run()
    assert own.table[:, 2].tolist() == [1.0, 2.0] and other[:, 2].tolist() == [2.0, 4.0]


def test_what_cannot_be_bound_is_refused():
    gaps = np.zeros((4, 4))[:, ::2]
    for wrong in (Rows(gaps), Rows([1, 2]), (np.zeros(1), 3.0)):
        with pytest.raises(ValueError, match='is not an array without gaps'):
            table_of(wrong)


def test_a_table_has_addresses_and_shapes():
    own = memory()
    assert table_of(own).tolist() == [
        own.masses.ctypes.data, 3, own.table.ctypes.data, 2, 4, own.rows.numbers.ctypes.data, 2,
        own.last.ctypes.data, 1]
    assert [array is part for array, part in zip(
        arrays_of(own), (own.masses, own.table, own.rows.numbers, own.last))] == [True] * 4


def test_without_the_compiler_it_is_the_same(tmp_path):
    """Plain functions, as in a debugger."""
    code = ('from tests.core import test_bound as t\n'
            'from isa_ros.core.kernel import IS_COMPILED; assert not IS_COMPILED\n'
            't.test_a_call_changes_the_memory_in_place()\n'
            't.test_a_program_ends_at_the_kernel_that_finds_something()\n'
            't.test_arrays_may_be_given_at_each_call()\n')
    subprocess.run([sys.executable, '-c', code], check=True, env={
        'NUMBA_DISABLE_JIT': '1', 'PYTHONPATH': ':'.join(sys.path)})


def test_rows_of_plain_python_have_attributes():
    """Also of records in records, and of several in one; they change the memory itself."""
    inner = np.dtype([('x', 'f8'), ('size', 'i4')], align=True)
    rows = np.zeros(2, np.dtype([('own', inner), ('several', inner, (3,)), ('n', 'u1')]))
    seen, numbers = _with_attributes((rows, Rows(np.arange(3))))
    seen[1].own.x, seen[0].several[2].x, seen[1].n = 2.5, -1.5, 7
    seen[1].own['size'] += 4
    assert rows['own'].tolist() == [(0.0, 0), (2.5, 4)]
    assert rows['several']['x'].tolist() == [[0.0, 0.0, -1.5], [0.0, 0.0, 0.0]]
    assert rows['n'].tolist() == [0, 7] and seen[1].own.x == 2.5 and seen[1].n == 7
    assert numbers.numbers.tolist() == [0, 1, 2] and isinstance(numbers, Rows)
    for missing in (seen[0], seen[0].own):
        with pytest.raises(AttributeError, match='^no field y; valid: '):
            missing.y
        with pytest.raises(AttributeError, match='^no field y; valid: '):
            missing.y = 1.0


def test_a_bound_kernel_is_kept(tmp_path):
    """A second process loads it; one over a memory of another kind is compiled."""
    code = ('import numpy as np\n'
            'from numba.core.event import install_recorder\n'
            'from tests.core.test_bound import count, Rows\n'
            'from isa_ros.core.bound import Bound\n'
            'with install_recorder("numba:compile") as compiled:\n'
            '    Bound(count, Rows(np.zeros(2, np.{})))\n'
            'print([event.data["dispatcher"].__name__ for _, event in compiled.buffer'
            ' if event.is_start])')

    def compiled(number):
        return subprocess.run(
            [sys.executable, '-c', code.format(number)], check=True, capture_output=True,
            text=True, env={'NUMBA_CACHE_DIR': str(tmp_path), 'PYTHONPATH': ':'.join(sys.path)},
            ).stdout.strip()
    assert compiled('int64') == "['entry', 'count']"
    assert compiled('int64') == '[]'
    assert compiled('int32') == "['entry', 'count']"
