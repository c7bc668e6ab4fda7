"""
What numba has no words for: arrays at an address, and calls of machine code or of C at one.

The functions here are known to the compiler only.
"""

from typing import Any

import llvmlite.ir as ir
from numba import typeof, types
from numba.core import cgutils
from numba.extending import intrinsic

TABLE = types.CPointer(types.int64)
"""Address and shape of every array, one after the other."""


def kind_of(memory: Any) -> Any:
    """Return numba's type of a memory."""
    return typeof(memory)


def _array(context: Any, builder: Any, kind: Any, table: Any, at: int) -> tuple[Any, int]:
    """Return the array of a kind whose address is at a place of the table, and the next place."""
    from numba.np.arrayobj import make_array, populate_array     # only a compiler needs it
    words = [builder.load(cgutils.gep_inbounds(builder, table, at + k))
             for k in range(1 + kind.ndim)]
    data = builder.inttoptr(words[0], context.get_data_type(kind.dtype).as_pointer())
    item = context.get_constant(types.intp, context.get_abi_sizeof(
        context.get_data_type(kind.dtype)))
    strides: list[Any] = []
    stride = item
    for size in reversed(words[1:]):
        strides.insert(0, stride)
        stride = builder.mul(stride, size)
    array = make_array(kind)(context, builder)
    populate_array(array, data=data, shape=words[1:], strides=strides, itemsize=item,
                   meminfo=None)
    return array._getvalue(), at + len(words)


def _memory(context: Any, builder: Any, kind: Any, table: Any, at: int) -> tuple[Any, int]:
    """Return the tuple of a kind whose arrays are in the table from a place on."""
    values = []
    for part in kind.types:
        make = _memory if isinstance(part, types.BaseTuple) else _array
        value, at = make(context, builder, part, table, at)
        values.append(value)
    return context.make_tuple(builder, kind, values), at


def memory_at(kind: Any) -> Any:
    """Return what gives kernels the memory of a kind that a `TABLE` describes."""
    def at_table(typing_context: Any, table: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return _memory(context, builder, kind, arguments[0], 0)[0]
        return kind(table), generate
    return intrinsic(at_table)


def _called_at(typing_context: Any, address: Any, table: Any) -> Any:
    """Return the signature and the generator of `call_at`."""
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        called = ir.FunctionType(ir.IntType(64), [ir.IntType(64)])
        return builder.call(builder.inttoptr(arguments[0], called.as_pointer()), arguments[1:])
    return types.int64(address, table), generate


call_at: Any = intrinsic(_called_at)
"""Of an address and that of a table: what the machine code at the address returns for it."""


def _call_of_c(
        typing_context: Any, address: Any, first: Any, second: Any, third: Any,
        fourth: Any) -> Any:
    """Return the signature and the generator of `call_c`."""
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        called = ir.FunctionType(ir.IntType(64), [ir.IntType(64)] * 4)
        return builder.call(builder.inttoptr(arguments[0], called.as_pointer()), arguments[1:])
    return types.int64(*[types.int64] * 5), generate


call_c: Any = intrinsic(_call_of_c)
"""Of the address of a C function and four whole numbers or addresses: what the function returns.

A function with fewer arguments ignores the rest, one of `int` takes the lower half of each. The
upper half of a result of type `int` is undefined.
"""
