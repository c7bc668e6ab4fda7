"""A leg under ros2_control: the shipped controllers, the tag of the hardware, and its URDF."""

from pathlib import Path
from xml.etree import ElementTree

import isa_ros
from isa_ros.config.paths import CONTROLLERS, shipped
from isa_ros.config.runs.body_control import (
    control_tag, controllers_of, INTERFACES, PLUGIN, Ros2Controllers)
from isa_ros.errors import ConfigError
from isa_ros.surroundings.messages import JointStates
import pytest
from tests.scripting.legs import two_legs

FILES = {name: path for name, path in shipped(CONTROLLERS).items() if name.startswith('leg_')}
LEG = isa_ros.load('leg').configuration.leg


def tag_of(run, leg, commands=('position',), namespace=''):
    """Return the tag in the URDF of a leg of a run, and the URDF."""
    root = ElementTree.fromstring(
        run.description(leg, Path(), control_tag(leg, commands, namespace)))
    tag, = root.iterfind('ros2_control')
    return tag, root


def interfaces(joint, kind):
    return [one.get('name') for one in joint.iterfind(f'{kind}_interface')]


def test_the_shipped_controllers_are_for_the_modes_impedance_and_force():
    assert {name: controllers_of(path, LEG) for name, path in FILES.items()} == {
        'leg_trajectory.yaml': Ros2Controllers({
            'joint_state_broadcaster': 'joint_state_broadcaster/JointStateBroadcaster',
            'joint_trajectory_controller':
                'joint_trajectory_controller/JointTrajectoryController'},
            ('position', 'velocity')),
        'leg_torque.yaml': Ros2Controllers({
            'joint_state_broadcaster': 'joint_state_broadcaster/JointStateBroadcaster',
            'torque_controller': 'forward_command_controller/ForwardCommandController'},
            ('effort',))}


@pytest.mark.parametrize('config', ['leg', 'hyq_leg'])
@pytest.mark.parametrize('file', FILES)
def test_the_tag_has_the_joints_and_topics_of_the_leg(config, file):
    """
    Each joint has its command interfaces, and the state of the same name that it is compared with.

    The arrays of the commands have no gaps, so that a joint without command is not in the tag.
    """
    run = isa_ros.load(config).configuration
    commands = controllers_of(FILES[file], run.leg).commands
    tag, root = tag_of(run, run.leg, commands)
    joints = {one.get('name'): one for one in tag.iterfind('joint')}
    assert list(joints) == list(run.leg.joint_space)
    movable = [one.get('name') for one in root.iterfind('joint') if one.get('type') == 'revolute']
    assert list(joints) == movable
    for joint in joints.values():
        assert tuple(interfaces(joint, 'command')) == commands
        assert tuple(interfaces(joint, 'state')) == INTERFACES
    assert tag.findtext('hardware/plugin') == PLUGIN
    parameters = {one.get('name'): one.text for one in tag.iterfind('hardware/param')}
    states, = (own for own in run.leg.messages(run.step_ns) if isinstance(own, JointStates))
    assert parameters == {
        'joint_commands_topic': '/joint_command', 'joint_states_topic': states.topic,
        'trigger_joint_command_threshold': '-1'}
    assert set(joints) < set(states.names)


def test_without_a_tag_the_urdf_is_the_shipped_one():
    run = isa_ros.load('leg').configuration
    urdf, tag = run.description(LEG, Path()), [*control_tag(LEG, ('effort',), '')]
    assert 'ros2_control' not in urdf
    assert run.description(LEG, Path(), tag) == urdf.replace(
        '</robot>', '\n'.join([*tag, '</robot>']))


def test_topics_are_those_of_the_namespace_and_of_the_leg():
    run = isa_ros.load(two_legs()).configuration
    for leg in run.bodies:
        tag, _ = tag_of(run, leg, namespace='lab')
        topics = [one.text for one in tag.iterfind('hardware/param')][:2]
        assert topics == [f'/lab/{leg.name}/joint_command', f'/lab/{leg.name}/joint_states']


def test_nodes_of_a_file_are_found_by_their_names_and_the_rest_is_left_to_ros2_control(tmp_path):
    file = tmp_path / 'own.yaml'
    file.write_text("""
controller_manager:
  ros__parameters:
    update_rate: 100
    first: {type: a/First}
    second: {type: b/Second}
/lab/first: {ros__parameters: {joints: [kfe_joint], command_interfaces: [effort, position]}}
second: {ros__parameters: {gains: {kfe_joint: {p: 1.0}}}}
other: {ros__parameters: {joints: [wheel]}}
""")
    found = controllers_of(file, LEG)
    assert found == ({'first': 'a/First', 'second': 'b/Second'}, ('position', 'effort'))
    assert found.packages == [
        'controller_manager', 'joint_state_topic_hardware_interface', 'a', 'b']


HEAD = 'controller_manager: {ros__parameters: {c: {type: a/C}, d: {type: a/D}}}\n'


@pytest.mark.parametrize(('text', 'message'), [
    ('controller_manager: {ros__parameters: {update_rate: 100}}',
     'c.yaml: no controller of controller_manager has command interfaces'),
    ('c: {ros__parameters: {interface_name: effort}}', 'no controller of controller_manager has'),
    (HEAD + 'c: {ros__parameters: {joints: [hfe], interface_name: effort}}',
     'c.yaml: c.joints.hfe is unknown; valid: haa_joint'),
    (HEAD + 'c: {ros__parameters: {command_interfaces: [effort, torque]}}',
     'c.yaml: c.command_interfaces.torque is unknown'),
    (HEAD + 'c: {ros__parameters: {interface_name: force}}', 'c.interface_name.force is unknown'),
    (HEAD + 'c: {ros__parameters: {command_interfaces: [effort], state_interfaces: [force]}}',
     'c.state_interfaces.force is unknown'),
    (HEAD + 'c: {ros__parameters: {joints: 3, interface_name: effort}}',
     'c.joints = 3, must be a list of names'),
    (HEAD + 'c: {ros__parameters: {interface_name: effort}}\n'
     'd: {ros__parameters: {command_interfaces: [position]}}',
     r'command interfaces differ \(c: effort; d: position\), must be the same'),
    (HEAD + 'c: 1', 'c.yaml: c = 1, must be a section'),
    (HEAD + 'c: {ros__parameters: 2}', 'c.yaml: c.ros__parameters = 2, must be a section')])
def test_a_file_that_does_not_fit_the_leg_is_refused_in_one_line(tmp_path, text, message):
    file = tmp_path / 'c.yaml'
    file.write_text(text)
    with pytest.raises(ConfigError, match=message):
        controllers_of(file, LEG)
