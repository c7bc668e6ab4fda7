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
        typing_context: Any, address: Any, first: Any, second: Any, third: Any,
        fourth: Any) -> Any:
    """Return the signature and the generator of `call_c`."""
    import llvmlite.ir as ir
    from numba import types

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        called = ir.FunctionType(ir.IntType(64), [ir.IntType(64)] * 4)
        return builder.call(builder.inttoptr(arguments[0], called.as_pointer()), arguments[1:])
    return types.int64(*[types.int64] * 5), generate


call_c: Any = Intrinsic(_call_of_c)
"""Of the address of a C function and four whole numbers or addresses: what the function returns.

A function with fewer arguments ignores the rest, one of `int` takes the lower half of each. The
upper half of a result of type `int` is undefined.
"""
