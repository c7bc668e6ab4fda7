"""
Large kernels of this package that no library has, as after an edit: lowered by another process.

numba optimises and emits each kernel for itself, and once more for each that has it inlined. A
process that runs none does it once (`isa_ros.core.lowering`), in two fifths of the time; the
machine code gives the same bytes, and its object is kept.
"""

from collections.abc import Iterable
import dis
from functools import cache, cached_property
from threading import RLock
from typing import Any

from isa_ros.core.compilations import compilations
from isa_ros.core.kernel import KernelEntry
from isa_ros.core.kernel_directory import is_kept
from isa_ros.core.kernel_key import is_unchanged, kernels_of
from isa_ros.core.kernel_library import Call, is_set_for_numba
from isa_ros.core.value_text import UnknownValue
from isa_ros.errors import ConfigError, RunError

MANY = 40
"""Kernels in one: fewer are compiled in this process before another one has begun."""
PACKAGES = [__name__.partition('.')[0]]
"""Whose kernels may be lowered."""
_RAISE = dis.opmap['RAISE_VARARGS']
_MAKING = RLock()


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
    """
    Return whether an entry has so many kernels of this package that a process is worth it.

    None that raises an error of Python: an object ends the process there. Nor a part of another
    one, which no entry can call.
    """
    package = entry.kernel.py_func.__module__.partition('.')[0]
    if package not in PACKAGES or 'inline' in entry.kernel.targetoptions or is_set_for_numba():
        return False
    try:
        kernels = kernels_of(entry.kernel)
    except UnknownValue:
        return False
    return len(kernels) >= MANY and not _raises(kernels)


def _raises(kernels: Iterable[Any]) -> bool:
    """Return whether one has a ``raise`` or an ``assert``."""
    return any(_RAISE in own.py_func.__code__.co_code[::2] for own in kernels)


def is_made(entry: KernelEntry) -> bool:
    """Return whether a large entry need not be made."""
    if not is_large(entry):
        return False
    from isa_ros.core.kept_objects import kept, kept_name
    from isa_ros.core.objects import own_target
    try:
        return kept(kept_name({entry.kept_symbol: entry}, own_target())) is not None
    except ConfigError:
        return False    # no object can be made for this processor


def made(entry: KernelEntry) -> LargeKernel | None:
    """
    Return a large entry, made now if it is not kept; None: it is for numba to compile.

    So it is where numba has kept it, where a process is of no use, and where values that its
    kernels name are no longer those of the sources.
    """
    with _MAKING:   # by one thread
        return _made(entry)


@cache
def _made(entry: KernelEntry) -> LargeKernel | None:
    if not is_large(entry):
        return None
    if not is_made(entry) and (is_kept(entry.compiled) or not is_unchanged(entry.kernel)):
        return None
    from isa_ros.core.object_making import objects_of_entries
    from isa_ros.core.objects import own_target
    try:
        with Told(entry.kernel) as told:
            code, = objects_of_entries([{entry.kept_symbol: entry}], own_target(), told)
    except (ConfigError, RunError):
        return None     # it allocates, or the process was ended
    return LargeKernel(entry, code)


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
