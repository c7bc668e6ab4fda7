"""Kernels that are lowered for objects give the bytes of those that are compiled."""

import os
from pathlib import Path
import subprocess
import sys

from isa_ros.core.bound import Bound
from isa_ros.core.kernel import kernel
from isa_ros.core.lowering import LARGE
import numpy as np
import pytest
from tests.core.test_bound import memory, move

ROOT = Path(__file__).parents[2]
BEGIN = """
from pathlib import Path
import sys
from isa_ros.core import lowering
lowering.LARGE = int(sys.argv[1])
lowering.lower_only()
from isa_ros.core.objects import library_of, own_target
from isa_ros.core.compiler import compiled_entry
from isa_ros.core.kernel import entry_of
from isa_ros.core.kinds import kind_of
from tests.core.test_lowering import memory, move, outer
from tests.objects import made_object
"""


@kernel
def inner(row):
    """Return a number that does not fold."""
    return row[0] / row[1] + row[1] / row[2]


@kernel
def outer(own):
    """Call two of them; return 0."""
    own.table[0, 3] = inner(own.table[0]) + inner(own.table[1])
    return 0


def lowered(program: str, *arguments: object, large: int = LARGE) -> str:
    """Run a program in a process that lowers only; return what it prints."""
    return subprocess.run(
        [sys.executable, '-c', BEGIN + program, str(large), *map(str, arguments)], cwd=ROOT,
        check=True, capture_output=True, text=True,
        env={**os.environ, 'PYTHONPATH': str(ROOT)}).stdout.strip()


OBJECT = """
code = made_object({'moved': entry_of(move, kind_of(memory()))}, own_target())
library_of([code], Path(sys.argv[2]))
"""


@pytest.mark.parametrize('large', [LARGE, 1])
def test_an_object_gives_the_same_bytes(tmp_path, large):
    """However much of it is inlined."""
    import ctypes
    path = tmp_path / 'moved.so'
    lowered(OBJECT, path, large=large)
    called = ctypes.CDLL(str(path))['moved']
    own, other = memory(), memory()
    table = Bound(move, own)
    assert called(ctypes.c_void_p(table.table.ctypes.data)) == Bound(move, other).run()
    assert own.table.tobytes() == other.table.tobytes() != memory().table.tobytes()


def test_nothing_is_kept(tmp_path, monkeypatch):
    """Nor is what is kept used: it is not made of instructions."""
    monkeypatch.setenv('NUMBA_CACHE_DIR', str(tmp_path / 'kept'))
    first, second = tmp_path / 'a' / 'moved.so', tmp_path / 'b' / 'moved.so'
    first.parent.mkdir()
    second.parent.mkdir()
    lowered(OBJECT, first)
    assert list((tmp_path / 'kept').rglob('*.*')) == []
    kept = ('from isa_ros.core.bound import Bound\n'
            'from tests.core.test_bound import memory, move\n'
            'Bound(move, memory())')
    subprocess.run([sys.executable, '-c', kept], cwd=ROOT, check=True)
    names = {path.name for path in (tmp_path / 'kept').rglob('*.*')}
    assert any(name.startswith('test_bound.move-') for name in names)
    lowered(OBJECT, second)
    assert {path.name for path in (tmp_path / 'kept').rglob('*.*')} == names
    assert first.read_bytes() == second.read_bytes()


AFTER_OTHERS = """
if sys.argv[2] == 'after others':
    made_object({'other': entry_of(outer, kind_of(memory()))}, own_target())
code = made_object({'moved': entry_of(move, kind_of(memory()))}, own_target())
Path(sys.argv[3]).write_bytes(code)
"""


def test_an_object_has_the_same_bytes_whatever_was_lowered_before(tmp_path):
    """Names of what is within are those of its kernels, without the numbers of numba."""
    for order in ('alone', 'after others'):
        lowered(AFTER_OTHERS, order, tmp_path / order)
    code = (tmp_path / 'alone').read_bytes()
    assert code == (tmp_path / 'after others').read_bytes()


SIZES = """
entry = compiled_entry(entry_of(outer, kind_of(memory())))
sizes = {}
for own in (entry.library, *lowering._reached(entry.library)):
    for name, size in getattr(own, 'sizes', {}).items():
        inlined = own._final_module.get_function(name).attributes
        sizes[name] = size, any(b'alwaysinline' in attribute for attribute in inlined)
for kernel in ('inner', 'outer'):
    size, is_inlined = min(found for name, found in sizes.items() if f'5{kernel}B' in name)
    print(size, is_inlined)
"""


def test_a_size_counts_what_is_called():
    """A function above the bound is not inlined by force; the entry of one is larger than it."""
    small, large = (lowered(SIZES, large=bound).splitlines() for bound in (LARGE, 10))
    inner_size, outer_size = (int(line.split()[0]) for line in small)
    assert 10 < inner_size < LARGE / 10 and 2 * inner_size < outer_size < 40 * inner_size
    assert [line.split()[1] for line in small] == ['True', 'True']
    assert [line.split()[1] for line in large] == ['False', 'False']


def test_the_kernel_of_sizes_adds():
    own = memory()
    own.table[:] = np.arange(1.0, 1.0 + own.table.size).reshape(own.table.shape)
    Bound(outer, own).run()
    assert own.table[0, 3] == (1.0 / 2.0 + 2.0 / 3.0) + (5.0 / 6.0 + 6.0 / 7.0)
