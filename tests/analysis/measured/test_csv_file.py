"""Cells of a CSV file: quotes, decimal commas, remarks; rows of another length are refused."""

from pathlib import Path

from isa_ros.analysis.measured.csv_file import read_columns
from isa_ros.errors import BagError, ConfigError
import pytest


def columns(tmp_path: Path, text: str | bytes, *wanted: str | int) -> list[list[float]]:
    path = tmp_path / 'data.csv'
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    found = read_columns(path, wanted, 0, 'map')
    return [found[name].tolist() for name in wanted]


@pytest.mark.parametrize('text', [
    't,"s, mm",x\n1,7,2.5\n3,8,4.5\n', 't;s, mm;x\n1;7;2,5\n3;8;4,5\n',
    't\t"s, mm"\tx\n1\t7\t2.5\n3\t8\t4.5\n', 't "s, mm"   x\n1 7 2.5\n 3\t8  4.5 \n',
    't,"s, mm",x\n1,"7","2.5"\n3,"8",4.5\n', '"t;u","s, mm","x"\n1,7,2.5\n3,8,4.5\n'])
def test_a_name_may_have_a_comma(tmp_path: Path, text: str) -> None:
    """Neither moves the columns behind it, nor becomes a point."""
    assert columns(tmp_path, text, 's, mm', 'x', 1) == [[7.0, 8.0], [2.5, 4.5], [1.0, 3.0]]


def test_a_quote_in_a_quoted_name_is_doubled(tmp_path: Path) -> None:
    assert columns(tmp_path, '"bore 2""",x\n4,5\n', 'bore 2"', 'x') == [[4.0], [5.0]]


@pytest.mark.parametrize('text', [
    't,x\n1,2,DAQ start\n3,4,pause,stop\n', 't,x,\n1,2,\n3,4\n', 't,x,remark\n1,2\n3,4,a\n',
    't,x,remark,other\n1,2,a\n3,4,b,c\n', 't\tx\tremark\n1\t2\t\n3\t4\tb\n'])
def test_remarks_may_stand_behind_the_numbers(tmp_path: Path, text: str) -> None:
    assert columns(tmp_path, text, 't', 'x') == [[1.0, 3.0], [2.0, 4.0]]


def test_an_empty_cell_at_the_begin_of_a_line_is_a_cell(tmp_path: Path) -> None:
    assert columns(tmp_path, 'a\tt\tx\n\t1\t2\n\t3\t4\n', 't', 'x') == [[1.0, 3.0], [2.0, 4.0]]


@pytest.mark.parametrize('text, expected', [
    ('t,y,x\n1,2,3\n4,5,6,7\n', 'line 3: 4 cells, the head has 3'),
    ('t,y,x\n1,2,3\n4,6\n', 'line 3: 2 cells, the head has 3'),
    ('t,y,x,z\n1,2,3,4\n4,5,6\n', 'line 3: 3 cells, the head has 4'),
    ('t,y,x,z\n1,2,3\n4,5,6,7\n', 'line 2: 3 cells, the head has 4'),
    ('t,y,x\n1,2,3\n\n4,"5,6\n', 'line 4: 2 cells, the head has 3'),
    ('t,y,x\n1,2,3\n4,5\n6,7,8\n9\n', 'line 3: 2 cells, the head has 3'),
    ('1,2,3\n4,5,6\n7,8,9,10\n', 'line 3: 4 cells, the head has 3'),
    ('t y x\n1 2 3\n4 5 6 7\n', 'line 3: 4 cells, the head has 3')])
def test_a_row_of_another_length_has_its_line(tmp_path: Path, text: str, expected: str) -> None:
    with pytest.raises(BagError) as refused:
        columns(tmp_path, text, 1, 3)
    assert str(refused.value) == f'{tmp_path / "data.csv"}: {expected}'


@pytest.mark.parametrize('cell', ['20_0.0', '\u0663', '1,5,2', '', '0x10'])
def test_what_only_python_takes_for_a_number_is_refused(tmp_path: Path, cell: str) -> None:
    with pytest.raises(BagError) as refused:
        columns(tmp_path, f't;x;y\n1;2;3\n4;{cell};5\n', 'x')
    assert f'data.csv: line 3, column x: {cell!r}, must be a number' in str(refused.value)


def test_a_cell_without_an_end_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BagError, match=r'data.csv: line 2: field larger than field limit'):
        columns(tmp_path, f't,x\n1,"{"9" * 200_000}\n', 'x')


def test_a_long_entry_is_shortened(tmp_path: Path) -> None:
    with pytest.raises(BagError) as refused:
        columns(tmp_path, f't,x\n1,{"z" * 200_000}\n', 'x')
    assert f"column x: '{'z' * 59}..., must be" in str(refused.value)


def test_a_decimal_comma_belongs_to_semicolons(tmp_path: Path) -> None:
    with pytest.raises(BagError, match="line 2, column x: '1,5', must be a number"):
        columns(tmp_path, 't,x\n3,"1,5"\n', 'x')


def test_a_row_without_numbers_has_its_line(tmp_path: Path) -> None:
    with pytest.raises(BagError, match="line 3, column x: 'b', must be a number"):
        columns(tmp_path, 't,x\n1,2\na,b\n', 'x')


def test_numbers_with_an_empty_cell_are_not_names(tmp_path: Path) -> None:
    assert columns(tmp_path, '1,,2\n3,4,5\n', 1, 3) == [[1.0, 3.0], [2.0, 5.0]]


def test_a_byte_order_mark_is_no_part_of_a_name(tmp_path: Path) -> None:
    assert columns(tmp_path, '\ufefft,x\n3,4\n', 't') == [[3.0]]


def test_a_name_of_two_columns_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError) as refused:
        columns(tmp_path, 't,y,x,y\n1,2,3,4\n', 'y')
    assert str(refused.value) == (
        "map: column 'y' is named twice, columns 2 and 4; give its number")
    assert columns(tmp_path, 't,y,x,y\n1,2,3,4\n', 'x', 4) == [[3.0], [4.0]]


@pytest.mark.parametrize('encoding', ['utf-16', 'utf-16-le', 'utf-16-be', 'utf-32'])
def test_another_encoding_is_named(tmp_path: Path, encoding: str) -> None:
    with pytest.raises(BagError, match='data.csv: its encoding is UTF-16 or UTF-32, must be'):
        columns(tmp_path, 't,x\n1,2\n'.encode(encoding), 'x')
