"""Kernels as numba has them: what is imported only where something is compiled."""

from functools import cache
from types import FunctionType
from typing import Any

from isa_ros.core.compilations import compilations
from isa_ros.core.kernel import Kernel, kernel, KernelEntry
from isa_ros.core.kernel_cache import cache_of
from isa_ros.core.kinds import Kind, RESULT_WORDS
from isa_ros.core.words import put_results, result_kind, TABLE, type_of, value_at
import numba
from numba import types
from numba.extending import typeof_impl


@typeof_impl.register(FunctionType)
def _type_of_function(function: Any, context: Any) -> Any:
    """Return the type by which numba finds the kernel of a function that Python calls too."""
    own = getattr(function, 'kernel', None)
    return types.Dispatcher(own.compiled) if isinstance(own, Kernel) else None


def dispatcher_of(own: Kernel) -> Any:
    """Return what numba compiles of a kernel."""
    compilations().begin()
    options = {name: value for name, value in own.targetoptions.items() if name != 'nopython'}
    compiled: Any = numba.njit(**options)(own.py_func)
    compiled._cache = cache_of(compiled, own.directory)
    return compiled


@cache
def bound_entry(function: Any, kind: Kind) -> Any:
    """
    Return a kernel over a memory of a ``kind`` as one over the `TABLE` of its arrays.

    It is compiled by `compiled_entry`, and then has the signature
    ``int64_t f(const int64_t *table)`` of C.
    """
    memory = value_at(kind)

    def entry(table: Any) -> Any:
        return function(memory(table))
    return _named(entry, function)


@cache
def called_entry(function: Any, kind: Kind) -> Any:
    """Return a kernel as one over the `TABLE` of results and arguments of the kinds of a tuple."""
    given = value_at(kind, RESULT_WORDS)

    def entry(table: Any) -> Any:
        put_results(table, function(*given(table)))
        return 0
    return _named(entry, function)


def _named(entry: Any, function: Any) -> Any:
    """Return an entry as a kernel with the name of the function that it calls."""
    entry.__qualname__, entry.__module__ = function.__qualname__, function.__module__
    return kernel(entry)


def compiled_entry(entry: KernelEntry) -> Any:
    """Return the compiled version of an entry; it is compiled or loaded if need be."""
    compiled = entry.compiled
    if not compiled.overloads:
        compiled.compile((TABLE,))
    made, = compiled.overloads.values()
    return made


def result_of(entry: KernelEntry) -> Kind | None:
    """Return the kind of what the kernel of a called entry returns, None: nothing."""
    own = entry.kernel.compiled
    given = tuple(type_of(entry.kind).types)
    left_out = own.py_func.__code__.co_argcount - len(given)
    given += tuple(map(types.Omitted, (own.py_func.__defaults__ or ())[-left_out:][:left_out]))
    own.compile(given)
    return result_kind(own.overloads[given].signature.return_type)


def address_of(entry: KernelEntry) -> int:
    """Return the address of an entry's machine code."""
    made = compiled_entry(entry)
    address: int = made.library.get_pointer_to_function(made.fndesc.llvm_cfunc_wrapper_name)
    return address
