"""What the page about exported actuators says of units of FMI is true."""

from pathlib import Path
import re

from isa_ros.core.objects import own_target
from isa_ros.export.chosen import choose
from isa_ros.export.fmi.unit import parts_of, units
from isa_ros.export.fmi.variables import UnitRole
import numpy as np
import pytest

PAGE = (Path(__file__).parents[2] / 'docs' / 'export.md').read_text().partition('unit of FMI\n')[2]


@pytest.fixture(scope='module')
def parts():
    """Return the parts of the page's unit."""
    return parts_of(choose('isa_v5'))


def test_all_inputs_are_in_its_tables(parts):
    named = set()
    for row in re.findall(r'^\| (`.*?) \|', PAGE, re.MULTILINE):
        first = ''
        for name in re.findall('`([^`]+)`', row):
            first = first if name.startswith('.') else name.partition('.')[0]
            named.add(f'{first}{name}' if name.startswith('.') else name)
    assert {own.name for own in parts.table if own.role in (UnitRole.INPUT, UnitRole.START)} == {
        name for name in named if not name.startswith(('reu.', 'can'))}


def test_named_gains_are_what_the_page_says(parts):
    roles = {own.name: own.role for own in parts.table}
    assert roles['reu.force.kp'] is UnitRole.TUNED and roles['reu.force.kf'] is UnitRole.CONSTANT
    assert '`reu.force.kp`' in PAGE and '`reu.force.kf`' in PAGE


@pytest.mark.slow
def test_the_program_of_the_page_runs(parts, tmp_path, monkeypatch):
    pytest.importorskip('fmpy')
    program, = re.findall(r'```python\n(.*?)```', PAGE, re.DOTALL)
    made = units(parts, own_target())
    assert all(f'`{name}`' in PAGE for name in made)
    (tmp_path / 'my_units').mkdir()
    for name, content in made.items():
        (tmp_path / 'my_units' / name).write_bytes(content)
        assert len(content) == pytest.approx(150e3, rel=0.1)
    monkeypatch.chdir(tmp_path)
    found = {}
    exec(program, found)
    result = found['result']
    assert len(result) == 1001 and np.ptp(result['port.force']) > 10.0
