"""Records are filled by name, all of their fields and no others."""

from isa_ros.core.record import floats, record
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
