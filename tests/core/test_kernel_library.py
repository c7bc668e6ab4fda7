"""Kernels in a library: found without the compiler, the same results, never an older kernel."""

from importlib import import_module
import os
from pathlib import Path
import subprocess
import sys
from typing import NamedTuple

from isa_ros.core import kernel_library
from isa_ros.core.bound import Bound
from isa_ros.core.kernel import kernel, KernelEntry
from isa_ros.core.kernel_library import own_targets, symbol_of
from isa_ros.core.kinds import kind_of, TupleKind
from isa_ros.core.objects import library_of, own_target
import numpy as np
import pytest
from tests.objects import made_object

MASS = np.dtype([('x', 'f8'), ('n', 'i8')])
SOURCE = """
from typing import NamedTuple
from isa_ros.core.kernel import kernel
import numpy as np
FACTOR = 3
class Found(NamedTuple):
    size: float
    count: int
class Rows(NamedTuple):
    numbers: np.ndarray
@kernel
def times(x):
    return FACTOR * x
@kernel
def of_record(row, share):
    row.n += 2
    return Found(row.x * share, row.n)
@kernel
def of_many(array, pair, is_on):
    total = 0.0
    for k in range(len(array)):
        total += array[k]
    return total, (pair[0], is_on), np.uint64(2 ** 63) + np.uint64(pair[1])
@kernel
def scaled(x, by=2.0):
    return x * by
@kernel
def table(array):
    rows = array.reshape(2, 2)
    return rows[1, 0] - rows[0, 1]
@kernel
def fill(array):
    array[:] = 7.0
@kernel
def count(own):
    own.numbers[1] += FACTOR
    return own.numbers[1]
"""


@pytest.fixture(scope='module')
def home(tmp_path_factory):
    """Return a directory with the module `in_library`, and a library of its kernels."""
    path = tmp_path_factory.mktemp('library')
    (path / 'in_library.py').write_text(SOURCE)
    sys.path.insert(0, str(path))
    try:
        own = import_module('in_library')
    finally:
        sys.path.remove(str(path))
    row, array = np.zeros(1, MASS)[0], np.zeros(4)
    calls = {'times': [(2,), (2.5,)], 'of_record': [(row, 0.5)], 'fill': [(array,)],
             'scaled': [(1.5,)], 'table': [(array,)],
             'of_many': [(array, (1, 2), True), (array[::2], (1, 2), True)]}
    entries = [KernelEntry(getattr(own, name), kind_of(arguments), is_called=True)
               for name, several in calls.items() for arguments in several]
    entries.append(KernelEntry(own.count, kind_of(own.Rows(np.zeros(2, np.int64)))))
    code = made_object({entry.symbol: entry for entry in entries}, own_target())
    library_of([code], path / f'{own_target().name}.so')
    return path


def run(home, program, source=SOURCE, **environment):
    """Return what a program prints that cannot import numba, with a source of `in_library`."""
    (home / 'in_library.py').write_text(source)
    text = ('import sys; sys.modules["numba"] = sys.modules["llvmlite"] = None\n'
            'from pathlib import Path\n'
            'from isa_ros.core import kernel_library\n'
            f'kernel_library.SHIPPED = Path({str(home)!r})\n'
            f'import numpy as np, in_library as own\n{program}')
    done = subprocess.run(
        [sys.executable, '-B', '-c', text], capture_output=True, text=True, timeout=100.0,
        env={**os.environ, 'PYTHONPATH': f'{home}:{Path(__file__).parents[2]}', **environment})
    return done.stdout if done.returncode == 0 else done.stderr.splitlines()[-1]


def test_results_are_those_of_the_kernels(home):
    assert run(home, 'print(own.times(2), own.times(-2.5))') == '6 -7.5\n'
    assert run(home, f"""
row = np.array([(1.5, 4)], {MASS.descr})[0]
print(own.of_record(row, 0.5), row)
array = np.arange(5.0)
print(own.of_many(array, (4, 3), True), own.of_many(array[::2], (4, 3), False))
print(own.fill(array), array.sum())
print(own.scaled(1.5), own.table(np.array([1.0, 2.0, 9.0, 4.0])))
""") == ('Found(size=0.75, count=6) (1.5, 6)\n'
         f'(10.0, (4, True), {2 ** 63 + 3}) (6.0, (4, False), {2 ** 63 + 3})\nNone 35.0\n'
         '3.0 7.0\n')


def test_bound_kernels_are_found(home):
    assert run(home, """
from isa_ros.core.bound import Bound
rows = own.Rows(np.array([1, 5]))
print(Bound(own.count, rows).run(), rows.numbers)
""") == '8 [1 8]\n'


def test_a_kernel_is_looked_up_once_for_each_kind(home):
    assert run(home, """
from isa_ros.core import kernel
own.times(2), own.times(2.5)
kernel.call_in_library = None
print(own.times(3), own.times(0.5))
""") == '9 1.5\n'


NOT_FOUND = 'ModuleNotFoundError: import of llvmlite halted; None in sys.modules'


@pytest.mark.parametrize(('program', 'source', 'environment'), [
    ('own.times(2)', SOURCE.replace('FACTOR = 3', 'FACTOR = 4'), {}),
    ('own.times(2)', SOURCE + '# a remark\n', {}),
    ('own.FACTOR = 4; own.times(2)', SOURCE, {}),
    ('own.FACTOR = {}; own.times(2)', SOURCE, {}),
    ('own.times(True)', SOURCE, {}),
    ('own.times(x=2)', SOURCE, {}),
    ('own.scaled(1.5, by=4.0)', SOURCE, {}),
    ('own.times("2")', SOURCE, {}),
    ('own.fill(np.zeros(2, np.float32))', SOURCE, {}),
    ('own.times(2)', SOURCE, {'NUMBA_BOUNDSCHECK': '1'}),
    ('kernel_library.SHIPPED = Path("none"); own.times(2)', SOURCE, {})])
def test_what_is_not_in_the_library_is_compiled(home, program, source, environment):
    assert run(home, program, source, **environment) == NOT_FOUND


def test_once_no_library_has_a_kernel_it_stays_with_the_compiler(home):
    """Looking each call up again would take longer than the call."""
    assert run(home, """
from unittest.mock import Mock, patch
from isa_ros.core.kernel import Kernel
with patch.object(Kernel, 'compiled', Mock(return_value=9)):
    print(own.times(True), own.times(2))
""") == '9 9\n'


@kernel
def double(x):
    """Return twice x."""
    return 2 * x


def test_a_symbol_tells_forms_and_kinds_apart():
    one, other = (TupleKind(tuple, (kind_of(value),)) for value in (1, 1.0))
    found = {symbol_of(double, form, kind)
             for form in ('bound', 'called') for kind in (one, other)}
    assert len(found) == 4
    assert KernelEntry(double, one).symbol == symbol_of(double, 'bound', one)
    assert KernelEntry(double, one, is_called=True).symbol == symbol_of(double, 'called', one)
    assert symbol_of(double, 'called', one) in found
    assert all(name.startswith('double_') and name.isidentifier() for name in found)


def test_an_edit_of_what_makes_libraries_changes_all_symbols(monkeypatch):
    before = symbol_of(double, 'called', kind_of((1,)))
    monkeypatch.setattr(kernel_library, '_makers', lambda: 'other sources')
    assert symbol_of(double, 'called', kind_of((1,))) != before


FLAGS = 'flags : fpu abm avx2 bmi1 bmi2 f16c fma movbe\n'


@pytest.mark.parametrize(('machine', 'flags', 'expected'), [
    ('x86_64', FLAGS, ['x86-64-v3', 'x86-64']),
    ('x86_64', FLAGS.replace(' fma ', ' '), ['x86-64']),
    ('x86_64', FLAGS.replace('avx2', 'avx2x'), ['x86-64']),
    ('aarch64', '', ['aarch64'])])
def test_targets_of_a_machine(monkeypatch, tmp_path, machine, flags, expected):
    (tmp_path / 'cpuinfo').write_text(flags)
    monkeypatch.setattr(kernel_library, '_PROCESSOR', tmp_path / 'cpuinfo')
    monkeypatch.setattr(
        kernel_library.os, 'uname', lambda: os.uname_result(('', '', '', '', machine)))
    assert own_targets() == expected


def test_the_own_target_is_that_of_the_compiler():
    assert own_targets()[0] == own_target().name


class Rows(NamedTuple):
    """A memory."""

    numbers: np.ndarray


@kernel
def pick(own):
    """Return an element of a tuple; numba checks the index."""
    return (5, 6)[own.numbers[0]]


def test_a_kernel_that_raises_ends_the_process(tmp_path):
    rows = Rows(np.array([1]))
    entry = KernelEntry(pick, kind_of(rows))
    library_of([made_object({'isa_pick': entry}, own_target())], tmp_path / 'lib.so')
    program = f"""
import ctypes, sys
import numpy as np
number = np.array([int(sys.argv[1])])
table = np.array([number.ctypes.data, 1])
print(ctypes.CDLL({str(tmp_path / 'lib.so')!r}).isa_pick(ctypes.c_void_p(table.ctypes.data)))
"""
    codes = [subprocess.run([sys.executable, '-c', program, place], capture_output=True,
                            timeout=100.0) for place in ('1', '2')]
    assert (codes[0].stdout, codes[0].returncode) == (b'6\n', 0)
    assert codes[1].returncode < 0
    assert Bound(pick, rows).run() == 6
