"""ros2_control and RViz beside a leg or a robot, where their packages are installed."""

from xml.etree import ElementTree

import isa_ros
from isa_ros.config.paths import CONTROLLERS, find
from isa_ros.config.runs.body_control import controllers_of
from isa_ros.errors import ConfigError
import pytest
from tests.launch.stand_ins import Context, ProcessExited
import yaml

LEG = isa_ros.load('leg').configuration.leg


@pytest.mark.parametrize(('file', 'commands'), [
    ('leg_trajectory', ['position', 'velocity']), ('leg_torque', ['effort'])])
def test_ros2_control_has_the_leg_of_the_run_and_the_controllers_of_the_file(
        leg, installed, file, commands):
    """A manager with the file and the time of the run, and a spawner of all its controllers."""
    path = find(file, CONTROLLERS)
    installed |= dict.fromkeys(
        ['robot_state_publisher', *controllers_of(path, LEG).packages], '/opt')
    manager, spawner, publisher, *rest = leg(
        ros2_control=file, namespace='lab', set='leg.parameters.body.thigh.length_m=0.4')
    assert len(rest) == 4
    description = publisher.given['parameters'][0]['robot_description'].args[0]
    assert '<origin xyz="0.4 0.0 0.0"' in description
    tag, = ElementTree.fromstring(description).iterfind('ros2_control')
    assert [one.get('name') for one in tag.iterfind('joint[@name="kfe_joint"]/command_interface')
            ] == commands
    assert tag.findtext('hardware/param[@name="joint_commands_topic"]') == '/lab/joint_command'
    assert (manager.given['package'], manager.given['executable']) == (
        'controller_manager', 'ros2_control_node')
    assert manager.given['parameters'] == [str(path.resolve()), {'use_sim_time': True}]
    assert dict(manager.given['remappings'])['/clock'] == '/lab/clock'
    assert (spawner.given['package'], spawner.given['executable']) == (
        'controller_manager', 'spawner')
    assert spawner.given['arguments'] == [
        *controllers_of(path, LEG).types, '--controller-manager', 'controller_manager']
    for node in (manager, spawner):
        assert node.given['namespace'] == 'lab'
        with pytest.raises(RuntimeError, match='spawner-5: ended with exit code 1'):
            node.given['on_exit'](ProcessExited('spawner-5', 1), Context())
    assert 'ros2_control' not in leg()[0].given['parameters'][0]['robot_description'].args[0]


def test_ros2_control_has_the_joints_of_a_robot_in_its_namespace(robot, installed, tmp_path):
    path = find('quadruped_torque', CONTROLLERS)
    body, = isa_ros.load('quadruped').configuration.bodies
    installed |= dict.fromkeys(
        ['robot_state_publisher', 'rviz2', *controllers_of(path, body).packages], '/opt')
    (tmp_path / 'one.yaml').write_text(yaml.safe_dump({
        'name': 'one', 'robots': {'r1': {'file': 'quadruped'}}}))
    manager, spawner, publisher, rviz, *_ = robot(
        config=str(tmp_path / 'one.yaml'), ros2_control='quadruped_torque', namespace='lab',
        rviz='true')
    assert [own.given['namespace'] for own in (manager, spawner, publisher, rviz)] == (
        4 * ['lab/r1'])
    assert rviz.given['arguments'][2:] == ['-f', 'r1/trunk']    # a link of the description
    tag = ElementTree.fromstring(
        publisher.given['parameters'][0]['robot_description'].args[0]).find('ros2_control')
    assert [joint.get('name') for joint in tag.iterfind('joint')] == list(body.joint_space)
    assert tag.findtext('hardware/param[@name="joint_commands_topic"]') == '/lab/r1/joint_command'
    assert tag.findtext('hardware/param[@name="joint_states_topic"]') == '/lab/r1/joint_states'


@pytest.mark.parametrize(('texts', 'message'), [
    ({}, 'ros2_control:=leg_torque.yaml needs the package controller_manager, not installed'),
    ({'config': 'rig_rotary'},
     'ros2_control:=leg_torque.yaml: rig_rotary.yaml has no body with a URDF'),
    ({'ros2_control': 'leg_sway'}, 'leg_sway: no such file; shipped: leg_torque.yaml, leg_traj')])
def test_ros2_control_without_its_packages_a_leg_or_a_file_is_refused(
        leg, installed, texts, message):
    installed |= {'robot_state_publisher': '/opt'}
    with pytest.raises(ConfigError, match=message):
        leg(**{'ros2_control': 'leg_torque'} | texts)


@pytest.mark.parametrize(('texts', 'message'), [
    ({'rviz': 'true'}, 'rviz:=true needs the package robot_state_publisher, not installed'),
    ({'rviz': 'maybe'}, 'rviz:=maybe, must be true or false'),
    ({'rviz': 'true', 'config': 'rig_rotary'},
     'rviz:=true: rig_rotary.yaml has no body with a URDF')])
def test_rviz_without_its_packages_or_a_leg_is_refused(leg, texts, message):
    with pytest.raises(ConfigError, match=message):
        leg(**texts)
