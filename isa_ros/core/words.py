"""
Values of kernels at an address: how machine code reads words, `kinds`, and writes results.

The functions here are known to the compiler only.
"""

from collections.abc import Iterator
from functools import cache
from typing import Any

from isa_ros.core.kinds import (
    ArrayKind, Kind, NumberKind, RecordKind, RESULT_WORDS, TupleKind, UnknownKind)
import llvmlite.ir as ir
from numba import typeof, types
from numba.core import cgutils
from numba.extending import intrinsic
import numpy as np

TABLE = types.CPointer(types.int64)
"""The words of a value, `isa_ros.core.kinds`, one after the other."""


def _sample(kind: Kind) -> Any:
    """Return a value of a kind."""
    if isinstance(kind, ArrayKind):
        array = np.zeros((4,) * kind.dimensions, kind.dtype)
        array = array[(slice(None, None, 2),) * kind.dimensions] if kind.has_gaps else array
        array.setflags(write=kind.is_writeable)
        return array
    if isinstance(kind, NumberKind):
        return kind.dtype.type(0)
    if isinstance(kind, RecordKind):
        return np.zeros(1, kind.dtype)[0]
    parts = [_sample(part) for part in kind.parts]
    return tuple(parts) if kind.form is tuple else kind.form(*parts)


@cache
def type_of(kind: Kind) -> Any:
    """Return numba's type of a kind."""
    return typeof(_sample(kind))


class _Words:
    """The words of a table, read one after the other."""

    def __init__(self, builder: Any, table: Any, at: int) -> None:
        self._builder, self._table, self._at = builder, table, at

    def take(self) -> Any:
        """Return the next one."""
        self._at += 1
        return self._builder.load(
            cgutils.gep_inbounds(self._builder, self._table, self._at - 1))


def _array(context: Any, builder: Any, kind: Any, words: _Words) -> Any:
    """Return the array whose address, shape and strides come next."""
    from numba.np.arrayobj import make_array, populate_array     # only a compiler needs it
    data = builder.inttoptr(words.take(), context.get_data_type(kind.dtype).as_pointer())
    shape = [words.take() for _ in range(kind.ndim)]
    item = context.get_constant(types.intp, context.get_abi_sizeof(
        context.get_data_type(kind.dtype)))
    strides: list[Any] = []
    stride = item
    for size in reversed(shape):
        strides.insert(0, stride)
        stride = builder.mul(stride, size)
    if kind.layout != 'C':
        strides = [words.take() for _ in shape]
    array = make_array(kind)(context, builder)
    populate_array(array, data=data, shape=shape, strides=strides, itemsize=item, meminfo=None)
    return array._getvalue()


def _number(context: Any, builder: Any, kind: Any, word: Any) -> Any:
    """Return the number whose bits are a word."""
    if kind == types.boolean:
        return builder.icmp_unsigned('!=', word, word.type(0))
    own = context.get_value_type(kind)
    if not isinstance(kind, types.Float):
        return word if own.width == 64 else builder.trunc(word, own)
    number = builder.bitcast(word, ir.DoubleType())
    return number if kind == types.float64 else builder.fptrunc(number, own)


def _value(context: Any, builder: Any, kind: Any, words: _Words) -> Any:
    """Return the value of a kind whose words come next."""
    if isinstance(kind, types.BaseTuple):
        parts: Any = kind
        values = [_value(context, builder, part, words) for part in parts.types]
        return context.make_tuple(builder, kind, values)
    if isinstance(kind, types.Array):
        return _array(context, builder, kind, words)
    if isinstance(kind, types.Record):
        return builder.inttoptr(words.take(), context.get_value_type(kind))
    return _number(context, builder, kind, words.take())


def value_at(kind: Kind, at: int = 0) -> Any:
    """Return what gives kernels the value of a kind whose words are in a `TABLE` from a place."""
    own = type_of(kind)

    def at_table(typing_context: Any, table: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return _value(context, builder, own, _Words(builder, arguments[0], at))
        return own(table), generate
    return intrinsic(at_table)


_NUMBERS = (types.int64, types.uint64, types.float64, types.boolean)
"""Types of results, of 64 bits each."""


def result_kind(own: Any) -> Kind | None:
    """
    Return the kind of what a kernel returns, by numba's type; None: nothing.

    Raises
    ------
    UnknownKind
        It is neither a number nor a tuple of numbers.

    """
    own = types.unliteral(own)
    if own == types.none:
        return None
    if isinstance(own, types.BaseTuple):
        inner: Any = own
        parts = tuple(map(result_kind, inner.types))
        form = inner.instance_class if isinstance(own, types.BaseNamedTuple) else tuple
        if None not in parts:
            return TupleKind(form, parts)   # type: ignore[arg-type]
    if own in _NUMBERS:
        return NumberKind(np.dtype(own.name.replace('boolean', 'bool')))
    raise UnknownKind(str(own))


def _numbers_in(builder: Any, kind: Kind, value: Any) -> Iterator[Any]:
    """Yield the words of a number or of those in a tuple."""
    word = ir.IntType(64)
    if isinstance(kind, TupleKind):
        for k, part in enumerate(kind.parts):
            yield from _numbers_in(builder, part, builder.extract_value(value, k))
    elif kind.dtype.kind == 'f':
        yield builder.bitcast(value, word)
    else:
        yield builder.zext(value, word) if kind.dtype.kind == 'b' else value


def _results(typing_context: Any, table: Any, value: Any) -> Any:
    """
    Return the signature and the generator of `put_results`.

    Raises
    ------
    UnknownKind
        The value is neither a number nor a tuple of at most `RESULT_WORDS` numbers.

    """
    kind = result_kind(value)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        words = [] if kind is None else list(_numbers_in(builder, kind, arguments[1]))
        if len(words) > RESULT_WORDS:
            raise UnknownKind(f'{len(words)} numbers')
        for k, word in enumerate(words):
            builder.store(word, cgutils.gep_inbounds(builder, arguments[0], k))
        return context.get_dummy_value()
    return types.none(table, value), generate


put_results: Any = intrinsic(_results)
"""Of a table and a value: write what a kernel returned to its first words."""
