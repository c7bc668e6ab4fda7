"""Sensitivity: which entry notices a wrong parameter, and that none stays unnoticed."""

import json
from pathlib import Path
import re

from isa_ros.cli.main import main
from isa_ros.text.json_file import write_tree
from isa_ros.validation.actuators import Change, CheckedActuators, SHIPPED
from isa_ros.validation.groups import GROUPS
from isa_ros.validation.sensitivity import (
    is_noticed, Perturbation, PERTURBATIONS, sensitivity)
from isa_ros.validation.sensitivity_page import as_text, as_tree, summary, write_page
import pytest
from tests.validation.groups import MISSED, STIFF

DOCS = Path(__file__).parents[2] / 'docs'


def times(factor: float, group: str = 'stiff') -> Perturbation:
    return Perturbation(f'stiffness x{factor:g}', Change(('plant.k',), factor), (group,))


@pytest.fixture(scope='module')
def found():
    """Return a change that is noticed, one too small, one that diverges, one that is refused."""
    return sensitivity([times(2.0), times(1.05), times(4.0), times(6.0)], (STIFF, MISSED))


def test_a_perturbation_flips_what_is_then_missed(found):
    noticed, small, diverges, refused = found
    assert noticed.flips == ('stiff.bar',) and noticed.becomes_reached == ('stiff.late',)
    assert small.flips == () and small.refused == ''
    assert diverges.flips == ('stiff.bar', 'stiff.hidden')
    assert refused.flips == () and refused.refused == 'stiffness = 6 N/m, must be <= 5 N/m'


def test_a_hole_is_a_no_and_has_its_name(found):
    assert not is_noticed(found) and is_noticed([found[0], found[2], found[3]])
    assert summary(found) == (
        '4 perturbations: 2 noticed, 1 refused, 1 not noticed: stiffness x1.05')
    assert as_text(found).endswith('1 not noticed: stiffness x1.05')


def test_the_json_has_every_entry(found, tmp_path):
    write_tree(as_tree(found), tmp_path / 's.json')
    first, *_ = json.loads((tmp_path / 's.json').read_text())['perturbations']
    assert first == {
        'name': 'stiffness x2', 'key': 'plant.k', 'factor': 2.0, 'flips': ['stiff.bar'],
        'becomes_reached': ['stiff.late'], 'refused': ''}


def test_the_page_has_a_row_for_each(found, tmp_path):
    page, = write_page(found, tmp_path)
    text = page.read_text()
    assert '| stiffness x2 | `plant.k` | 2 | 1 | stiff.late | stiff.bar |' in text
    assert '| stiffness x1.05 | `plant.k` | 1.05 | 0 |  | **not noticed** |' in text


def test_the_shipped_page_has_the_perturbations_and_no_hole():
    page = (DOCS / 'sensitivity.md').read_text()
    assert re.findall(r'^\| ([^|]+) \| `', page, re.M) == [each.name for each in PERTURBATIONS]
    assert f'{len(PERTURBATIONS)} perturbations: ' in page and ', 0 not noticed.' in page


def test_every_perturbation_is_one_of_a_shipped_actuator():
    """A mistyped key would change nothing, and be reported as a hole of the validation."""
    names = {group.name for group in GROUPS}
    for each in PERTURBATIONS:
        assert set(each.groups) <= names
        keys = {key for key in each.change.keys if key != 'supply.pressure_mpa'}
        configs = [SHIPPED.run('rig_rotary', 'trot').configuration.actuators[0],
                   SHIPPED.run('rig_knee', 'drop').configuration.actuator('kfe')]
        assert keys <= set().union(*(each.change.of(config) for config in configs))


def test_a_change_reaches_actuator_load_and_supply():
    changes = {
        ('plant.friction.coulomb',): lambda run: run.actuators[0].sheet.plant.friction.coulomb,
        ('load.inertia',): lambda run: run.actuators[0].load.inertia,
        ('supply.pressure_mpa',): lambda run: run.supplies[0].sheet.pressure_mpa}
    for keys, value in changes.items():
        shipped, changed = (value(each.run('rig_rotary', 'weight').configuration)
                            for each in (SHIPPED, CheckedActuators(Change(keys, 0.5))))
        assert changed == 0.5 * shipped


def test_only_and_sensitivity_exclude_each_other(capsys):
    assert main(['validate', '--sensitivity', '--only', 'behaviour']) == 2
    assert capsys.readouterr().err == (
        'isa: --only is not used with --sensitivity, which runs every perturbation\n')


@pytest.mark.long
def test_every_perturbation_of_the_shipped_actuators_is_noticed():
    found = sensitivity()
    assert is_noticed(found), summary(found)
    print(as_text(found))
