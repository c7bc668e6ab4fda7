"""docs/robots.md: its machine is the shipped one, its numbers and messages are those of today."""

from pathlib import Path
import re

import isa_ros
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.text.yaml_text import parse
from isa_ros.core.constants import STANDARD_GRAVITY
from isa_ros.errors import ConfigError
import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / 'docs' / 'robots.md').read_text(encoding='utf-8')
CONFIG = ROOT / 'config'


def test_the_leg_of_the_page_is_the_shipped_one(tmp_path):
    """URDF and run file typed from the page alone."""
    [urdf] = re.findall(r'```xml\n(.*?)```', PAGE, re.DOTALL)
    text = re.findall(r'```yaml\n(.*?)```', PAGE, re.DOTALL)[0]
    (tmp_path / 'two_joint_leg.urdf').write_text(urdf)
    path = tmp_path / 'two_joint_leg.yaml'
    path.write_text(text)
    assert load_run(path) == load_run(CONFIG / 'two_joint_leg.yaml')


@pytest.mark.parametrize('k, name', [(1, 'hyq_quadruped'), (2, 'crane')])
def test_other_examples_are_parts_of_shipped_files(k, name):
    shipped = parse((CONFIG / f'{name}.yaml').read_text(encoding='utf-8'), name)
    text = re.findall(r'```yaml\n(.*?)```', PAGE, re.DOTALL)[k]
    part = parse(f'body:\n{text}' if text.startswith(' ') else text, name)

    def within(part, whole):
        if not isinstance(part, dict):
            return part == whole
        return all(key in whole and within(part[key], whole[key]) for key in part)
    assert within(part, shipped)


def test_masses_are_those_of_the_machines():
    found = re.findall(r'\| `(\w+).yaml` \|.*?\| ([0-9.]+) kg \|', PAGE)
    assert len(found) == 4
    for name, mass in found:
        assert load_run(CONFIG / f'{name}.yaml').bodies[0].sheet.mass == (
            pytest.approx(float(mass), abs=0.05))


def test_the_leg_settles_as_the_page_says():
    """At 569 mm after a second, on the weight of its links."""
    result = isa_ros.load('two_joint_leg').simulate(1.0)
    assert 1e3 * result['body.slider_position'][-1] == pytest.approx(569.0, abs=0.5)
    force = result['body.foot_force'][-1]
    assert force[2] == pytest.approx(113.0, abs=0.5)
    assert force[2] == pytest.approx(11.5 * STANDARD_GRAVITY, rel=1e-3)


@pytest.mark.parametrize('name, changes', [
    ('crane', {'body.drives.lift.base_mm': [1037.0, 0.0, 1836.0]}),
    ('crane', {'body.drives.lift.retracted_length_mm': 900.0}),
    ('crane', {'body.drives.lift.retracted_length_mm': 1200.0}),
    ('crane', {'body.passive': ['swing_pitch']}),
    ('two_joint_leg', {'body.drives.hip.offset_deg': 150.0})])
def test_the_messages_of_the_page_are_those_of_today(name, changes):
    with pytest.raises(ConfigError) as error:
        load_run(CONFIG / f'{name}.yaml', changes)
    rows = re.findall(r'^\| `(.*?)` \|', PAGE, re.MULTILINE)
    assert [row for row in rows if row in str(error.value)]
