"""Rows of "Places for extensions" of docs/architecture.md, each made in a copy of the package."""

from pathlib import Path

import pytest
from tests.docs.patched_copy import PatchedCopy

_CONDITION = '''    Condition(
        'undervoltage', 'The supply sags below what the pumps need.',
        'supply pressure', 'Pa', 'opening_pressure',
        ErrorCode(0xFF10, MANUFACTURER, 'manufacturer: undervoltage'),
        LevelDefaults(
            'pressure over the opening of the relief valves', 1.0, warning=0.0, trip=0.0,
            delay_ms=0.0, reaction='disable'),
        is_above=False),
)
"""All conditions;'''
_MEASURED = '    values[BIT.spool_deviation] = spool_deviation(state, protection.evidence)\n'
_TRIPS = '''
import isa_ros
from isa_ros.fieldbus.device.devices import devices_of
import isa_ros.fieldbus.lines
run = isa_ros.load('rig_linear').replace({
    'actuators.ram.parameters.reu.protection.undervoltage.trip': 0.99})
simulation = run.simulation()
for _ in range(2):
    sample = simulation.step()['ram']
print(isa_ros.conditions(sample['trips']))
device, = devices_of(run.configuration)
device.take_sample(sample, 0)
print(*(f'{one.code:04X} {one.register:02X}' for one in device.emergencies()))
'''


@pytest.fixture
def copied(tmp_path: Path) -> PatchedCopy:
    """Return a copy of the package."""
    return PatchedCopy(tmp_path)


def test_a_text_that_is_not_there_once_is_refused(copied: PatchedCopy) -> None:
    with pytest.raises(ValueError, match='has 0 times, must have once'):
        copied.replace('package.xml', 'no such text', '')
    with pytest.raises(ValueError, match='times, must have once'):
        copied.replace('isa_ros/core/conditions.py', 'Condition(', '')
    with pytest.raises(FileExistsError):
        copied.add('package.xml', '')
    assert copied.touched == []


@pytest.mark.slow
def test_a_condition_is_a_row_and_a_line(copied: PatchedCopy) -> None:
    """Sheet, bit, words, error on a bus and pages are made from the row."""
    copied.replace(
        'isa_ros/core/conditions.py', ')\n"""All conditions;', _CONDITION)
    copied.replace(
        'isa_ros/reu/protection.py', _MEASURED,
        f'{_MEASURED}    values[BIT.undervoltage] = supply_pressure\n')
    assert len(copied.touched) == 2
    parameters = copied.isa('params', 'isa_v5')
    assert 'reu.protection.undervoltage.reaction ' in parameters
    assert copied.python(_TRIPS) == "['undervoltage']\nFF10 81\n"
    assert '0x2024 ' in copied.isa('bus', 'describe', 'rig_linear', '--table')
    copied.script('scripts/write_protection.py')
    assert '\n| 13 | `undervoltage` | supply pressure |' in copied.read('docs/protection.md')
    copied.script('scripts/write_objects.py')
    assert '\n| `undervoltage` | 0xFF10 | 0x81 |' in copied.read('docs/objects.md')
