"""Leg data sheets: units, mass scale, agreement with the URDF, refused geometry."""

from dataclasses import replace
import math
from pathlib import Path

from isa_ros.catalogue import leg_names
from isa_ros.errors import ParameterError
from isa_ros.load import linkage
from isa_ros.load.leg_sheet import body_record, leg_records, linkage_record
import pytest
from tests.legs import leg_sheet
import yaml

SHEET = leg_sheet()
ROOT = Path(__file__).resolve().parents[2]


def test_records_are_si():
    """Millimetres and degrees of the sheet in metres and radians."""
    body, linkages, ground = leg_records(SHEET)
    assert body[0]['l_thigh'] == 0.36
    assert linkages['kind'].tolist() == [
        linkage.DIRECT, linkage.SLIDER_CRANK, linkage.FOUR_BAR]
    assert linkages[1]['a'] == pytest.approx(0.356, rel=1e-15)
    assert linkages[2]['offset'] == pytest.approx(math.pi + 0.6, rel=1e-15)
    assert ground[0]['sigma_0'] == pytest.approx(0.7 / 1e-3, rel=1e-15)


def test_piston_of_the_knee_is_14_mm_out_at_full_flexion():
    """Extension 0.1 mm of the published table plus 14.1 mm, each to 0.05 mm."""
    x, _, _ = linkage.actuator_coordinate(math.radians(-158.7), linkage_record(SHEET.kfe))
    assert abs(1e3 * x - 14.2) < 0.1


def test_mass_scale_applies_to_links_but_not_to_the_slider():
    """Masses and inertias of the three links scale together."""
    plain = body_record(replace(SHEET.body, mass_scale=1.0))[0]
    scaled = body_record(SHEET.body)[0]
    assert plain['m_hip'] + plain['m_thigh'] + plain['m_calf'] == pytest.approx(12.14, rel=1e-15)
    for name in ('m_hip', 'm_thigh', 'm_calf', 'i_hip_xx', 'i_thigh_yy', 'i_calf_zz'):
        assert scaled[name] == 0.84 * plain[name]
    assert scaled['m_slider'] == plain['m_slider'] == 5.0


def test_every_value_states_its_source():
    """Paper, derived, public model or assumed; structure keys apart."""
    def leaves(tree, path=''):
        for key, entry in tree.items():
            if isinstance(entry, dict) and 'value' not in entry:
                yield from leaves(entry, f'{path}{key}.')
            else:
                yield f'{path}{key}', entry

    for name in leg_names():
        tree = yaml.safe_load(
            (ROOT / 'isa_ros' / 'load' / 'legs' / f'{name}.yaml').read_text(encoding='utf-8'))
        for path, entry in leaves(tree):
            if not path.endswith('.linkage'):
                assert entry['source'].startswith(
                    ('paper', 'derived', 'public model', 'assumed')), path


def test_four_bar_that_cannot_close_is_refused():
    """Links of 20 mm never meet between pins up to 70 mm apart."""
    with pytest.raises(ParameterError, match=r'FourBar cannot be assembled at .* -158\.7'):
        replace(SHEET.kfe, ar_mm=20.0, br_mm=20.0)


def test_linkage_through_a_dead_centre_is_refused():
    """L4: the lever vanishes at gamma = 0, where a force could not be told from none."""
    with pytest.raises(ParameterError, match=r'SliderCrank.*lever'):
        replace(SHEET.hfe, low_deg=-30.0)


@pytest.mark.parametrize(('field', 'value', 'message'), [
    ('sense', 0.5, r'Direct\.sense = 0\.5, must be 1 or -1'),
    ('low_deg', 40.0, r'Direct\.low_deg = 40 deg, must be < high_deg = 23 deg')])
def test_a_joint_without_range_or_sense_is_refused(field, value, message):
    """What, value, unit and bound."""
    with pytest.raises(ParameterError, match=message):
        replace(SHEET.haa, **{field: value})
