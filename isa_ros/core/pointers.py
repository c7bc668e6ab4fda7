"""
What numba has no words for: calls of machine code or of C at an address.

Functions that the compiler alone knows are declared here, and made when it asks for them: a
module whose kernels call one is imported without the compiler.
"""

from collections.abc import Callable
from functools import cached_property
from typing import Any


class Intrinsic:
    """A function of the compiler: its definition returns a signature and what generates code."""

    def __init__(self, definition: Callable[..., Any]) -> None:
        self._defn = definition     # as numba names it

    @cached_property
    def _numba_type_(self) -> Any:
        """Return the type by which numba finds it."""
        from numba.core.registry import cpu_target
        from numba.extending import intrinsic
        typing = cpu_target.typing_context
        own = intrinsic(self._defn)
        typing.refresh()
        return typing.resolve_value_type(own)


def _called_at(typing_context: Any, address: Any, table: Any) -> Any:
    """Return the signature and the generator of `call_at`."""
    import llvmlite.ir as ir
    from numba import types

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        called = ir.FunctionType(ir.IntType(64), [ir.IntType(64)])
        return builder.call(builder.inttoptr(arguments[0], called.as_pointer()), arguments[1:])
    return types.int64(address, table), generate


call_at: Any = Intrinsic(_called_at)
"""Of an address and that of a table: what the machine code at the address returns for it."""


def _call_of_c(
        typing_context: Any, address: Any, first: Any, second: Any, third: Any, fourth: Any,
        fifth: Any) -> Any:
    """Return the signature and the generator of `call_c`."""
    import llvmlite.ir as ir
    from numba import types

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        called = ir.FunctionType(ir.IntType(64), [ir.IntType(64)] * 5)
        return builder.call(builder.inttoptr(arguments[0], called.as_pointer()), arguments[1:])
    return types.int64(*[types.int64] * 6), generate


call_c: Any = Intrinsic(_call_of_c)
"""Of the address of a C function and five whole numbers or addresses: what the function returns.

A function with fewer arguments ignores the rest, one of `int` takes the lower half of each. The
upper half of a result of type `int` is undefined.
"""


def _loaded_at(typing_context: Any, address: Any) -> Any:
    """Return the signature and the generator of `load_at`."""
    import llvmlite.ir as ir
    from numba import types

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        number = builder.inttoptr(arguments[0], ir.IntType(32).as_pointer())
        return builder.sext(builder.load_atomic(number, 'acquire', 4), ir.IntType(64))
    return types.int64(types.int64), generate


load_at: Any = Intrinsic(_loaded_at)
"""The whole number of 4 bytes at an address: what was written before it is seen after it."""


def _added_at(typing_context: Any, address: Any, added: Any) -> Any:
    """Return the signature and the generator of `add_at`."""
    import llvmlite.ir as ir
    from numba import types

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        number = builder.inttoptr(arguments[0], ir.IntType(32).as_pointer())
        added = builder.trunc(arguments[1], ir.IntType(32))
        before = builder.atomic_rmw('add', number, added, 'seq_cst')
        return builder.add(builder.sext(before, ir.IntType(64)), arguments[1])
    return types.int64(types.int64, types.int64), generate


add_at: Any = Intrinsic(_added_at)
"""Add to the whole number of 4 bytes at an address at once, also for others; return the sum."""
