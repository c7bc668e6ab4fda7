"""Topics of a robot: joints, pose and twist of its root, forces on its feet; joint setpoints."""

from dataclasses import replace
import math
from typing import Any
from xml.etree import ElementTree

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.config.paths import CONFIG, find, find_drawing
from isa_ros.config.robots.geometry import poses
from isa_ros.config.robots.urdf_numbers import Pose
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.config.text.yaml_text import read
from isa_ros.core.signals import COMMAND
from isa_ros.errors import SetpointError
from isa_ros.replay.replay import replay
from isa_ros.surroundings.joint_space import to_actuator
from msg_adapters.cdr_reader import decode
from nav_msgs.msg import Odometry
import numpy as np
import pytest
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState

FEET = ('lf_foot', 'rf_foot', 'lh_foot', 'rh_foot')
HEEL = (10.0, 20.0, -30.0)   # mm
AT = 60                     # tick that is compared, with a foot on the ground


def tilted() -> dict[str, Any]:
    """Return a run of the quadruped falling askew, with a contact off the origin of its link."""
    tree: dict[str, Any] = read(find('quadruped', CONFIG))
    tree['body']['contacts']['heel'] = {'link': 'rh_foot', 'at_mm': list(HEEL), 'is_foot': True}
    tree['body']['start'] |= {'roll_deg': 6.0, 'pitch_deg': -9.0, 'yaw_deg': 40.0}
    return tree


@pytest.fixture(scope='module')
def result() -> isa_ros.Result:
    return isa_ros.load(tilted()).simulate(AT * 1e-3)


@pytest.fixture(scope='module')
def bag(result, tmp_path_factory) -> Bag:
    return Bag(result.save(tmp_path_factory.mktemp('robot') / 'bag'))


def turned(w: float, x: float, y: float, z: float) -> np.ndarray:
    """Return the rotation of a quaternion, written by its products."""
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def last(bag: Bag, topic: str, cls: type) -> Any:
    """Return the last message of a topic, which the middleware reads and writes alike."""
    data = [message.data for message in bag.messages() if message.topic == topic][-1]
    message = decode(data, cls)
    assert deserialize_message(data, cls) == message
    assert decode(bytes(serialize_message(message)), cls) == message
    return message


def test_odometry_has_the_pose_in_the_world_and_the_twist_in_the_axes_of_the_root(result, bag):
    message = last(bag, '/odom', Odometry)
    assert (message.header.frame_id, message.child_frame_id) == ('world', 'trunk')
    pose, twist = message.pose.pose, message.twist.twist
    own = [getattr(pose.orientation, axis) for axis in 'wxyz']
    assert own == result['body.orientation'][-1].tolist() and min(map(abs, own)) > 1e-3
    assert [getattr(pose.position, axis) for axis in 'xyz'] == (
        result['body.position'][-1].tolist())
    r = turned(*own)
    for vector, field in ((twist.linear, 'velocity'), (twist.angular, 'angular_velocity')):
        measured = np.array([getattr(vector, axis) for axis in 'xyz'])
        np.testing.assert_allclose(r @ measured, result[f'body.{field}'][-1], atol=1e-12)
        assert np.abs(measured).max() > 1e-3


def test_a_foot_s_wrench_is_in_the_axes_and_about_the_origin_of_its_link(result):
    """With its moment where the contact is beside the origin."""
    robot = result.scenario.run.bodies[0]
    joints = [result[f'body.{joint.name}_position'][-1] for joint in robot.sheet.joints]
    at = poses(robot.sheet.links, joints, Pose(
        result['body.position'][-1], turned(*result['body.orientation'][-1])))
    loads = []
    for name in (*FEET, 'heel'):
        link = 'rh_foot' if name == 'heel' else name
        frame = next(own for own in robot.tree.frames if own.name == link)
        r = at[frame.link].rotation @ np.array(frame.rotation)
        origin = at[frame.link].place + at[frame.link].rotation @ np.array(frame.place)
        force, point = (result[f'body.{name}_{what}'][-1] for what in ('force', 'position'))
        wrench = result[f'body.{name}_wrench'][-1]
        np.testing.assert_allclose(r @ wrench[:3], force, atol=1e-9 * (1.0 + abs(force).max()))
        np.testing.assert_allclose(
            r @ wrench[3:], np.cross(point - origin, force), atol=1e-9 * (1 + abs(force).max()))
        loads.append(abs(force).max())
    assert loads[4] > 10.0 and np.abs(wrench[3:]).min() > 1e-3


def test_topics_and_frames_are_those_of_the_urdf(result, bag):
    urdf = ElementTree.parse(find_drawing('urdf/hyq_real_quadruped.urdf'))
    links = {own.get('name') for own in urdf.iter('link')}
    joints = [own.get('name') for own in urdf.iter('joint') if own.get('type') != 'fixed']
    states = last(bag, '/joint_states', JointState)
    assert sorted(states.name) == sorted(joints)
    for name, position, velocity, effort in zip(
            states.name, states.position, states.velocity, states.effort):
        assert (position, velocity, effort) == tuple(
            result[f'body.{name}_{what}'][-1] for what in ('position', 'velocity', 'torque'))
    messages = result.scenario.run.bodies[0].messages(1_000_000)
    assert {own.topic for own in messages} == {
        '/joint_states', '/odom', '/trunk/imu', '/heel/ground_contact',
        *(f'/{foot}/ground_contact' for foot in FEET)}
    assert {own.frame for own in messages[1:]} == {*FEET, 'trunk', 'trunk_imu'} <= links


def test_the_bag_has_the_motion_and_replays(result, bag):
    read_again = isa_ros.read(bag.path)
    for field in ('position', 'orientation', 'twist', 'lf_foot_wrench', 'rh_kfe_torque',
                  'trunk_angular_velocity'):
        assert np.array_equal(read_again[f'body.{field}'], result[f'body.{field}']), field
        assert read_again.units[f'body.{field}'] == result.units[f'body.{field}']
    assert replay(bag).is_equal


def test_a_robot_in_a_namespace_has_its_topics_frames_and_actuators_there():
    run = isa_ros.load({'name': 'herd', 'robots': {
        name: {'file': 'quadruped'} for name in ('r1', 'r2')}}).configuration
    for robot in run.bodies:
        own = f'{robot.name}/'
        messages = robot.messages(1_000_000)
        assert all(message.topic.startswith(f'/{own}') for message in messages)
        assert all(message.frame.startswith(own) for message in messages[1:])
        assert [name for _, name in robot.joints] == [drive.actuator for drive in robot.drives]
        assert {joint.actuator for joint in robot.joint_space.values()} == {
            name for _, name in robot.joints} <= {actuator.name for actuator in run.actuators}
    assert run_of_text(run.to_yaml()) == run


@pytest.mark.parametrize('config', ['quadruped', 'crane', 'two_joint_leg'])
def test_joint_space_has_the_linkages_of_the_motion(config):
    """Coordinate and lever at a joint's angle are those of the sample at t = 0, of all drives."""
    run = isa_ros.load(config)
    body, = run.configuration.bodies
    simulation = run.simulation()
    sample = simulation.body_samples['body']
    assert body.joint_space
    for joint, own in body.joint_space.items():
        angle = float(sample[f'{joint}_position'])
        assert own.measured(sample) == angle
        x, lever = own.at(angle)
        actuator = run.configuration.actuator(own.actuator)
        drive = next(drive.name for drive in body.drives if drive.actuator == own.actuator)
        assert x == pytest.approx(actuator.initial_position, abs=1e-12)
        assert lever == pytest.approx(float(sample[f'{drive}_lever']), rel=1e-12, abs=0.0)
        d = 1e-6
        assert lever == pytest.approx((own.at(angle + d)[0] - own.at(angle - d)[0]) / (2 * d),
                                      rel=1e-6, abs=0.0)


def test_a_setpoint_of_a_joint_under_a_cylinder_is_converted_by_its_lever():
    body, = isa_ros.load('crane').configuration.bodies
    name, joint = next((name, own) for name, own in body.joint_space.items()
                       if callable(own.linkage))
    sample = isa_ros.load('crane').simulation().body_samples['body']
    x, lever = joint.at(joint.measured(sample))
    command = np.zeros(1, COMMAND)[0]
    command['position'], command['velocity'] = joint.measured(sample), 0.5
    command['effort'], command['stiffness'] = 100.0, 1e5
    to_actuator(name, joint, sample, command)
    assert command['position'] == x and command['velocity'] == 0.5 * lever
    assert command['effort'] == 100.0 / lever
    assert command['stiffness'] == pytest.approx(1e5 / lever ** 2, rel=1e-15, abs=0.0)
    with pytest.raises(SetpointError, match=f'{name}: setpoint position = 9 rad, must be'):
        command['position'] = 9.0
        to_actuator(name, joint, sample, command)


def test_a_joint_that_shares_an_actuator_is_not_commanded_alone():
    """Or that two actuators move."""
    body, = isa_ros.load('quadruped').configuration.bodies
    assert len(body.joint_space) == 12 and math.isfinite(body.joint_space['lf_hfe'].low)
    twice = replace(body, drives=(*body.drives, body.drives[0]))
    first = body.drives[0].joint
    assert first in body.joint_space and first not in twice.joint_space
    assert len(twice.joint_space) == 11
