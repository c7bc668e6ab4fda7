"""Kinds of values, their words, and what kernels return."""

import ctypes
from typing import NamedTuple

from isa_ros.core.kinds import (
    ArrayKind, kind_of, kind_of_form, kind_text, NumberKind, RecordKind, result_form, TupleKind,
    UnknownKind, value_of, words_of)
from isa_ros.core.record import attributed, row_record
import numpy as np
import pytest

F8, I8, U8, B1 = (NumberKind(np.dtype(name)) for name in ('f8', 'i8', 'u8', '?'))
MASS = np.dtype([('x', 'f8'), ('n', 'i4')])


class Pair(NamedTuple):
    """Two numbers."""

    size: float
    count: int


class Other(NamedTuple):
    """Two numbers of the same types."""

    size: float
    count: int


def frozen(array):
    """Return an array that cannot be written."""
    array.setflags(write=False)
    return array


@pytest.mark.parametrize(('value', 'kind'), [
    (1.5, F8), (7, I8), (True, B1), (-2 ** 63, I8), (np.uint64(5), U8),
    (np.float32(1.0), NumberKind(np.dtype('f4'))), (np.zeros(3, MASS)[1], RecordKind(MASS)),
    (np.zeros((2, 3)), ArrayKind(np.dtype('f8'), 2, False, True)),
    (np.zeros(4)[::2], ArrayKind(np.dtype('f8'), 1, True, True)),
    (frozen(np.zeros(4, 'i4')), ArrayKind(np.dtype('i4'), 1, False, False)),
    ((1, 2.0), TupleKind(tuple, (I8, F8))), (Pair(1.0, 2), TupleKind(Pair, (F8, I8)))])
def test_kind(value, kind):
    assert kind_of(value) == kind


def test_a_row_is_of_one_kind_whatever_its_class():
    """Not only of an equal one: a kernel's machine code is looked up by it at each call."""
    rows = np.zeros(2, MASS)
    kinds = [kind_of(row) for row in (rows[0], row_record(rows), rows.view(np.recarray)[0])]
    assert kinds[0] is kinds[1] is kinds[2]
    arrays = [kind_of(own) for own in (rows, rows.view(attributed(MASS)))]
    assert arrays[0] is arrays[1] and arrays[0] is not kind_of(rows[::-1])


@pytest.mark.parametrize('value', ['text', [1], None, 2 ** 63, -2 ** 63 - 1, 1j, ('a',)])
def test_what_has_no_kind(value):
    with pytest.raises(UnknownKind):
        kind_of(value)


def test_texts_of_other_kinds_are_others():
    values = (1.5, 7, True, np.uint64(5), np.zeros(1, MASS)[0], np.zeros(1, MASS), np.zeros(2),
              np.zeros((2, 2)), np.zeros(4)[::2], frozen(np.zeros(2)), (1, 2.0), (2.0, 1),
              Pair(1.0, 2), Other(1.0, 2), ((1, 2.0),))
    texts = {kind_text(kind_of(value)) for value in values}
    assert len(texts) == len(values)
    assert kind_text(kind_of(np.ones(5))) == kind_text(kind_of(np.zeros(2)))


def test_words_of_arrays_and_records():
    array = np.zeros((2, 3))
    assert words_of(array) == [array.ctypes.data, 2, 3]
    assert words_of(array[:, ::2]) == [array.ctypes.data, 2, 2, 24, 16]
    rows = np.zeros(3, MASS)
    assert words_of(rows[2]) == [rows.ctypes.data + 2 * MASS.itemsize]
    own = rows[2].copy()
    own['x'] = 6.5
    address, = words_of(own)
    assert ctypes.c_double.from_address(address).value == 6.5
    ctypes.c_double.from_address(address).value = 8.5
    assert own['x'] == 8.5
    assert words_of((rows, (7, True))) == [rows.ctypes.data, 3, 7, 1]


@pytest.mark.parametrize(('kind', 'value'), [
    (F8, -0.1), (I8, -9), (B1, True),
    (TupleKind(tuple, (I8, TupleKind(Pair, (F8, I8)), B1)), (3, Pair(2.5, -4), False))])
def test_values_come_back_from_their_words(kind, value):
    found = value_of(kind, iter(words_of(value)))
    assert found == value and type(found) is type(value)


def test_large_numbers_without_sign_are_words_with_one():
    assert value_of(U8, iter([-1])) == 2 ** 64 - 1
    assert words_of(np.uint64(2 ** 64 - 1)) == [-1] and words_of(np.uint64(7)) == [7]
    assert words_of((np.uint64(2 ** 63), 2 ** 63 - 1, np.int8(-3))) == [-2 ** 63, 2 ** 63 - 1, -3]
    assert words_of(np.float32(-0.5)) == words_of(-0.5) == words_of(np.float64(-0.5))


@pytest.mark.parametrize(('kind', 'form'), [
    (None, None), (F8, '<f8'), (TupleKind(tuple, (I8, B1)), ['', '<i8', '|b1']),
    (TupleKind(Pair, (F8, TupleKind(tuple, ()))), [f'{__name__}:Pair', '<f8', ['']])])
def test_forms_of_results(kind, form):
    assert result_form(kind) == form
    assert kind_of_form(form) == kind
