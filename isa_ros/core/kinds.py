"""
Kinds of values: what machine code is made for, and the words that it gets and gives of them.

A word has 64 bits. An array is its address and shape, and its strides where it has gaps; a
record its address; a number its bits; a tuple the words of its parts.
"""

from collections.abc import Hashable, Iterator
from functools import cache
from importlib import import_module
import struct
from typing import Any, NamedTuple

from isa_ros.core.value_text import class_text, dtype_text
import numpy as np

RESULT_WORDS = 32
"""Words in front of those of arguments, for what a kernel returns."""
_WORD, _FLOAT = struct.Struct('q'), struct.Struct('d')
_LARGEST = 2 ** 63


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
_NUMBERS = {own: NumberKind(np.dtype(own)) for own in (float, int, bool)}


def kind_of(value: Any) -> Kind:
    """
    Return the kind of a value; the most frequent ones come first.

    Raises
    ------
    UnknownKind
        It has none.

    """
    number = _NUMBERS.get(type(value))
    if number is not None:
        if -_LARGEST <= value < _LARGEST:
            return number
    elif isinstance(value, np.void):
        return _of_record(value.dtype, type(value))     # type: ignore[arg-type]  # a class
    elif isinstance(value, np.ndarray):
        flags, own = value.flags, value.dtype
        return _of_array(own, own.type, value.ndim, not flags.c_contiguous, flags.writeable)
    elif isinstance(value, tuple):
        return TupleKind(type(value), tuple(map(kind_of, value)))
    elif isinstance(value, np.number | np.bool_) and value.dtype.kind in 'biuf':
        return NumberKind(value.dtype)
    raise UnknownKind(type(value).__name__)


_record, _array = cache(RecordKind), cache(ArrayKind)


@cache
def _of_record(dtype: np.dtype[Any], form: Hashable) -> RecordKind:
    """
    Return the kind of a row.

    Types that are equal and have rows of different classes are apart in this cache, as comparing
    them takes longer than a kernel; their kind is the same one.
    """
    return _record(dtype)


@cache
def _of_array(dtype: np.dtype[Any], form: Hashable, *rest: Any) -> ArrayKind:
    """Return the kind of an array, as `_of_record`."""
    return _array(dtype, *rest)


@cache
def kind_text(kind: Kind) -> str:
    """Return a kind as a text, equal for equal kinds only."""
    if isinstance(kind, TupleKind):
        return f'{class_text(kind.form)}({",".join(map(kind_text, kind.parts))})'
    rest = ''.join(f' {value}' for value in kind[1:])
    return f'{type(kind).__name__} {dtype_text(kind.dtype)}{rest}'


def words_of(value: Any) -> list[int]:
    """Return the words of a value that has a kind, as whole numbers with sign."""
    words: list[int] = []
    _append(words, value)
    return words


def _append(words: list[int], value: Any) -> None:
    """Append the words of a value; the most frequent kinds come first."""
    if isinstance(value, float):    # numpy's too
        words += _WORD.unpack(_FLOAT.pack(value))
    elif isinstance(value, np.ndarray):
        words.append(value.ctypes.data)
        words += value.shape
        if not value.flags.c_contiguous:
            words += value.strides
    elif isinstance(value, np.void):    # its interface lists all fields, and has a copy's address
        words.append(np.frombuffer(value, np.uint8).ctypes.data)
    elif isinstance(value, tuple):
        for part in value:
            _append(words, part)
    elif isinstance(value, np.floating):
        words += _WORD.unpack(_FLOAT.pack(value))
    else:
        number = int(value)
        words.append(number if number < _LARGEST else number - 2 * _LARGEST)


def value_of(kind: Kind, words: Iterator[int]) -> Any:
    """Return the number or tuple of a kind whose words, as whole numbers with sign, come next."""
    if isinstance(kind, TupleKind):
        values = [value_of(part, words) for part in kind.parts]
        return tuple(values) if kind.form is tuple else kind.form(*values)
    word = next(words)
    form = kind.dtype.kind
    if form == 'f':
        return _FLOAT.unpack(_WORD.pack(word))[0]
    return bool(word) if form == 'b' else word % (1 << 64) if form == 'u' else word


def result_form(kind: Kind | None) -> Any:
    """Return the kind of a result as JSON has it; `kind_of_form` is the inverse."""
    if isinstance(kind, TupleKind):
        name = '' if kind.form is tuple else f'{kind.form.__module__}:{kind.form.__name__}'
        return [name, *map(result_form, kind.parts)]
    return None if kind is None else kind.dtype.str


def kind_of_form(form: Any) -> Any:
    """Return the kind of a result, None: of nothing."""
    if isinstance(form, list):
        module, _, name = form[0].partition(':')
        own = getattr(import_module(module), name) if name else tuple
        return TupleKind(own, tuple(map(kind_of_form, form[1:])))
    return None if form is None else NumberKind(np.dtype(form))
