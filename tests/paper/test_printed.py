"""The paper as data: spot checks of printed values, and a strict loader."""

from isa_ros.cli.main import main
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import parse
from isa_ros.errors import ConfigError
from isa_ros.paper.printed import (
    cell, Printed, read_statements, read_tables, statement, statements, tables)
import pytest

TABLE = """
t:
  caption: c
  columns: [a, b]
  rows:
  - {row: r, unit: mm, printed: ['1', '2']}
"""


@pytest.mark.parametrize('table, row, column, value, unit', [
    ('table_1', 'Rated flow at 7 MPa', 'KNR KSV070', 5.5, 'l/min'),
    ('table_1', 'Tare leakage at 20.7 MPa', 'Moog ISA v5 valve', 0.06, 'l/min'),
    ('table_1', '-3 dB bandwidth at 25% input', 'Moog E024', 250.0, 'Hz'),
    ('table_2', 'Cylinder bore diameter', 'ISA v5', 21.5, 'mm'),
    ('table_2', 'Stall load', 'Smart manifold', 170.0, 'Nm'),
    ('table_2', 'Dry weight', 'ISA v5', 1600.0, 'g'),
    ('table_2', 'Operating temperature (lowest)', 'ISA v2', -30.0, 'Celsius'),
    ('table_3', 'Encoder resolution', 'Smart manifold', 6.9e-4, 'deg'),
    ('table_4', 'Current w_lag', 'Smart manifold', 2513.3, 'rad/s'),
    ('table_4', 'Current w_lag', 'ISA V5', 25133.0, 'rad/s'),
    ('table_4', 'Force/torque K_i', 'Smart manifold', 7.0, 'mA/Nms'),
    ('table_4', 'Position K_p', 'ISA V5', 20000.0, 'N/mm'),
    ('table_5', 'D_m', 'Value', 8.59e-6, 'm3/rad'),
    ('table_5', 'beta_eff', 'Value', 7e8, 'N/m2'),
])
def test_a_cell_is_what_the_table_prints(table, row, column, value, unit):
    printed = cell(table, row, column)
    assert (printed.number, printed.unit) == (value, unit)
    assert printed.where == table.replace('_', ' ').capitalize()


def test_every_cell_of_the_paper_is_there():
    """Counted in the paper; Table 2's temperature range makes two rows."""
    shape = {name: (len(table.rows), len(table.columns)) for name, table in tables().items()}
    assert shape == {'table_1': (5, 5), 'table_2': (11, 3), 'table_3': (6, 2),
                     'table_4': (19, 2), 'table_5': (5, 1)}


def test_words_and_empty_cells_have_no_number():
    assert cell('table_2', 'Valve spool feedback', 'Smart manifold').text == 'Mechanic'
    for row in ('Current K_i', 'Spool K_p'):
        empty = cell('table_4', row, 'Smart manifold')
        with pytest.raises(ConfigError, match="Smart manifold = '-' is not a number"):
            empty.number


@pytest.mark.parametrize('name, value, unit, where', [
    ('high_valve_gain', 4.167e-5, 'm3/s', 'eq 19'),
    ('dual_gain_point', 42.7e-3, 'mm', 'eq 19'),
    ('tare_power_saving', 41.0, 'W', 'Fig 6 caption'),
    ('torque_rise_time', 8.0, 'ms', 'section 5.1, Fig 13'),
    ('knee_stiffness', 1e5, 'N/m', 'section 5.2'),
])
def test_a_statement_is_what_the_text_says(name, value, unit, where):
    printed = statement(name)
    assert (printed.number, printed.unit, printed.where) == (value, unit, where)


def test_every_statement_is_a_number_or_words_with_its_place():
    assert len(statements()) > 40
    for printed in statements().values():
        assert (printed.value is None) == (printed.unit == 'text')
        assert printed.where.startswith(('section', 'Fig', 'eq'))


def test_words_of_the_paper_are_no_numbers():
    """Neither "constant velocity" nor "eliminates" prints a 1 or a 0."""
    for name in ('speed_ratio', 'torque_steady_error'):
        assert statement(name).value is None and ' ' in statement(name).text


@pytest.mark.parametrize(('text', 'half'), [
    ('8', 0.5), ('0.17', 0.005), ('20,000*', 0.5), ('6.667e-6', 0.5e-9), ('7e8', 0.5e8),
    ('0.22 (at 200 bar)', 0.005), ('>100', 0.5)])
def test_half_of_the_last_printed_digit(text, half):
    printed = Printed('Table 9', 'x', text, 1.0, 'm')
    assert printed.half_digit == pytest.approx(half, rel=1e-12, abs=0.0)


def test_words_have_no_last_digit():
    with pytest.raises(ConfigError, match="'-' is not a number"):
        cell('table_4', 'Spool K_p', 'Smart manifold').half_digit


@pytest.mark.parametrize('change, expected', [
    (("'1', '2'", "'1', 'x2'"), r"t\.rows\[0\]\.printed = 'x2', must be a number"),
    (("'1', '2'", "'1'"), r'printed has 1 values, must have 2, one for each column'),
    (("'1', '2'", "1, '2'"), r'printed = 1, must be a text \(in quotes'),
    (('unit: mm', 'unit: [mm]'), r'unit has 1 values, must have 2'),
    (('row: r, ', ''), r'lacks row'),
    (('caption: c', 'captain: c'), r'captain is unknown; did you mean caption'),
    (('rows:\n', 'rows:\n  - {row: r, unit: mm, printed: ["1", "2"]}\n'), r"'r' occurs twice"),
])
def test_a_table_that_is_not_as_it_must_be_is_refused(change, expected):
    with pytest.raises(ConfigError, match=expected):
        read_tables(parse(TABLE.replace(*change), 't.yaml'), Place('t.yaml'))


def test_a_statement_needs_its_place():
    text = "s: {says: x, printed: '1', unit: m}"
    with pytest.raises(ConfigError, match='s lacks where'):
        read_statements(parse(text, 't.yaml'), Place('t.yaml'))


@pytest.mark.parametrize('call, expected', [
    (lambda: cell('table_6', 'x', 'y'), 'table_6 is not a table; did you mean'),
    (lambda: cell('table_5', 'd_m', 'Value'), "table_5 has no 'd_m'; did you mean L_m or D_m"),
    (lambda: cell('table_5', 'D_m', 'ISA v5'), "table_5 has no 'ISA v5'; valid: Value"),
    (lambda: statement('spool_gian'), 'spool_gian is not a statement; did you mean spool_gain'),
])
def test_an_unknown_name_is_answered_with_the_near_ones(call, expected):
    with pytest.raises(ConfigError, match=expected):
        call()


def test_isa_paper_prints_tables_and_statements(capsys):
    assert main(['paper']) == 0
    printed = capsys.readouterr().out
    for text in ('table_5: Rotary actuator parameters', '8.59e-6 m3/rad', '20,000* N/mm',
                 '>100 Hz', 'loop_gain', '540 rad/s'):
        assert text in printed


def test_isa_paper_prints_one_of_them_or_names_the_near_ones(capsys):
    assert main(['paper', 'table_3']) == 0
    assert capsys.readouterr().out.count('\n') == 8
    assert main(['paper', 'table_33']) == 2
    assert 'did you mean table_3' in capsys.readouterr().err
