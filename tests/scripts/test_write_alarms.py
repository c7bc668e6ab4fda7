"""The table of docs/protection.md that says which shipped scenarios warn or trip."""

import isa_ros
import pytest
from scripts.write_alarms import alarms_of, fitting, HEADER, PAGE, rows

LINES = PAGE.read_text(encoding='utf-8').partition('<!-- alarms -->')[2].partition(
    '<!-- end -->')[0].split('\n')
TABLE = [tuple(cell.strip() for cell in line.strip('|').split('|'))
         for line in LINES if line.startswith('| `')]


def pair(scenario: str, config: str) -> tuple[str, str, isa_ros.Run]:
    return f'{scenario}.yaml', f'{config}.yaml', isa_ros.load(config, scenario)


@pytest.mark.parametrize(('scenario', 'config'), [
    ('sensor_lost', 'rig_knee'), ('weight', 'rig_rotary_position'), ('lower_load', 'rig_hoses')])
def test_a_row_of_the_page_is_that_of_the_run(scenario, config):
    row, = rows([pair(scenario, config)])
    assert len(row) == len(HEADER) and row in TABLE


def test_what_neither_warns_nor_trips_or_is_refused_has_no_row():
    assert rows([pair('weight', 'rig_rotary'), pair('quadruped_stand', 'crane')]) == []
    assert not [row for row in TABLE if row[:2] == ('`weight`', '`rig_rotary`')]


def test_a_sound_single_acting_cylinder_at_full_opening_has_no_row():
    """Its valve has the whole pressure over one land: 0.284 m/s, which two lands cannot cause."""
    assert rows([pair('lift_table', 'lift_table')]) == []
    assert not [row for row in TABLE if row[:2] == ('`lift_table`', '`lift_table`')]


def test_a_trip_within_the_run_is_found_with_its_warning():
    alarms = alarms_of(isa_ros.load('leg', 'sensor_lost'))
    assert alarms == (('load_cell_implausible',), ('load_cell_implausible',))


@pytest.mark.long
def test_the_page_has_the_rows_of_today():
    """`python -m scripts.write_alarms` after a change of the conditions or of a scenario."""
    assert rows(fitting()) == TABLE
