"""Robots of run files: their resolved text, and their linkages."""

from pathlib import Path
import shutil

from isa_ros.config.differences import key_differences
from isa_ros.config.robots.geometry import motion_of, point, poses, quaternion
from isa_ros.config.robots.start import coordinates, root_pose
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import parse
from isa_ros.errors import ConfigError
import numpy as np
import pytest

ROOT = Path(__file__).parents[3]
NAMES = ('quadruped', 'hyq_quadruped', 'crane', 'two_joint_leg')


@pytest.fixture(scope='module')
def runs():
    """Return the shipped runs with a robot."""
    return {name: load_run(ROOT / 'config' / f'{name}.yaml') for name in NAMES}


def robot(run):
    return run.bodies[0]


@pytest.mark.parametrize('name', NAMES)
def test_the_resolved_text_needs_no_urdf(runs, name, tmp_path, monkeypatch):
    """Every value bit for bit, and the same text and sheet of it."""
    text = runs[name].to_yaml()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr('isa_ros.config.robots.tree.find_drawing', None)
    found = run_of_text(text)
    assert found == runs[name]
    assert found.to_yaml() == text
    first, second = robot(found).sheet, robot(runs[name]).sheet
    assert (first.links, first.contacts, first.frames) == (
        second.links, second.contacts, second.frames)
    for one, other in zip(first.drives, second.drives, strict=True):
        assert getattr(one.linkage, 'linkage', one.linkage) == getattr(
            other.linkage, 'linkage', other.linkage)
    assert list(key_differences(parse(text, 'text'), Place('text'))) == []


def test_a_urdf_is_beside_its_run_file(tmp_path):
    """The user's own file has precedence over a shipped one of its name."""
    path = tmp_path / 'crane.yaml'
    shutil.copy(ROOT / 'config' / 'crane.yaml', path)
    text = (ROOT / 'urdf' / 'crane.urdf').read_text()
    (tmp_path / 'crane.urdf').write_text(text.replace('value="100"', 'value="90"'))
    assert robot(load_run(path)).sheet.mass == pytest.approx(
        robot(load_run(ROOT / 'config' / 'crane.yaml')).sheet.mass - 10.0)


def test_a_contact_may_have_a_ground_of_its_own():
    """A material, values, or that of the robot."""
    values = {'stiffness': 2.0e6, 'damping': 0.1, 'friction': 0.5, 'tangential_stiffness': 1e5,
              'tangential_damping': 20.0}
    own = robot(load_run(ROOT / 'config' / 'crane.yaml', {'body.ground': 'wood', 'body.contacts': {
        'a': {'link': 'load'}, 'b': {'link': 'load', 'ground': 'rubber'},
        'c': {'link': 'load', 'ground': values}}}))
    assert [one.ground.stiffness for one in own.sheet.contacts] == [1e7, 1e6, 2e6]


def test_a_robot_stands_on_its_lowest_contact(runs):
    """All feet of the quadrupeds are on the ground; height_mm lifts the lowest."""
    for name, height in (('quadruped', 0.0), ('hyq_quadruped', 0.0), ('quadruped', 50.0)):
        own = robot(load_run(ROOT / 'config' / f'{name}.yaml', {'body.start.height_mm': height}))
        sheet = own.sheet
        at = poses(sheet.links, coordinates(own.start, own.tree),
                   root_pose(own.start, own.tree, sheet.contacts))
        heights = [point(at[one.link], one.point)[2] for one in sheet.contacts]
        feet = [z for z, one in zip(heights, sheet.contacts) if one.is_foot]
        assert len(feet) == 4 and feet == pytest.approx([1e-3 * height] * 4, abs=1e-12)
        assert min(heights) == min(feet)


def test_a_start_turns_the_root(runs):
    """Roll, pitch and yaw about fixed axes, as in a URDF."""
    own = robot(load_run(ROOT / 'config' / 'quadruped.yaml', {
        'body.start.roll_deg': 10.0, 'body.start.pitch_deg': -20.0, 'body.start.yaw_deg': 120.0}))
    pose = root_pose(own.start, own.tree, own.sheet.contacts)
    w, x, y, z = quaternion(*np.radians([10.0, -20.0, 120.0]))
    turned = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
    assert np.abs(turned - pose.rotation).max() < 1e-15
    assert pose.rotation[2, 0] == pytest.approx(np.sin(np.radians(20.0)))


def test_left_and_right_are_like_the_leg(runs):
    """A quadruped's pistons are those of the leg that its drives are like."""
    leg = load_run(ROOT / 'config' / 'leg.yaml').bodies[0]
    for joint, _ in leg.joints:
        for side in ('lf', 'rf', 'lh', 'rh'):
            found = robot(runs['quadruped']).position_of(f'{side}_{joint}')
            assert found == leg.position_of(joint)


def test_a_mirrored_linkage_is_that_of_the_opposite_angle(runs):
    """In HyQ's hind legs: x(q) of a front leg is x(-q), its lever the negative one."""
    sheet = robot(runs['hyq_quadruped']).sheet
    drives = {own.actuator: own for own in sheet.drives}
    index = {joint.name: k for k, joint in enumerate(sheet.joints)}
    for joint in ('hfe', 'kfe'):
        for angle in (-0.8, -0.5, -0.35):
            found = []
            for leg, sign in (('lf', 1.0), ('lh', -1.0)):
                q = [0.0] * len(sheet.joints)
                q[index[f'{leg}_{joint}']] = sign * angle
                found.append(motion_of(sheet, drives[f'{leg}_{joint}'], q))
            assert found[0][0] == found[1][0]
            assert found[0][1][0] == -found[1][1][0] != 0.0


def test_a_name_replaces_single_keys_of_a_pattern():
    """One HAA of four has another offset, and is like the leg's in everything else."""
    own = robot(load_run(ROOT / 'config' / 'quadruped.yaml', {
        'body.drives.rh_haa': {'offset_deg': 58.0}}))
    found = {one.name: one.linkage for one in own.drives}
    assert (found['rh_haa'].offset_deg, found['rh_haa'].sense) == (58.0, found['lf_haa'].sense)
    assert found['lf_haa'].offset_deg == 59.5


def test_a_linkage_of_the_file_has_its_range_mirrored(tmp_path):
    """Legs of one file: -80 to -30 deg of the one are 30 to 80 deg of the mirrored other."""
    own = robot(load_run(ROOT / 'config' / 'hyq_quadruped.yaml', {
        'body.linkages': {'knee': {
            'linkage': 'slider_crank', 'sense': 1.0, 'offset_deg': 166.0, 'a_mm': 321.8,
            'b_mm': 45.0, 'retracted_length_mm': 281.0, 'low_deg': -80.0, 'high_deg': -30.0}},
        'body.drives.*f_kfe': {'like': 'knee'},
        'body.drives.*h_kfe': {'like': 'knee', 'mirrored': True, 'high_deg': 75.0}}))
    found = {one.name: one.linkage for one in own.drives}
    assert (found['lf_kfe'].low_deg, found['lf_kfe'].high_deg) == (-80.0, -30.0)
    assert (found['rh_kfe'].low_deg, found['rh_kfe'].high_deg) == (30.0, 75.0)
    assert (found['lf_kfe'].sense, found['rh_kfe'].sense) == (1.0, -1.0)


def test_a_cylinder_pushes_as_the_crank_of_its_pins(runs):
    """The knee of the two-joint leg: pins a and b from the joint, law of cosines  (L4)."""
    own = robot(runs['two_joint_leg'])
    drive = own.sheet.drives[1]
    base, rod = np.array([45.0, -31.4 + 350.0]), np.array([4.7, -44.8])     # x, z from the knee
    a, b = np.hypot(*base), np.hypot(*rod)
    for q in (-2.3, -1.0, -0.4):
        start = np.arctan2(base[0], base[1]) - np.arctan2(rod[0], rod[1])
        length = np.sqrt(a * a + b * b - 2 * a * b * np.cos(q - start))
        x, levers = motion_of(own.sheet, drive, [0.0, 0.3, q])
        assert 1e3 * x == pytest.approx(length - 281.0, abs=1e-9)
        by = 1e-6
        low, high = (motion_of(own.sheet, drive, [0.0, 0.3, q + dq])[0] for dq in (-by, by))
        assert levers == [pytest.approx((high - low) / (2.0 * by), rel=1e-8)]


def test_a_cylinder_turned_round_pushes_the_same(runs):
    """Its base on the calf, its rod on the thigh: length and lever are those of before."""
    other = robot(load_run(ROOT / 'config' / 'two_joint_leg.yaml', {
        'body.drives.knee': {
            'linkage': 'cylinder', 'base': 'calf', 'base_mm': [4.7, 0.0, -44.8], 'rod': 'thigh',
            'rod_mm': [45.0, 0.0, -31.4], 'retracted_length_mm': 281.0}}))
    at = [0.1, 0.3, -1.0]
    (x, levers), (y, others) = (
        motion_of(own.sheet, own.sheet.drives[1], at)
        for own in (robot(runs['two_joint_leg']), other))
    assert x == pytest.approx(y, abs=1e-15) and levers == pytest.approx(others, abs=1e-15)


def test_a_cylinder_over_several_joints_has_a_lever_on_each(runs):
    """From the carriage to the calf: hip and knee; the levers are derivatives."""
    own = robot(load_run(ROOT / 'config' / 'two_joint_leg.yaml', {
        'body.drives.knee.base': 'carriage', 'body.drives.knee.base_mm': [60.0, 0.0, 0.0],
        'body.drives.knee.retracted_length_mm': 340.0}))
    drive = own.sheet.drives[1]
    at = [0.1, 0.3, -1.0]
    assert [own.sheet.links[k].joint.name for k in own.sheet.driven(drive)] == ['hip', 'knee']
    _, levers = motion_of(own.sheet, drive, at)
    for k, lever in zip((1, 2), levers):
        ends = [motion_of(own.sheet, drive, [
            q + (sign * 1e-6 if j == k else 0.0) for j, q in enumerate(at)])[0]
            for sign in (-1, 1)]
        assert lever == pytest.approx((ends[1] - ends[0]) / 2e-6, rel=1e-7)


def test_the_crane_moves_as_it_was_published(runs):
    """
    Lengths of its cylinders from the published pins, brackets and booms, in their own axes.

    The eye of the tilt cylinder is where circles about the ends of both brackets meet, 0.459 m
    about (2.69, -0.0066) of the lift boom and 0.475 m about (-0.095, 0.2404) of the tilt boom.
    """
    def turned(deg, x, y):
        c, s = np.cos(np.radians(deg)), np.sin(np.radians(deg))
        return np.array([c * x - s * y, s * x + c * y])
    own = robot(runs['crane'])
    for lift, tilt in ((-20.0, -1.0), (30.0, -60.0), (80.0, -160.0)):
        pin = np.array([-0.09, 1.4261]) + turned(lift, 0.3025, -0.105)
        expected = [np.hypot(*(pin - [0.17, 0.386113249])) - 0.82]
        a = np.array([2.69, -0.006592554])
        b = [2.881080943, 0.021592554] + turned(tilt, -0.095, 0.24043237)
        first, second, apart = np.hypot(0.457227402, 0.0425), 0.475, np.hypot(*(b - a))
        along = (apart * apart + first * first - second * second) / (2.0 * apart)
        across = np.sqrt(first * first - along * along)
        e_x, e_y = (b - a) / apart
        eye = a + along * np.array([e_x, e_y]) + across * np.array([-e_y, e_x])
        expected.append(np.hypot(*(eye - [1.263, 0.206702194])) - 1.05)
        at = [np.radians(lift), np.radians(tilt), 0.0, 0.0]
        assert [motion_of(own.sheet, drive, at)[0] for drive in own.sheet.drives] == (
            pytest.approx(expected, abs=1e-9))


def test_two_robots_have_their_own_actuators(tmp_path):
    """Two legs of one file, each in its namespace: sheets are equal, actuators are not."""
    path = tmp_path / 'pair.yaml'
    path.write_text('name: pair\nrobots: {r1: {file: two_joint_leg}, r2: {file: two_joint_leg}}\n')
    run = load_run(path)
    assert [own.actuator for body in run.bodies for own in body.drives] == [
        'r1/hip', 'r1/knee', 'r2/hip', 'r2/knee']
    assert run_of_text(run.to_yaml()) == run


def test_a_scenario_starts_a_robot_elsewhere(runs):
    """What it leaves out is as before; a pose that is not possible is refused with its place."""
    own = robot(runs['two_joint_leg'])
    place = Place('scenario.yaml', 'bodies.body')
    moved = own.started({'joints_deg': {'knee': -90.0}, 'yaw_deg': 30.0}, place, 1_000_000)
    assert moved.start.joints_deg == {'hip': 30.0, 'knee': -90.0}
    assert moved.start.joints_mm == {'slider': 590.0}
    assert (moved.start.root.yaw_deg, own.start.root.yaw_deg) == (30.0, 0.0)
    again = moved.started({'joints_mm': {'slider': 700.0}}, place, 1_000_000)
    assert again.start.root.yaw_deg == 30.0
    assert coordinates(again.start, again.tree) == pytest.approx(
        [0.7, np.radians(30.0), np.radians(-90.0)])
    assert moved.position_of('knee') != own.position_of('knee')
    with pytest.raises(ConfigError, match='^scenario.yaml: bodies.body: the contact foot is 9.8'):
        own.started({'joints_mm': {'slider': 579.0}}, place, 1_000_000)


def test_a_unit_is_in_the_axes_of_its_link():
    """On the foot, a fixed part of the calf whose axes are turned."""
    own = robot(load_run(ROOT / 'config' / 'quadruped.yaml', {'body.imus': {
        'foot': {'link': 'lf_foot', 'x_mm': 10.0, 'rate_hz': 500.0, 'gyro_bias': 0.01}}}))
    [unit] = own.units(1_000_000, seed=3)
    [frame] = [one for one in own.sheet.frames if one.name == 'lf_foot']
    assert own.sheet.links[unit.link].name == 'lf_calf' and unit.rotation == frame.rotation
    turned = np.array(frame.rotation) @ [0.01, 0.0, 0.0]
    assert np.array(unit.place) - frame.place == pytest.approx(turned, abs=1e-15)
    assert abs(turned[0]) < 1e-9 and (unit.period_ns, unit.gyro_bias) == (2_000_000, 0.01)
    assert unit.key != own.units(1_000_000, seed=4)[0].key
