"""The reader of URDFs, and the tree made of one, against Pinocchio's reader."""

from pathlib import Path

from isa_ros.config.robots.geometry import poses
from isa_ros.config.robots.tree import tree_of, z_along
from isa_ros.config.robots.urdf import load_urdf, read_urdf
from isa_ros.config.robots.urdf_numbers import Pose, turned
from isa_ros.errors import ConfigError
import numpy as np
import pytest
from scripts.write_quadrupeds import texts

URDF = Path(__file__).parents[3] / 'urdf'
FREE = ('hyq_real_quadruped', 'hyq_quadruped')
INERTIAL = '<inertial><mass value="{}"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" ' \
    'iyz="0"/></inertial>'
BODY = INERTIAL.format(2)
OBLIQUE = f"""<?xml version="1.0"?>
<robot name="oblique">
  <link name="base">{BODY}</link>
  <link name="plate">
    <inertial><origin xyz="0.1 -0.2 0.3" rpy="0.4 -0.5 0.6"/><mass value="3"/>
      <inertia ixx="0.5" iyy="0.6" izz="0.7" ixy="0.01" ixz="-0.02" iyz="0.03"/></inertial>
  </link>
  <link name="arm">
    <inertial><origin xyz="0.2 0.1 0" rpy="0 0.3 0"/><mass value="1.5"/>
      <inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0" ixz="0" iyz="0.01"/></inertial>
  </link>
  <link name="slide">{BODY}</link>
  <link name="wheel">{BODY}</link>
  <link name="tip"/>
  <joint name="plate_mount" type="fixed"><parent link="base"/><child link="plate"/>
    <origin xyz="0 0.4 0.1" rpy="1 0.2 -0.7"/></joint>
  <joint name="swing" type="revolute"><parent link="plate"/><child link="arm"/>
    <origin xyz="0.3 0 0.2" rpy="-0.4 0.1 2"/><axis xyz="1 -2 -2"/>
    <limit lower="-1" upper="2" effort="1" velocity="1"/></joint>
  <joint name="push" type="prismatic"><parent link="arm"/><child link="slide"/>
    <origin xyz="0 0 0.5" rpy="0.2 0 0"/><axis xyz="0 0 -1"/>
    <limit lower="0" upper="0.7" effort="1" velocity="1"/></joint>
  <joint name="roll" type="continuous"><parent link="slide"/><child link="wheel"/>
    <origin xyz="0.1 0.2 0.3"/></joint>
  <joint name="tip_mount" type="fixed"><parent link="wheel"/><child link="tip"/>
    <origin xyz="0 0 1" rpy="0 1.2 0"/></joint>
</robot>
"""


@pytest.fixture
def pin():
    return pytest.importorskip('pinocchio')


def cases():
    """Return text and freedom of each."""
    return {**{name: ((URDF / f'{name}.urdf').read_text(), True) for name in FREE},
            'oblique': (OBLIQUE, False), 'oblique_free': (OBLIQUE, True)}


@pytest.mark.parametrize('name', cases())
def test_a_robot_moves_as_that_of_pinocchio(pin, name):
    """Every frame, and mass, centre and inertia of every link, in three random poses."""
    text, is_free = cases()[name]
    tree = tree_of(read_urdf(text, name), is_free, name)
    model = pin.buildModelFromXML(text, *([pin.JointModelFreeFlyer()] if is_free else []))
    data, random = model.createData(), np.random.default_rng(3)
    for _ in range(3):
        q = random.uniform(-1.0, 1.0, len(tree.links) - 1)
        place, turn = (random.normal(size=3), turned(*random.normal(size=3))) if is_free else (
            np.zeros(3), np.eye(3))
        full = pin.neutral(model)
        if is_free:
            full[:7] = *place, *pin.Quaternion(turn).coeffs()
        for link, angle in zip(tree.links[1:], q):      # Pinocchio's are in alphabetical order
            joint = model.joints[model.getJointId(link.joint.name)]
            full[joint.idx_q:joint.idx_q + joint.nq] = (
                [np.cos(angle), np.sin(angle)] if joint.nq == 2 else angle)
        pin.framesForwardKinematics(model, data, full)
        at = poses(tree.links, q, Pose(place, turn))
        for frame in tree.frames:
            other = data.oMf[model.getFrameId(frame.name)]
            rotation = at[frame.link].rotation @ np.array(frame.rotation)
            assert np.abs(rotation - other.rotation).max() < 1e-14
            found = at[frame.link].place + at[frame.link].rotation @ np.array(frame.place)
            assert np.abs(found - other.translation).max() < 1e-14
        for link, pose in zip(tree.links, at):
            joint = model.getJointId(link.joint.name) if link.parent >= 0 else int(is_free)
            other = data.oMi[joint] * model.inertias[joint] if joint else model.inertias[0]
            if joint == 0:
                continue    # Pinocchio leaves out what cannot move
            xx, yy, zz, xy, xz, yz = link.inertia
            own = pose.rotation @ np.array(
                [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ pose.rotation.T
            assert abs(link.mass - other.mass) < 1e-13
            assert np.abs(pose.place + pose.rotation @ link.com - other.lever).max() < 1e-14
            assert np.abs(own - other.inertia).max() < 1e-13 * np.abs(own).max()


def test_links_are_in_depth_first_order():
    """Each parent stands before its child, the fixed parts are in their link."""
    tree = tree_of(load_urdf(URDF / 'hyq_real_quadruped.urdf'), True, 'file')
    assert [link.name for link in tree.links[:5]] == [
        'trunk', 'lf_hip', 'lf_thigh', 'lf_calf', 'rf_hip']
    assert all(link.parent < own for own, link in enumerate(tree.links))
    found = {frame.name: frame.link for frame in tree.frames}
    assert found['lf_foot'] == 3 and found['trunk_imu'] == 0


@pytest.mark.parametrize('axis', np.eye(3).tolist() + (-np.eye(3)).tolist() + [[0.6, 0.0, -0.8]])
def test_z_is_turned_to_the_axis(axis):
    turn = z_along(np.array(axis))
    assert np.allclose(turn[:, 2], axis, rtol=0.0, atol=1e-16)
    assert np.abs(turn @ turn.T - np.eye(3)).max() < 1e-15
    assert np.linalg.det(turn) == pytest.approx(1.0)


def test_the_shipped_quadrupeds_are_those_of_their_numbers():
    """Made by scripts/write_quadrupeds.py."""
    for path, text in texts():
        assert path.read_text(encoding='utf-8') == text


def test_left_and_right_are_mirror_images():
    """Centres of mass in a pose; HyQ's calves are published with 0.1 mm to one side."""
    for name in FREE:
        tree = tree_of(load_urdf(URDF / f'{name}.urdf'), True, name)
        index = {link.name: own for own, link in enumerate(tree.links)}
        angles = {'haa': 0.1, 'hfe': 0.7, 'kfe': -1.4}
        q = [angles[link.joint.name[3:]] for link in tree.links[1:]]
        at = poses(tree.links, q, Pose(np.zeros(3), np.eye(3)))
        for end in 'fh':
            for link in ('hip', 'thigh', 'calf'):
                left, right = (
                    at[k].place + at[k].rotation @ tree.links[k].com
                    for k in (index[f'{side}{end}_{link}'] for side in 'lr'))
                off = 2.1e-4 if (name, link) == ('hyq_quadruped', 'calf') else 1e-15
                assert np.abs(left * (1, -1, 1) - right).max() < off


def test_a_floating_joint_leads_to_the_robot():
    """As in the published descriptions: world, then the trunk."""
    text = (f'<robot name="r"><link name="world"/><link name="trunk">{BODY}</link>'
            '<joint name="free" type="floating"><parent link="world"/><child link="trunk"/>'
            '</joint></robot>')
    urdf = read_urdf(text, 'free.urdf')
    assert [link.name for link in tree_of(urdf, True, 'free.urdf').links] == ['trunk']
    with pytest.raises(ConfigError, match='free.urdf: joint free is floating, must be fixed for '):
        tree_of(urdf, False, 'free.urdf')


def pair(joint='<limit lower="-1" upper="1"/>', kind='revolute', link=BODY, more=''):
    return (f'<robot name="r"><link name="a">{BODY}</link><link name="b">{link}</link>{more}'
            f'<joint name="j" type="{kind}"><parent link="a"/><child link="b"/>{joint}</joint>'
            '</robot>')


LOOP = '<joint name="k" type="fixed"><parent link="b"/><child link="a"/></joint>'
AGAIN = '<joint name="k" type="fixed"><parent link="a"/><child link="b"/></joint>'
FLAT = INERTIAL.format(1).replace('izz="1"', 'izz="2.1"')


@pytest.mark.parametrize('text, message', [
    (pair('<mimic joint="k"/>'), 'joint j: has <mimic>, which is not read'),
    (pair(kind='planar'), "joint j: type = 'planar', must be one of revolute, continuous"),
    (pair(''), 'joint j: has no <limit lower upper>, which a revolute joint needs'),
    (pair('<limit lower="1" upper="1"/>'), 'joint j: limit lower = 1 rad, must be < upper = 1 '),
    (pair('<limit lower="0.2" upper="0"/>', 'prismatic'),
     'joint j: limit lower = 0.2 m, must be < upper = 0 m'),
    ('<robot/>', 'file: has 0 links without a parent; must have one, the root'),
    (pair('<axis xyz="0 0 0"/>'), 'joint j: axis xyz = 0 0 0, must have a direction'),
    (pair('<axis xyz="1 0"/>'), "joint j: axis xyz = '1 0', must be three numbers"),
    (pair('<origin rpy="1 nan 0"/>', 'fixed'),
     "joint j: origin rpy = '1 nan 0', must be finite numbers"),
    (pair('<limit lower="-pi" upper="1"/>'), "limit lower = '-pi', must be finite numbers"),
    (pair(link=INERTIAL.format(-1)), 'link b: mass value = -1 kg, must be >= 0 kg'),
    (pair(link=INERTIAL.format(0)), 'must be >= 0, and 0 without mass'),
    (pair(link=FLAT), 'principal moments 1, 1, 2.1 kg m2, the largest must be <= the sum'),
    (pair(link=FLAT.replace('ixx="1"', 'ixx="-1"')), 'principal moments -1, 1, 2.1 kg m2, must '),
    (pair(link='<inertial><mass value="1"/></inertial>'), 'link b: <inertial> lacks <inertia>'),
    (pair(more=LOOP), 'file: link a is its own parent, by the joints of a, b'),
    (pair(more=AGAIN), 'link b is the child of k and j, must be of one joint: a closed loop is a'),
    (pair(more='<link name="c"/>'), 'file: has 2 links without a parent: a, c; must have one'),
    (pair(more='<link name="b"/>'), 'link b is there twice'),
    (pair().replace('child link="b"', 'child link="d"'), "joint j: child = 'd' is not a link; "),
    (pair(more='<link name="c-1"/>'), "a link has the name 'c-1', must be letters, digits and"),
    ('<model/>', 'file: its element is <model>, must be <robot>'),
    ('<robot>', 'file: line 1: is not XML: no element found'),
    ('<robot>\n<xacro:property name="a" value="1"/></robot>',
     'file: line 2: has <xacro:property>, which is not read: expand the file first'),
    ('<!DOCTYPE robot [<!ENTITY a "b">]><robot>&a;</robot>', 'file: line 1: has a document type'),
])
def test_what_is_not_a_robot_is_refused_by_a_line(text, message):
    with pytest.raises(ConfigError) as error:
        read_urdf(text, 'file')
    assert message in str(error.value)
    assert str(error.value).startswith('file: ') and '\n' not in str(error.value)


def test_what_moves_needs_inertia():
    """A link without mass may be fixed to another one, or be a root that is fixed."""
    urdf = read_urdf(pair(link=''), 'file')
    with pytest.raises(ConfigError, match='file: link b has no inertia, must have <inertial> with '
                       'a mass > 0 kg: j moves it'):
        tree_of(urdf, False, 'file')
    bare = read_urdf(pair().replace(f'<link name="a">{BODY}', '<link name="a">'), 'file')
    assert tree_of(bare, False, 'file').links[0].mass == 0.0
    with pytest.raises(ConfigError, match='file: link a has no inertia, .* a free root moves it'):
        tree_of(bare, True, 'file')


def test_a_file_that_cannot_be_read_is_named(tmp_path):
    with pytest.raises(ConfigError, match='none.urdf: cannot be read: No such file'):
        load_urdf(tmp_path / 'none.urdf')
    path = tmp_path / 'wrong.urdf'
    path.write_bytes(b'\xff\xfe<robot/>')
    with pytest.raises(ConfigError, match='^wrong.urdf: (line|is not XML)'):
        load_urdf(path)
