"""The launch file of robots: their nodes, descriptions and frames."""

from pathlib import Path
from xml.etree import ElementTree

import isa_ros
from isa_ros.errors import ConfigError
import pytest
from tests.scripting.test_own_body import RIG, Slide
import yaml


def test_a_robot_is_launched_with_every_argument_and_shown_with_its_sensors(
        actions, robot, installed):
    """By default the quadruped; the frames of its messages are links of its description."""
    assert actions('robot.launch.py')[0].keys() == actions('leg.launch.py')[0].keys()
    installed |= {'robot_state_publisher': '/opt', 'rviz2': '/opt'}
    publisher, rviz, *actuators, coordinator = robot(rviz='true')
    assert len(actuators) == 12 and coordinator.given['executable'] == 'coordinator'
    description = ElementTree.fromstring(
        publisher.given['parameters'][0]['robot_description'].args[0])
    links = {link.get('name') for link in description.iterfind('link')}
    body, = isa_ros.load('quadruped').configuration.bodies
    assert {message.frame for message in body.messages(1_000_000)[1:]} <= links
    assert {f'{joint}{end}' for joint in body.joint_space for end in ('', '_load_cell')} <= links
    assert publisher.given['namespace'] == ''
    assert rviz.given['arguments'][2:] == ['-f', 'trunk']
    assert Path(rviz.given['arguments'][1]).name == 'robot.rviz'
    shown = yaml.safe_load(Path(rviz.given['arguments'][1]).read_text())['Visualization Manager']
    topics = {one['Topic']['Value'] for one in shown['Displays'] if 'Topic' in one}
    assert topics == {message.topic[1:] for message in body.messages(1_000_000)
                      if message.topic.endswith('/ground_contact')}


def test_several_robots_have_their_nodes_descriptions_and_frames(robot, installed, tmp_path):
    """Joints keep their names, and all links are the robot's own, once each."""
    installed |= {'robot_state_publisher': '/opt'}
    (tmp_path / 'herd.yaml').write_text(yaml.safe_dump({
        'name': 'herd', 'robots': {'r1': {'file': 'quadruped'}, 'r2': {'file': 'crane'},
                                   'r3': {'file': 'leg'}}}))
    *rest, coordinator = robot(config=str(tmp_path / 'herd.yaml'), namespace='lab')
    publishers, actuators = rest[:3], rest[3:]
    assert [own.given['namespace'] for own in publishers] == ['lab/r1', 'lab/r2', 'lab/r3']
    assert coordinator.given['namespace'] == 'lab'
    run = isa_ros.load(tmp_path / 'herd.yaml').configuration
    assert [f"{own.given['namespace']}/{own.given['name']}" for own in actuators] == [
        f'lab/{own.name}' for own in run.actuators]
    for own, body in zip(publishers, run.bodies):
        root = ElementTree.fromstring(own.given['parameters'][0]['robot_description'].args[0])
        links = [link.get('name') for link in root.iterfind('link')]
        assert len(set(links)) == len(links)
        assert all(link.startswith(body.prefix) or link == 'world' for link in links)
        ends = {end.get('link') for joint in root.iterfind('joint')
                for end in joint if end.tag in ('parent', 'child')}
        assert ends == set(links)
        joints = {joint.get('name') for joint in root.iterfind('joint')}
        assert set(body.joint_space) <= joints
        assert dict(own.given['remappings'])['/tf'] == '/lab/tf'
    with pytest.raises(ConfigError, match='herd.yaml has no body with a URDF, or several'):
        robot(config=str(tmp_path / 'herd.yaml'), rviz='true')


def test_the_only_robot_with_a_name_is_drawn_in_the_frame_of_its_root(robot, installed, tmp_path):
    installed |= {'robot_state_publisher': '/opt', 'rviz2': '/opt'}
    (tmp_path / 'one.yaml').write_text(yaml.safe_dump({
        'name': 'one', 'robots': {'r2': {'file': 'quadruped'}}}))
    _, rviz, *_ = robot(config=str(tmp_path / 'one.yaml'), rviz='true')
    assert rviz.given['arguments'][2:] == ['-f', 'r2/trunk']
    assert rviz.given['namespace'] == 'r2'


def test_a_body_without_a_urdf_has_no_publisher(robot, installed, tmp_path):
    """Neither is it the only one that rviz could show."""
    installed |= {'robot_state_publisher': '/opt', 'rviz2': '/opt'}
    (tmp_path / 'slide.yaml').write_text(yaml.safe_dump(RIG | {
        'body': RIG['body'] | {'class': f'{Slide.__module__}:Slide'}}))
    nodes = robot(config=str(tmp_path / 'slide.yaml'))
    assert [own.given['executable'] for own in nodes] == ['actuator', 'actuator', 'coordinator']
    with pytest.raises(ConfigError, match='slide.yaml has no body with a URDF, or several'):
        robot(config=str(tmp_path / 'slide.yaml'), rviz='true')
