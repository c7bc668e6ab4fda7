"""Large kernels of tests, which no library has, by machine code that a process has lowered."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
import ctypes
from functools import cache
from pathlib import Path
import tempfile
from typing import Any
from unittest.mock import patch

from isa_ros.core import kernel
from isa_ros.core.kernel import KernelEntry
from isa_ros.core.kernel_key import kernels_of
from isa_ros.core.kernel_library import Call, call_in
from isa_ros.core.objects import library_of, own_target
from isa_ros.export.kernels import objects_of_entries

MANY = 40
"""Kernels in one: fewer are compiled in this process before another one has begun."""


@contextmanager
def large_kernels_lowered() -> Iterator[None]:
    """Have large kernels that Python calls lowered, in half of the time of numba."""
    before = kernel.call_in_library

    def call_of(entry: KernelEntry) -> Callable[[tuple[Any, ...]], Any] | None:
        return before(entry) or (_call_of(entry) if is_large(entry) else None)
    with patch.object(kernel, 'call_in_library', call_of):
        yield


def is_large(entry: KernelEntry) -> bool:
    """Return whether a kernel has so many that a process is worth it."""
    return len(kernels_of(entry.kernel)) >= MANY


@cache
def _call_of(entry: KernelEntry) -> Call:
    """Return what calls an entry; its library is loaded until this process ends."""
    code, = objects_of_entries([{entry.symbol: entry}], own_target())
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory, f'{entry.symbol}.so')
        library_of([code], path)
        return call_in(ctypes.CDLL(str(path)), entry.symbol)
