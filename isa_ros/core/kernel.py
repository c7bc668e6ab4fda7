"""
The decorators of what this package compiles.

Importing a kernel takes no compiler: its machine code is looked up at the first call, in the
libraries of kernels (`kernel_library`), and only a kernel that none of them has is compiled:
a large one by a process of its own (`large_kernels`).
"""

from collections.abc import Callable, Iterable
from functools import cache, cached_property, update_wrapper
import os
from typing import Any, NamedTuple, TypeVar

from isa_ros.core.kernel_directory import CACHE, is_kept
from isa_ros.core.kernel_library import (
    address_in_library, call_in_library, kept_symbol_of, symbol_of)
from isa_ros.core.kinds import Kind, kind_of, TupleKind, UnknownKind
from isa_ros.core.value_text import UnknownValue

_Function = TypeVar('_Function', bound=Callable[..., Any])

# No fastmath: it reorders roundings, and replay compares bytes. No parallel: it may do so, and
# threads over rows are not faster (docs/architecture.md). Functions that a kernel calls are
# inlined: a call costs as much as an equation, and inlining keeps every bit.
OPTIONS: dict[str, Any] = {
    'nogil': True, 'error_model': 'numpy', 'forceinline': True, 'nopython': True,
    'boundscheck': None}
"""What numba compiles kernels with."""

IS_COMPILED = os.environ.get('NUMBA_DISABLE_JIT', '0') in ('', '0')
"""Whether kernels are machine code, and not the functions themselves."""


class Kernel:
    """
    A function that is machine code once it is called.

    Other kernels that call it have it inlined. It has the attributes of its ``compiled`` form.
    """

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]) -> None:
        self.py_func, self.targetoptions = function, options
        self.directory = CACHE
        """Where the compiler keeps it."""
        self._calls: dict[tuple[Kind, ...], Callable[[tuple[Any, ...]], Any]] = {}
        self._call: Callable[..., Any] = self._from_library
        update_wrapper(self, function)

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """Run the machine code."""
        return self._call(*arguments, **named)

    def __getattr__(self, name: str) -> Any:
        """Return what the compiled form has."""
        if name.startswith('__'):
            raise AttributeError(name)
        return getattr(self.compiled, name)

    def __reduce__(self) -> str:
        """Return the name by which another process finds it in its module."""
        return self.py_func.__qualname__

    @cached_property
    def compiled(self) -> Any:
        """Return the kernel as the compiler has it."""
        from isa_ros.core.compiler import dispatcher_of
        return dispatcher_of(self)

    def _from_library(self, *arguments: Any, **named: Any) -> Any:
        """Run what a library has for such arguments; once none has it, it is always compiled."""
        try:
            kinds = tuple(map(kind_of, arguments))
            call = None if named else self._calls.get(kinds) or self._found(kinds)
        except UnknownKind:
            call = None
        if call is None:
            self._call = self.compiled
            return self.compiled(*arguments, **named)
        return call(arguments)

    def _found(self, kinds: tuple[Kind, ...]) -> Callable[[tuple[Any, ...]], Any] | None:
        entry = KernelEntry(self, TupleKind(tuple, kinds), is_called=True)
        call = call_in_library(entry)
        if call is None:
            from isa_ros.core.large_kernels import made
            own = made(entry)
            call = None if own is None else own.call
        if call is not None:
            self._calls[kinds] = call
        return call


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a function for each combination of argument types, and keep that on disk."""
    return Kernel(function, OPTIONS) if IS_COMPILED else function


def part_of_kernel(function: Callable[..., Any]) -> Any:
    """
    Compile a large function together with the only kernel that calls it.

    The compiler optimises all that a kernel calls once for itself and once more for each kernel
    above it. Where the whole tick is in three kernels, one in the other, that doubles the time.
    """
    return Kernel(function, {'inline': 'always', **OPTIONS}) if IS_COMPILED else function


def called_kernel(function: Callable[..., Any]) -> Any:
    """
    Compile a large function that kernels call in several places, and have it called there.

    Inlined it would be optimised once more for each place; the call is nothing to what it does.
    The compiler may still inline it, and every bit is the same.
    """
    return Kernel(function, {**OPTIONS, 'forceinline': False}) if IS_COMPILED else function


def kernel_function(function: _Function) -> _Function:
    """Return a function that Python calls as it is, and kernels as the kernel made of it."""
    if IS_COMPILED:
        setattr(function, 'kernel', kernel(function))   # numba's type refers to it weakly
    return function


class KernelEntry(NamedTuple):
    """A kernel over words, ``int64_t f(const int64_t *table)`` in C: without Python around it."""

    kernel: Any
    kind: Kind
    """Of its memory; of the tuple of its arguments where it is ``called``."""
    is_called: bool = False
    """Words of what it returns are put in front of those of the arguments."""

    @property
    def symbol(self) -> str:
        """Its name in a library."""
        return symbol_of(self.kernel, self._form, self.kind)

    @property
    def kept_symbol(self) -> str:
        """Its name where it is kept: other words around the same code leave it as it is."""
        return kept_symbol_of(self.kernel, self._form, self.kind)

    @property
    def _form(self) -> str:
        return 'called' if self.is_called else 'bound'

    @property
    def compiled(self) -> Any:
        """Return the entry as the compiler has it."""
        from isa_ros.core.compiler import bound_entry, called_entry
        return (called_entry if self.is_called else bound_entry)(self.kernel, self.kind)

    def is_kept(self) -> bool:
        """Return whether it need not be compiled."""
        from isa_ros.core.large_kernels import is_made
        return bool(address_in_library(self)) or is_made(self) or is_kept(self.compiled)

    def address(self) -> int:
        """Return the address of the machine code; it is loaded, or compiled if need be."""
        return entry_address(self)


@cache
def entry_address(entry: KernelEntry) -> int:
    """Return the address of an entry's machine code; once it is known it stays."""
    found = address_in_library(entry)
    if found:
        return found
    from isa_ros.core.large_kernels import made
    own = made(entry)
    if own is not None:
        return own.address
    from isa_ros.core.compiler import address_of
    return address_of(entry)


def entry_of(function: Any, kind: Kind) -> KernelEntry:
    """Return a kernel over a memory of a kind as an entry."""
    return KernelEntry(function, kind)


def symbols_of(entries: Iterable[KernelEntry]) -> tuple[str, ...] | None:
    """Return what entries are now, as they are kept; None: that is not known."""
    try:
        return tuple(entry.kept_symbol for entry in entries)
    except UnknownValue:
        return None
