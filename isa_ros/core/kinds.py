"""
Kinds of arguments: what machine code is made for, and the words that it gets of a value.

A word has 64 bits. An array is its address and shape, and its strides where it has gaps; a
record its address; a number its bits; a tuple the words of its parts.
"""

from collections.abc import Iterator
from functools import cache
import struct
from typing import Any, NamedTuple

from isa_ros.core.kernel_key import class_text, dtype_text
import numpy as np

RESULT_WORDS = 17
"""Words in front of those of arguments, for what a kernel returns: a count, and two for each."""
NOTHING, ONE = -2, -1
"""Counts of what a kernel returns, if that is nothing or a number; others are of tuples."""
_WORD, _FLOAT = struct.Struct('q'), struct.Struct('d')
_LARGEST = 2 ** 63
_NUMBERS = {float: np.dtype(np.float64), int: np.dtype(np.int64), bool: np.dtype(np.bool_)}


class UnknownKind(Exception):
    """Words cannot stand for a value: a text, a list, an enumeration, a number beyond 64 bits."""


class ArrayKind(NamedTuple):
    """Of an array."""

    dtype: np.dtype[Any]
    dimensions: int
    has_gaps: bool
    """It is not C-contiguous."""
    is_writeable: bool


class NumberKind(NamedTuple):
    """Of a number or truth value."""

    dtype: np.dtype[Any]


class RecordKind(NamedTuple):
    """Of one row of an array of records."""

    dtype: np.dtype[Any]


class TupleKind(NamedTuple):
    """Of a tuple, named or not."""

    form: type
    parts: 'tuple[Kind, ...]'


Kind = ArrayKind | NumberKind | RecordKind | TupleKind


def kind_of(value: Any) -> Kind:
    """
    Return the kind of a value.

    Raises
    ------
    UnknownKind
        It has none.

    """
    if isinstance(value, np.ndarray):
        flags = value.flags
        return ArrayKind(value.dtype, value.ndim, not flags.c_contiguous, flags.writeable)
    number = _NUMBERS.get(type(value))
    if number is not None and -_LARGEST <= value < _LARGEST:
        return NumberKind(number)
    if isinstance(value, np.void):
        return RecordKind(value.dtype)
    if isinstance(value, tuple):
        return TupleKind(type(value), tuple(map(kind_of, value)))
    if isinstance(value, np.number | np.bool_) and value.dtype.kind in 'biuf':
        return NumberKind(value.dtype)
    raise UnknownKind(type(value).__name__)


@cache
def kind_text(kind: Kind) -> str:
    """Return a kind as a text, equal for equal kinds only."""
    if isinstance(kind, TupleKind):
        return f'{class_text(kind.form)}({",".join(map(kind_text, kind.parts))})'
    rest = ''.join(f' {value}' for value in kind[1:])
    return f'{type(kind).__name__} {dtype_text(kind.dtype)}{rest}'


def words_of(value: Any) -> Iterator[int]:
    """Yield the words of a value that has a kind."""
    if isinstance(value, np.ndarray):
        yield value.ctypes.data
        yield from value.shape
        if not value.flags.c_contiguous:
            yield from value.strides
    elif isinstance(value, np.void):
        yield value.__array_interface__['data'][0]
    elif isinstance(value, tuple):
        for part in value:
            yield from words_of(part)
    elif isinstance(value, float | np.floating):
        yield from _WORD.unpack(_FLOAT.pack(value))
    else:
        yield int(value)
