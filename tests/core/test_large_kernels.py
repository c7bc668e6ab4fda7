"""Large kernels that no library has are lowered by a process, once, and give the same bytes."""

from concurrent.futures import ThreadPoolExecutor
import math
import os
import sys
import time
from typing import NamedTuple

from isa_ros.core import bitcode, kernel as kernels, kernel_key, large_kernels
from isa_ros.core import object_making
from isa_ros.core.bound import Bound
from isa_ros.core.compilations import compilations
from isa_ros.core.kernel import entry_address, kernel, kernel_function, KernelEntry
from isa_ros.core.kinds import kind_of, TupleKind
from isa_ros.core.large_kernels import is_large, is_made, made, MANY
import numpy as np
import pytest

pytestmark = pytest.mark.usefixtures('directory')


class Numbers(NamedTuple):
    """A memory."""

    numbers: np.ndarray


@kernel
def third(x):
    return x / 3.0


def fill(x, table):
    """Fill a table with thirds; return the last one and how many."""
    for k in range(len(table)):
        table[k] = third(x + k)
    return table[-1], len(table)


@kernel
def lowered_thirds(x, table):
    """As `fill`."""
    for k in range(len(table)):
        table[k] = third(x + k)
    return table[-1], len(table)


@kernel
def compiled_thirds(x, table):
    """As `fill`."""
    for k in range(len(table)):
        table[k] = third(x + k)
    return table[-1], len(table)


@kernel
def bound_thirds(own):
    """Divide numbers by three; return how many."""
    for k in range(len(own.numbers)):
        own.numbers[k] = third(own.numbers[k])
    return len(own.numbers)


@kernel
def half(x):
    return x / 2.0


@kernel
def two_calls(own):
    """Call two, one of them twice and for two types."""
    own.numbers[0] = third(own.numbers[0])
    own.numbers[1] = half(own.numbers[1]) + third(1)
    return 0


@kernel
def checked(x):
    """Raise an error."""
    if x < 0.0:
        raise ValueError('below zero')
    return third(x)


@kernel_function
def guarded(x):
    """Raise an error; Python calls it too."""
    if x < 0.0:
        raise ValueError('below zero')
    return x


@kernel
def checked_by_another(x):
    return third(guarded(x))


@kernel
def sine(x):
    """Call a function that no object has."""
    return math.sin(third(x))


def no_process(monkeypatch):
    """Let a process that makes bitcode fail."""
    monkeypatch.setattr(bitcode, '_PROGRAM', 'raise SystemExit(9)')


def check(own):
    """Compare with Python what a kernel does with two arguments."""
    table, expected = np.zeros(5), np.zeros(5)
    for x in (1.7, -0.3):
        assert own(x, table) == fill(x, expected)
        assert table.tobytes() == expected.tobytes() != bytes(40)


def test_a_kernel_of_many_takes_no_compiler_here(directory):
    check(lowered_thirds)
    assert not lowered_thirds.overloads
    assert sorted(path.suffix for path in directory.iterdir()) == ['.bc', '.o']


def test_one_of_few_is_compiled_here(monkeypatch, directory):
    monkeypatch.setattr(large_kernels, 'MANY', 3)
    check(compiled_thirds)
    assert compiled_thirds.overloads and not directory.exists()


def entry(own=bound_thirds):
    """Return an entry over a memory of five numbers."""
    return KernelEntry(own, kind_of(Numbers(np.zeros(5))))


def test_a_bound_kernel_is_made_once(monkeypatch, directory):
    """And loaded again by the next start; numba keeps nothing of it."""
    monkeypatch.setattr(kernels, 'is_kept', lambda kernel: False)
    assert not is_made(entry()) and not entry().is_kept()
    loaded = []
    for _ in range(2):
        own = Numbers(np.arange(5.0))
        assert Bound(bound_thirds, own).run() == 5
        assert list(own.numbers) == [x / 3.0 for x in range(5)]
        loaded.append(made(entry()))
        assert is_made(entry()) and entry().is_kept()
        no_process(monkeypatch)     # from now on
        large_kernels._made.cache_clear()
        entry_address.cache_clear()
    assert loaded[0] is not loaded[1] and None not in loaded
    assert not entry().compiled.overloads
    for path in directory.iterdir():
        path.unlink()
    assert not is_made(entry()) and made(entry()) is None


class Noting:
    """Notes what it is told."""

    def __init__(self):
        self.told = []

    def start(self, kernel):
        """Note it."""
        self.told.append(kernel)

    def end(self):
        """Note an end."""
        self.told.append('end')


def test_who_watches_is_told_of_each_kernel():
    """Once, and not of what makes an entry of one."""
    own, began = Noting(), []
    with compilations().watched_by(own), compilations().awaited_by(lambda: began.append(1)):
        assert made(entry(two_calls)) is not None
    assert began == [1]
    assert own.told == [two_calls, third, 'end', half, 'end', 'end']


def test_a_process_that_ends_leaves_it_to_numba(monkeypatch, directory):
    """Who watches is told that all ends."""
    monkeypatch.setattr(bitcode, '_PROGRAM', """
import os, pickle
told = pickle.load(sys.stdin.buffer).told
os.write(told, b'entry\\nthird\\n')
os.kill(os.getpid(), 9)
""")
    entry_address.cache_clear()
    own, numbers = Noting(), Numbers(np.array([1.0, 2.0]))
    with compilations().watched_by(own):
        assert Bound(bound_thirds, numbers).run() == 2
    assert list(numbers.numbers) == [1.0 / 3.0, 2.0 / 3.0]
    assert own.told == [third, 'end'] and not directory.exists()


def test_what_no_object_can_have_is_left_to_numba(directory):
    assert sine(1.2) == math.sin(1.2 / 3.0)
    for own in (checked, checked_by_another):
        with pytest.raises(ValueError, match='below zero'):
            own(-1.0)
    assert not directory.exists()


def test_what_numba_keeps_is_taken(monkeypatch):
    """As where a process was of no use; and values that are no longer those of the sources."""
    for name, result in (('is_kept', True), ('is_unchanged', False)):
        large_kernels._made.cache_clear()
        with monkeypatch.context() as patch:
            patch.setattr(large_kernels, name, lambda kernel, result=result: result)
            patch.setattr(large_kernels, 'Told', None)      # nothing is begun
            assert made(entry()) is None


def test_threads_make_one(monkeypatch):
    """The other one waits."""
    before, begun = object_making.objects_of_entries, []

    def slow(*given):
        begun.append(1)
        time.sleep(0.2)
        return before(*given)
    monkeypatch.setattr(object_making, 'objects_of_entries', slow)
    with ThreadPoolExecutor(2) as pool:
        first, second = pool.map(made, [entry(), entry()])
    assert first is second is not None and len(begun) == 1


@pytest.mark.parametrize('spoil', [
    lambda patch: patch.setattr(sys, 'executable', '/none/such'),
    lambda patch: patch.setattr(sys, 'executable', None),
    lambda patch: patch.setattr('tempfile.TemporaryFile', refuse),
    lambda patch: patch.setattr(os, 'pipe', refuse),
    lambda patch: patch.setattr(bitcode, '_PROGRAM', 'print("no bitcode")'),
    lambda patch: patch.setattr(bitcode, 'environment', lambda: 'numba 99')],
    ids=['no program', 'embedded', 'no file', 'no pipe', 'no bitcode', 'another compiler'])
def test_without_a_process_it_is_numbas(monkeypatch, directory, spoil):
    with monkeypatch.context() as patch:
        spoil(patch)
        assert made(entry()) is None
    assert not directory.exists()


def refuse(*given):
    """Refuse as the system does."""
    raise OSError(28, 'No space left on device')


def test_an_entry_in_a_function_is_numbas():
    class Local(NamedTuple):
        numbers: np.ndarray

    assert made(KernelEntry(bound_thirds, kind_of(Local(np.zeros(5))))) is None


def test_what_is_large(monkeypatch):
    """Kernels of this package, unless a setting or a value without a text is numba's."""
    from isa_ros.actuator.integration import rk4_step, rk4_steps
    from isa_ros.actuator.ticking import tick_kernel
    from isa_ros.surroundings.bodies.leg.stepping import show
    part = KernelEntry(rk4_step, TupleKind(tuple, ()), True)
    assert not is_large(part)       # its types are those of what calls it
    assert is_large(part._replace(is_called=False))
    step = KernelEntry(rk4_steps, TupleKind(tuple, ()), True)
    assert is_large(step) and is_large(entry())
    with monkeypatch.context() as patch:
        patch.setattr(large_kernels, 'PACKAGES', ['isa_ros'])
        patch.setattr(large_kernels, 'MANY', MANY)
        assert is_large(step) and not is_large(entry())
        assert is_large(tick_kernel())      # a part of the robot's tick, too
        assert is_large(KernelEntry(show, TupleKind(tuple, ())))    # of a leg: 30 kernels
        patch.setattr(large_kernels, 'PACKAGES', ['tests'])
        assert not is_large(step) and not is_large(entry())
        patch.setattr(large_kernels, 'PACKAGES', ['isa_ros'])
        patch.setenv('NUMBA_OPT', '3')
        assert not is_large(step) and not is_made(step) and made(step) is None

    def refuse(*given):
        raise kernel_key.UnknownValue('a module')
    monkeypatch.setattr(large_kernels, 'kernels_of', refuse)
    assert not is_large(entry())
