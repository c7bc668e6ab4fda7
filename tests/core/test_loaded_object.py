"""Objects are loaded wherever there is room, and in no compiler that cannot do so."""

import gc
from pathlib import Path
import subprocess
import sys

from isa_ros.core import large_kernels, loaded_object
from isa_ros.core.kernel import KernelEntry
from isa_ros.core.kinds import kind_of
from isa_ros.core.loaded_object import can_load, LoadedObject
from isa_ros.core.object_making import objects_of_entries
from isa_ros.core.objects import own_target
import numpy as np
import pytest
from tests.core.test_large_kernels import bound_thirds, Numbers

_LOAD = """
import ctypes, mmap, sys
import numpy as np
from isa_ros.core.loaded_object import LoadedObject
code, numbers, page = sys.stdin.buffer.read(), np.arange(3.0), mmap.PAGESIZE
table = np.array([numbers.ctypes.data, 3, 8], np.int64)
system = ctypes.CDLL(None)
system.mmap.restype = ctypes.c_size_t
system.mmap.argtypes = (
    ctypes.c_void_p, ctypes.c_size_t, *(ctypes.c_int,) * 3, ctypes.c_ssize_t)
system.munmap.argtypes = ctypes.c_void_p, ctypes.c_size_t


def taken(size):
    return system.mmap(None, size, 0, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS, -1, 0)


LARGE = 6 << 30
large = taken(LARGE)
for size in (1 << 30, 1 << 24, 1 << 18, page):   # all other room above it
    while taken(size) > large:
        pass
assert system.munmap(large + LARGE - 2 * page, page) == 0
address = LoadedObject(code).address('thirds')
ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p)(address)(table.ctypes.data)
print(numbers.tolist())
"""
"""Room for a page at the end of a large array, and for others only in front of it."""


def entry() -> KernelEntry:
    """Return an entry over three numbers."""
    return KernelEntry(bound_thirds, kind_of(Numbers(np.zeros(3))))


def test_code_and_its_numbers_lie_together_beside_a_large_array() -> None:
    code, = objects_of_entries([{'thirds': entry()}], own_target())
    done = subprocess.run([sys.executable, '-c', _LOAD], input=code, capture_output=True)
    assert done.returncode == 0, done.stderr.decode()
    assert done.stdout.decode() == f'{[k / 3.0 for k in range(3)]}\n'


def test_code_stays_when_nobody_refers_to_it() -> None:
    """Addresses of it are in other memories."""
    code, = objects_of_entries([{'thirds': entry()}], own_target())
    loaded = LoadedObject(code)
    address = loaded.address('thirds')
    assert is_code(address)
    del loaded
    gc.collect()
    assert is_code(address)


def is_code(address: int) -> bool:
    """Return whether this process can run what is there."""
    for line in Path('/proc/self/maps').read_text().splitlines():
        first, _, end = line.split()[0].partition('-')
        if int(first, 16) <= address < int(end, 16):
            return 'x' in line.split()[1]
    return False


@pytest.mark.usefixtures('directory')
def test_an_older_compiler_loads_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """And no process is begun for it."""
    assert can_load()
    monkeypatch.setattr(large_kernels, 'Told', None)
    monkeypatch.setattr(
        loaded_object.llvm, 'create_mcjit_compiler', lambda module, machine: None)
    assert not can_load()
    assert large_kernels.is_large(entry()) and large_kernels.made(entry()) is None
