"""The readings of Table 4 that docs/paper-errata.md shows."""

from pathlib import Path

from isa_ros.text.table import markdown
import pytest
from scripts.measure_readings import (
    LINEAR, linear_readings, ROTARY, rotary_readings, table)

TEXT = (Path(__file__).parents[2] / 'docs' / 'paper-errata.md').read_text(encoding='utf-8')
BOTH = pytest.mark.parametrize(('readings', 'model'), [
    (rotary_readings, ROTARY), (linear_readings, LINEAR)])


@BOTH
def test_the_page_has_a_row_for_each_reading(readings, model):
    for reading in readings():
        assert f'\n| {reading.name} | ' in TEXT


def test_the_unit_of_the_gains_scales_all_three():
    """4.07 um of spool for each printed "mm" of K_p, K_i and K_v, 1 um as read."""
    changes = next(each.changes for each in linear_readings() if each.name.startswith('4.07'))
    assert changes == pytest.approx({
        'reu.force.kp': 4.07 * 0.02e-6, 'reu.force.ki': 4.07 * 0.85e-6,
        'reu.force.kv': 4.07 * 240e-6}, rel=1e-12, abs=0.0)


@pytest.mark.long
@BOTH
def test_the_page_shows_what_the_readings_give(readings, model):
    """`python scripts/measure_readings.py` was run after the last change."""
    assert '\n'.join(markdown(table(readings(), model))) in TEXT
