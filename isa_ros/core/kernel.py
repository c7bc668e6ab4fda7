"""The decorators of what this package compiles."""

from collections.abc import Callable
from functools import cache
from typing import Any, TypeVar

from isa_ros.core.kernel_cache import CACHE, cache_of
from isa_ros.core.pointers import memory_at, TABLE
import numba
from numba import types
from numba.core.registry import cpu_target

_Function = TypeVar('_Function', bound=Callable[..., Any])

# No fastmath: it reorders roundings, and replay compares bytes. No parallel: it may do so, and
# threads over rows are not faster (docs/architecture.md). Functions that a kernel calls are
# inlined: a call costs as much as an equation, and inlining keeps every bit.
_OPTIONS: dict[str, Any] = {'nogil': True, 'error_model': 'numpy', 'forceinline': True}


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a function for each combination of argument types, and keep that on disk."""
    return _kept(numba.njit(**_OPTIONS)(function))


def part_of_kernel(function: Callable[..., Any]) -> Any:
    """
    Compile a large function together with the only kernel that calls it.

    The compiler optimises all that a kernel calls once for itself and once more for each kernel
    above it. Where the whole tick is in three kernels, one in the other, that doubles the time.
    """
    return _kept(numba.njit(inline='always', **_OPTIONS)(function))


def _kept(compiled: Any) -> Any:
    if hasattr(compiled, 'py_func'):    # with NUMBA_DISABLE_JIT it is the function
        compiled._cache = cache_of(compiled, CACHE)
    return compiled


def kernel_function(function: _Function) -> _Function:
    """Return a function that Python calls as it is, and kernels as the kernel made of it."""
    compiled = kernel(function)
    if compiled is not function:
        setattr(function, 'kernel', compiled)   # numba's type refers to it weakly
        cpu_target.typing_context.insert_global(function, types.Dispatcher(compiled))
    return function


IS_COMPILED = not numba.config.DISABLE_JIT  # type: ignore[attr-defined]
"""Whether kernels are machine code, and not the functions themselves."""


@cache
def entry_of(function: Any, kind: Any) -> Any:
    """
    Return a kernel over a memory of a ``kind`` as one over the `TABLE` of its arrays.

    It is compiled by `address_of`, and then has the signature ``int64_t f(const int64_t *table)``
    of C.
    """
    memory = memory_at(kind)

    def entry(table: Any) -> Any:
        return function(memory(table))
    entry.__qualname__ = function.__qualname__
    entry.__module__ = function.__module__
    return _kept(numba.njit(**_OPTIONS)(entry))


def compiled_entry(entry: Any) -> Any:
    """Return the compiled version of an entry; it is compiled or loaded if need be."""
    entry.compile((TABLE,))
    made, = entry.overloads.values()
    return made


@cache
def address_of(entry: Any) -> int:
    """Return the address of an entry's machine code; it is compiled or loaded if need be."""
    made = compiled_entry(entry)
    address: int = made.library.get_pointer_to_function(made.fndesc.llvm_cfunc_wrapper_name)
    return address
