"""Columns of a table, on a terminal and in Markdown."""

from hypothesis import given, strategies as st
from isa_ros.text.table import aligned, digits, GAP, markdown, padded, RIGHT
import pytest

ROWS = [('', 'value', 'unit'), ('bore', '21.5', 'mm'), ('stroke', '120', '')]
CELLS = st.text(st.characters(codec='ascii', exclude_categories=['Cc', 'Zs']), max_size=8)


def test_a_column_is_as_wide_as_its_widest_cell_and_ends_without_spaces():
    assert aligned(ROWS) == [
        '        value  unit', 'bore    21.5   mm', 'stroke  120']


def test_the_last_side_holds_for_the_columns_that_follow():
    assert aligned(ROWS, 'lr') == [
        '        value  unit', 'bore     21.5    mm', 'stroke    120']
    assert aligned(ROWS, RIGHT) == [
        '        value  unit', '  bore   21.5    mm', 'stroke    120']


@given(st.integers(1, 5).flatmap(
    lambda n: st.lists(st.lists(CELLS, min_size=n, max_size=n), min_size=1)))
def test_cells_keep_their_text_and_columns_their_place(rows):
    widths = [max(len(cell) for cell in column) for column in zip(*rows)]
    for line, row in zip(aligned(rows), rows, strict=True):
        place = 0
        for cell, width in zip(row, widths):
            assert line[place:place + width].rstrip() == cell
            place += width + len(GAP)


def test_a_line_grows_where_a_cell_is_wider_than_its_column():
    assert padded(('a', '1'), (3, 4), 'lr') == 'a       1'
    assert padded(('abcdef', '1'), (3, 4), 'lr') == 'abcdef     1'


def test_a_row_that_lacks_a_cell_is_a_mistake_of_the_caller():
    with pytest.raises(ValueError):
        aligned([('a', 'b'), ('c',)])


def test_markdown_has_a_rule_below_its_header():
    assert markdown(ROWS) == [
        '| | value | unit |', '|---|---|---|', '| bore | 21.5 | mm |', '| stroke | 120 |  |']
    assert markdown(ROWS[:1], 'lr')[1] == '|---|---:|---:|'


def test_a_bar_does_not_end_a_cell_of_markdown():
    assert markdown([('unit',), ('m | rad',)])[2] == '| m / rad |'


@pytest.mark.parametrize('value, n, expected', [
    (None, 3, '-'), (0.0, 3, '0'), (0.012345, 3, '0.0123'), (999.4, 3, '999'),
    (1000.0, 3, '1000'), (-41712.3, 3, '-41712'), (9999.0, 4, '9999'), (12345.0, 4, '12345')])
def test_a_large_number_has_no_power_of_ten(value, n, expected):
    assert digits(value, n) == expected


def test_what_a_terminal_would_act_on_is_shown_as_its_code():
    """A name of a bag from elsewhere: a colour, a bell, a new line; as wide as the code."""
    assert aligned([['\x1b[31mred', 'x'], ['a', '\x07\n']]) == [
        '\\x1b[31mred  x', 'a            \\x07\\n']
