"""Records are filled by name, all of their fields and no others."""

import copy
import pickle

from isa_ros.core.record import attributed, floats, Record, record, row_record, rows_of
import numpy as np
import pytest

POINT = np.dtype([('x', 'f8'), ('y', 'f8')])
SIZE = np.dtype([('width', 'f8'), ('height', 'f8')])
BOX = np.dtype([('corner', POINT), ('kind', 'i8'), ('table', 'f8', (3,))])


def test_the_order_of_the_names_does_not_matter():
    """A value goes where its name is in the memory, whatever the order of the arguments."""
    row = record(POINT, y=2.0, x=1.0)
    assert row.tobytes() == np.array([1.0, 2.0]).tobytes()
    assert (row.x, row.y) == (1.0, 2.0)


def test_nested_records_and_tables_are_filled():
    """A record within a record keeps its attributes."""
    row = record(BOX, kind=7, table=np.arange(3.0), corner=record(POINT, x=1.0, y=2.0))
    assert (row.corner.y, row.kind, row.table.tolist()) == (2.0, 7, [0.0, 1.0, 2.0])


@pytest.mark.parametrize(('fields', 'message'), [
    ({'x': 1.0}, 'record of x, y: missing y, unknown none'),
    ({'x': 1.0, 'y': 2.0, 'z': 3.0}, 'record of x, y: missing none, unknown z'),
    ({'x': 1.0, 'Y': 2.0}, 'record of x, y: missing y, unknown Y')])
def test_a_missing_or_unknown_field_is_refused(fields, message):
    """The error names the fields there are and those that differ."""
    with pytest.raises(TypeError, match=message):
        record(POINT, **fields)


@pytest.mark.parametrize('corner', [(1.0, 2.0), 0.0, record(SIZE, width=1.0, height=2.0)])
def test_a_nested_field_is_not_filled_by_place(corner):
    """A tuple, a number for all fields or a record of another type: numpy would take them."""
    with pytest.raises(TypeError, match='corner = .*, must be a record of x, y'):
        record(BOX, corner=corner, kind=7, table=np.zeros(3))


@pytest.mark.parametrize('shape', [(3,), (3, 2), (0,), (1,)])
def test_records_of_floats_are_seen_as_numbers_in_the_same_memory(shape):
    """One row of numbers for each row, however many records and tables are in it."""
    rows = np.zeros(shape, [('corner', POINT), ('table', 'f8', (3,))])
    numbers = floats(rows)
    per_record = 5
    assert numbers.shape == (shape[0], per_record * int(np.prod(shape[1:])))
    numbers[:] = np.arange(numbers.size).reshape(numbers.shape)
    assert rows['corner']['y'].reshape(-1).tolist() == [
        1.0 + per_record * k for k in range(rows.size)]


def test_a_row_has_attributes_down_to_the_last_on_the_same_memory():
    """As those of `numpy.record`, which it is; numbers are read and written where they are."""
    rows = np.zeros(2, [('boxes', BOX, (2,)), ('extent', SIZE)])
    row = row_record(rows)
    assert isinstance(row, np.record) and type(row) is type(row.extent) is Record
    assert row.extent.dtype is row.extent.dtype is row['extent'].dtype    # none is made anew
    row.extent.width, row.boxes[1].corner.y, row.boxes[1].kind = 2.5, -1.5, 7
    row.extent['height'] = 4.0
    assert rows['boxes']['corner']['y'].tolist() == [[0.0, -1.5], [0.0, 0.0]]
    assert rows['boxes']['kind'].tolist() == [[0, 7], [0, 0]]
    assert rows['extent'].tolist() == [(2.5, 4.0), (0.0, 0.0)]
    rows['extent']['width'][0] = 9.0
    assert row.extent.width == 9.0 and row['extent'].width == 9.0
    assert row.extent.tolist() == (9.0, 4.0) and repr(row.extent).endswith("('height', '<f8')])")


def test_its_type_is_equal_and_made_once():
    """For machine code it is the same, and comparing two that are not one takes longer than it."""
    own = attributed(BOX)
    assert own == BOX and hash(own) == hash(BOX) and own.itemsize == BOX.itemsize
    assert own['corner'].type is Record and own['table'] == BOX['table']
    assert attributed(own) is own is attributed(np.dtype(BOX.descr)) is rows_of(3, BOX).dtype
    assert attributed(np.dtype('f8')) == np.dtype('f8')
    gaps = np.dtype({'names': ['a', 'b'], 'formats': ['i4', 'f8'], 'offsets': [4, 16],
                     'itemsize': 40})
    assert attributed(gaps) == gaps and attributed(gaps).itemsize == 40


@pytest.mark.parametrize('copied', [copy.copy, copy.deepcopy, lambda row: pickle.loads(
    pickle.dumps(row))])
def test_a_copy_of_a_row_is_a_row_of_its_own(copied):
    row = record(BOX, kind=7, table=np.arange(3.0), corner=record(POINT, x=1.0, y=2.0))
    other = copied(row)
    row.kind, row.corner.y = 5, 3.0
    assert type(other) is type(other.corner) is Record
    assert (other.kind, other.corner.y, other.table[2], other.dtype) == (7, 2.0, 2.0, BOX)


def test_a_field_that_is_not_there_is_an_attribute_error_with_those_near_it():
    row = rows_of(1, BOX)[0]
    with pytest.raises(AttributeError, match='^no field corners; did you mean corner[?]$'):
        row.corners
    with pytest.raises(AttributeError, match='^no field z; valid: x, y$'):
        row.corner.z = 1.0
    with pytest.raises(AttributeError, match='^no field __array_me__$'):
        row.__array_me__
    with pytest.raises(ValueError, match='could not convert'):
        row.corner.x = 'far'
    assert not hasattr(row, 'far') and row.shape == () and row.dtype == BOX
