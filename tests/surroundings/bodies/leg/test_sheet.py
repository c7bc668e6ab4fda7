"""Leg data sheets: units, mass scale, agreement with the URDF, refused geometry."""

from dataclasses import replace
import math
from pathlib import Path

from isa_ros.config.models.catalogue import leg_names
from isa_ros.errors import ParameterError
from isa_ros.surroundings import linkage
from isa_ros.surroundings.bodies.leg.sheet import body_record, leg_record
from isa_ros.surroundings.linkage_sheet import linkage_record
import pytest
from tests.legs import leg_sheet
import yaml

SHEET = leg_sheet()
ROOT = Path(__file__).resolve().parents[4]


def test_records_are_si():
    """Millimetres and degrees of the sheet in metres and radians."""
    leg = leg_record(SHEET)[0]
    assert leg.body.l_thigh == 0.36
    assert [leg.haa.kind, leg.hfe.kind, leg.kfe.kind] == [
        linkage.DIRECT, linkage.SLIDER_CRANK, linkage.FOUR_BAR]
    assert leg.hfe.a == pytest.approx(0.356, rel=1e-15, abs=0.0)
    assert leg.kfe.offset == pytest.approx(math.pi + 0.6, rel=1e-15, abs=0.0)
    assert leg.ground.tangential_stiffness == 1e5


def test_piston_of_the_knee_is_14_mm_out_at_full_flexion():
    """Extension 0.1 mm of the published table plus 14.1 mm, each to 0.05 mm."""
    x, _, _ = linkage.actuator_coordinate(math.radians(-158.7), linkage_record(SHEET.kfe))
    assert abs(1e3 * x - 14.2) < 0.1


HYQ = leg_sheet('hyq')


@pytest.mark.parametrize(('flexion', 'lever'), [
    (20.0, 22.5), (60.0, 41.3), (80.0, 44.9), (120.0, 35.6), (140.0, 22.5)])
def test_knee_of_hyq_has_the_published_levers(flexion, lever):
    """L4 with the flexion as minus the joint angle; the table is rounded to 0.1 mm."""
    _, r, _ = linkage.actuator_coordinate(math.radians(-flexion), linkage_record(HYQ.kfe))
    assert abs(1e3 * r - lever) < 0.05 + 1e-9


def test_hip_of_hyq_has_the_published_geometry():
    """L4: L^2 = a^2 + b^2 - 2 a b cos(pi/2 + q + 0.1089), 0.281 m retracted."""
    for q in (-0.8, 0.0, 0.7):
        x, _, _ = linkage.actuator_coordinate(q, linkage_record(HYQ.hfe))
        square = 0.3219 ** 2 + 0.045 ** 2 - 2.0 * 0.3219 * 0.045 * math.cos(
            math.pi / 2.0 + q + 0.1089)
        assert x == pytest.approx(math.sqrt(square) - 0.281, abs=1e-15)


@pytest.mark.parametrize(('joint', 'low', 'high'), [
    ('hfe', -50.0, 52.2), ('kfe', -140.0, -20.0)])
def test_isa_v2_reaches_the_joints_of_hyq(joint, low, high):
    """The whole knee lies within its 80 mm; the hip up to 52.2 of 70 deg, rounded to 0.1 deg."""
    row = linkage_record(getattr(HYQ, joint))
    ends = [1e3 * linkage.actuator_coordinate(math.radians(q), row)[0] for q in (low, high)]
    assert 0.0 < ends[0] < ends[1]
    # 0.05 deg at the hip's lever of 21 mm there.
    assert ends[1] < 80.0 + 0.02
    if joint == 'hfe':
        assert ends[1] > 80.0 - 0.05


def test_leg_of_hyq_weighs_what_its_links_do():
    """2.93 + 2.638 + 0.881 kg and the slider."""
    body = body_record(HYQ.body)[0]
    assert body['m_hip'] + body['m_thigh'] + body['m_calf'] == pytest.approx(
        6.449, rel=1e-15, abs=0.0)
    assert (body['l_hip'], body['d_hip']) == (0.0, 0.08)


def test_mass_scale_applies_to_links_but_not_to_the_slider():
    """Masses and inertias of the three links scale together."""
    plain = body_record(replace(SHEET.body, mass_scale=1.0))[0]
    scaled = body_record(SHEET.body)[0]
    assert plain['m_hip'] + plain['m_thigh'] + plain['m_calf'] == pytest.approx(
        12.14, rel=1e-15, abs=0.0)
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
            (ROOT / 'isa_ros/config/data/legs' / f'{name}.yaml').read_text(encoding='utf-8'))
        for path, entry in leaves(tree):
            if not path.endswith('.linkage'):
                assert entry['source'].startswith(
                    ('paper', 'derived', 'public model', 'assumed')), path


def test_four_bar_that_cannot_close_is_refused():
    """Links of 20 mm never meet between pins up to 70 mm apart."""
    with pytest.raises(ParameterError, match=r'FourBar cannot be assembled at .* -158\.7'):
        replace(SHEET.kfe, ar_mm=20.0, br_mm=20.0)


def test_linkage_through_a_dead_centre_is_refused():
    """L4: the lever vanishes at gamma = 0, where a force has no torque."""
    with pytest.raises(ParameterError, match=r'SliderCrank.*lever'):
        replace(SHEET.hfe, low_deg=-30.0)


@pytest.mark.parametrize(('field', 'value', 'message'), [
    ('sense', 0.5, r'Direct\.sense = 0\.5, must be 1 or -1'),
    ('low_deg', 40.0, r'Direct\.low_deg = 40 deg, must be < high_deg = 23 deg')])
def test_a_joint_without_range_or_sense_is_refused(field, value, message):
    """The message has name, value, unit and bound."""
    with pytest.raises(ParameterError, match=message):
        replace(SHEET.haa, **{field: value})
