"""
Large kernels of this package that no library has, as after an edit: lowered by another process.

numba optimises and emits each kernel for itself, and once more for each that has it inlined. A
process that runs none does it once (`isa_ros.core.lowering`) and takes a third of the time; the
machine code gives the same bytes, and its object is kept.
"""

from functools import cache, cached_property
from typing import Any

from isa_ros.core.compilations import compilations
from isa_ros.core.kernel import KernelEntry
from isa_ros.core.kernel_key import kernels_of
from isa_ros.core.kernel_library import Call, is_set_for_numba
from isa_ros.core.value_text import UnknownValue
from isa_ros.errors import ConfigError, RunError

MANY = 40
"""Kernels in one: fewer are compiled in this process before another one has begun."""
PACKAGES = [__name__.partition('.')[0]]
"""Of whose kernels none raises an error of Python, at which an object ends the process."""


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


def is_large(entry: KernelEntry) -> bool:
    """Return whether an entry has so many kernels of this package that a process is worth it."""
    function = entry.kernel.py_func
    if function.__module__.partition('.')[0] not in PACKAGES or is_set_for_numba():
        return False
    try:
        return len(kernels_of(entry.kernel)) >= MANY
    except UnknownValue:
        return False


def is_made(entry: KernelEntry) -> bool:
    """Return whether a large entry need not be made."""
    if not is_large(entry):
        return False
    from isa_ros.core.kept_objects import kept, kept_name
    from isa_ros.core.objects import own_target
    return kept(kept_name({entry.kept_symbol: entry}, own_target())) is not None


@cache
def made(entry: KernelEntry) -> LargeKernel | None:
    """Return a large entry, made now if it is not kept; None: it is for numba to compile."""
    if not is_large(entry):
        return None
    from isa_ros.core.object_making import objects_of_entries
    from isa_ros.core.objects import own_target
    try:
        with _Told(entry.kernel) as told:
            code, = objects_of_entries([{entry.kept_symbol: entry}], own_target(), told)
    except (ConfigError, RunError):
        return None     # it allocates, or the process was ended
    return LargeKernel(entry, code)


class _Told:
    """Tells those who watch of the kernels that the process lowers, and of the end of all."""

    def __init__(self, kernel: Any) -> None:
        self._kernel, self._n_running = kernel, 0

    def __enter__(self) -> '_Told':
        return self

    def __exit__(self, *_: object) -> None:
        while self._n_running:
            self('')

    @cached_property
    def _named(self) -> dict[str, Any]:
        return {own.__name__: own for own in kernels_of(self._kernel)}

    def __call__(self, name: str) -> None:
        """Take a line: the name of a kernel that begins; an empty one as it ends."""
        if name:
            compilations().begin()
            compilations().start(self._named.get(name, self._kernel))
            self._n_running += 1
        else:
            compilations().end()
            self._n_running -= 1
