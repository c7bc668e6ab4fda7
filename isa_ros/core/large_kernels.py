"""
Large kernels of this package that no library has, as after an edit: lowered by another process.

numba optimises and emits each kernel for itself, and once more for each that has it inlined. A
process that runs none does it once (`isa_ros.core.lowering`), in two fifths of the time; the
machine code gives the same bytes, and its object is kept.
"""

from collections.abc import Iterable
import dis
from functools import cache, cached_property
import os
from threading import RLock
from types import FunctionType
from typing import Any

from isa_ros.core.compilations import compilations
from isa_ros.core.kernel import KernelEntry
from isa_ros.core.kernel_directory import is_kept
from isa_ros.core.kernel_key import functions_of, is_unchanged, kernels_of
from isa_ros.core.kernel_library import Call, is_set_for_numba
from isa_ros.core.value_text import UnknownValue
from isa_ros.errors import ConfigError, RunError

MANY = 25
"""Kernels in one: fewer are compiled in this process before another one has begun."""
PACKAGES = [__name__.partition('.')[0]]
"""Whose kernels may be lowered."""
_RAISE = dis.opmap['RAISE_VARARGS']
_making = RLock()


def _make_anew() -> None:
    """Wait for no thread of the process of which this one is a copy."""
    global _making
    _making = RLock()


os.register_at_fork(after_in_child=_make_anew)


class LargeKernel:
    """The machine code of an entry."""

    def __init__(self, entry: KernelEntry, code: bytes) -> None:
        from isa_ros.core.loaded_object import LoadedObject
        self._symbol, self._code = entry.kept_symbol, LoadedObject(code)

    @property
    def address(self) -> int:
        """Return its address."""
        return self._code.address(self._symbol)

    @property
    def call(self) -> Call:
        """Return what calls it with its arguments."""
        return self._code.call(self._symbol)


def leave_to_numba() -> None:
    """Let this process begin no other one: it is one."""
    PACKAGES.clear()


def is_large(entry: KernelEntry) -> bool:
    """
    Return whether an entry has so many kernels of this package that a process is worth it.

    None that raises an error of Python: an object ends the process there. Nor a part of another
    one with its arguments: their types are found by numba, which compiles no part by itself.
    """
    package = entry.kernel.py_func.__module__.partition('.')[0]
    if package not in PACKAGES or is_set_for_numba():
        return False
    if entry.is_called and 'inline' in entry.kernel.targetoptions:
        return False
    try:
        entry.kept_symbol   # it can be kept
        return len(kernels_of(entry.kernel)) >= MANY and not _raises(functions_of(entry.kernel))
    except UnknownValue:
        return False


def _raises(functions: Iterable[FunctionType]) -> bool:
    """Return whether one has a ``raise`` or an ``assert``."""
    return any(_RAISE in own.__code__.co_code[::2] for own in functions)


def is_made(entry: KernelEntry) -> bool:
    """Return whether a large entry need not be made."""
    if not is_large(entry):
        return False
    from isa_ros.core.kept_objects import kept, object_name
    from isa_ros.core.objects import own_target
    try:
        return kept(object_name({entry.kept_symbol: entry}, own_target())) is not None
    except ConfigError:
        return False    # no object can be made for this processor


def made(entry: KernelEntry) -> LargeKernel | None:
    """
    Return a large entry, made now if it is not kept; None: it is for numba to compile.

    So it is where numba has kept it, where a process is of no use, and where values that its
    kernels name are no longer those of the sources.
    """
    with _making:   # by one thread
        return _made(entry)


@cache
def _made(entry: KernelEntry) -> LargeKernel | None:
    if not is_large(entry):
        return None
    if not is_made(entry) and (_is_kept_by_numba(entry) or not is_unchanged(entry.kernel)):
        return None
    from isa_ros.core.loaded_object import can_load
    from isa_ros.core.object_making import objects_of_entries
    from isa_ros.core.objects import own_target
    if not can_load():
        return None
    try:
        with Told(entry.kernel) as told:
            code, = objects_of_entries([{entry.kept_symbol: entry}], own_target(), told)
    except (ConfigError, RunError):
        return None     # it allocates, or the process was ended
    return LargeKernel(entry, code)


def _is_kept_by_numba(entry: KernelEntry) -> bool:
    """Return whether numba has compiled it before: a called one without an entry around it."""
    return is_kept(entry.kernel.compiled if entry.is_called else entry.compiled)


class Told:
    """
    Tells those who watch of the kernels that the process lowers, each once, and of the end of all.

    What else it lowers, such as the entry itself, is no kernel to them.
    """

    def __init__(self, kernel: Any) -> None:
        self._kernel = kernel
        self._running: list[bool] = []
        """Whether those who watch know of it, the innermost last."""

    def __enter__(self) -> 'Told':
        return self

    def __exit__(self, *_: object) -> None:
        while self._running:
            self('')

    @cached_property
    def _untold(self) -> dict[str, Any]:
        """Return the kernels of which nothing was told yet, by name."""
        return {own.__name__: own for own in kernels_of(self._kernel)}

    def __call__(self, name: str) -> None:
        """Take a line: the name of a kernel that begins; an empty one as it ends."""
        if name:
            kernel = self._untold.pop(name, None)
            self._running.append(kernel is not None)
            if kernel is not None:
                compilations().begin()
                compilations().start(kernel)
        elif self._running.pop():
            compilations().end()
