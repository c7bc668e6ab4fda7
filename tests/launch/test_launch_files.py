"""The launch files: their arguments and the nodes they start."""

from importlib.util import module_from_spec, spec_from_file_location
import os
from pathlib import Path
import sys
from xml.etree import ElementTree

import isa_ros
from isa_ros.config.paths import CONFIG, CONTROLLERS, find, SCENARIOS
from isa_ros.config.runs.leg_control import controllers_of
from isa_ros.errors import ConfigError
from isa_ros.nodes.middleware.domain import CLAIMED_BY
from isa_ros.processes.processes import MODULES
from isa_ros.run.options import OPTIONS
import pytest
from tests.launch import stand_ins
from tests.launch.stand_ins import Context, ProcessExited
from tests.ros.domains import held_domain
from tests.scripting.test_two_bodies import two_legs
import yaml

LAUNCH = Path(__file__).parents[2] / 'launch'
LEG = isa_ros.load('leg').configuration.leg


@pytest.fixture
def installed() -> dict[str, str]:
    """Return the ROS packages that are installed, with their prefixes; to be filled."""
    return {}


@pytest.fixture
def actions(monkeypatch, installed):
    """Return what gives the arguments and the other actions of a launch file."""
    for name, module in stand_ins.modules().items():
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.setattr(
        'ament_index_python.packages.get_packages_with_prefixes', lambda: installed)

    def of(file: str):
        spec = spec_from_file_location(file.partition('.')[0], LAUNCH / file)
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
        every, = module.generate_launch_description().args
        arguments = [one for one in every if isinstance(one, stand_ins.DeclareLaunchArgument)]
        return ({one.args[0]: one.given for one in arguments},
                [one for one in every if one not in arguments])
    return of


@pytest.fixture
def launched(actions, monkeypatch):
    """Return what gives the nodes of leg.launch.py, all launched at once, in one domain."""
    arguments, (function,) = actions('leg.launch.py')
    defaults = {name: given['default_value'] for name, given in arguments.items()}
    with held_domain(monkeypatch):
        yield lambda **texts: function.given['function'](defaults | texts)


@pytest.fixture
def leg(launched):
    """Return what gives the nodes of leg.launch.py, of one launch after the other."""
    def nodes(**texts: str):
        found = launched(**texts)
        ended(found)
        return found
    return nodes


def ended(nodes) -> None:
    """Release the name that a launch holds, as the end of its coordinator does."""
    nodes[-1].given['on_exit'](ProcessExited('coordinator-1', 0), Context())


def parameters(node, *names: str) -> dict[str, object]:
    """Return all or some parameters of a node, each of the type that is said to be its own."""
    values, given = {}, node.given['parameters'][0]
    for key in names or given:
        value = given[key]
        declared = value.given['value_type']
        assert declared is type(value.args[0]) or declared == list[str]
        values[key] = value.args[0]
    return values


def test_the_leg_has_every_argument_of_a_bring_up(actions):
    arguments, _ = actions('leg.launch.py')
    assert set(arguments) == {'rviz', 'ros2_control', *(option.name for option in OPTIONS)}
    assert arguments['config']['default_value'] == 'leg.yaml'
    assert all(given['description'] for given in arguments.values())


def test_the_leg_is_three_actuators_and_a_coordinator_that_ends_the_launch(leg):
    *actuators, coordinator = leg(namespace='lab')
    assert [node.given['name'] for node in actuators] == ['haa', 'hfe', 'kfe']
    assert all(node.given['executable'] in MODULES and node.given['namespace'] == 'lab'
               for node in (*actuators, coordinator))
    assert parameters(actuators[0]) == {
        'lockstep': True, 'config_file': str(find('leg', CONFIG).resolve())}
    done, = coordinator.given['on_exit'](ProcessExited('coordinator-4', 0), Context())
    assert isinstance(done, stand_ins.Shutdown)
    assert all(node.given['on_exit'](ProcessExited('haa-1', 0), Context()) is None
               for node in actuators)


def test_a_second_launch_of_a_namespace_is_refused_before_it_starts_anything(launched):
    """Its actuators would have the names of the first; other namespaces are free."""
    first, other = launched(), launched(namespace='left')
    assert first[-1].given['additional_env'] == {CLAIMED_BY: str(os.getpid())}
    for texts, where in (({}, '/'), ({'namespace': '/left/'}, '/left')):
        with pytest.raises(ConfigError, match=f'another coordinator runs in .* {where}, must be'):
            launched(**texts)
    ended(first)
    ended(launched())
    with pytest.raises(ConfigError, match='namespace /left, must be the only one'):
        launched(namespace='left')
    ended(other)


def test_the_launch_fails_with_the_run_unless_it_ends_already(leg):
    """Launch exits with a code other than 0 after an exception only; Ctrl-C ends with 0."""
    ending = Context()
    ending.is_shutdown = True
    for node in leg():
        for code in (2, 3, -9):
            with pytest.raises(RuntimeError, match=f'kfe-3: ended with exit code {code}'):
                node.given['on_exit'](ProcessExited('kfe-3', code), Context())
        node.given['on_exit'](ProcessExited('kfe-3', 130), ending)


def test_actuators_of_another_host_are_not_started(leg):
    *actuators, coordinator = leg(elsewhere='haa,kfe', controller='sway,hold')
    assert [node.given['name'] for node in actuators] == ['hfe']
    assert parameters(coordinator)['controllers'] == ['sway', 'hold']


def test_changes_and_the_seed_reach_the_actuators_too(leg):
    """Otherwise they would take part with other parameters, and be refused."""
    *actuators, coordinator = leg(set='supply.pressure_mpa=14', seed='7')
    assert parameters(coordinator)['seed'] == 7
    assert parameters(coordinator)['set'] == ['supply.pressure_mpa=14']
    for node in actuators:
        assert parameters(node)['set'] == ['supply.pressure_mpa=14', 'seed=7']


def test_a_leg_is_shown_where_the_packages_are_installed(leg, installed):
    """With the URDF of its model and the simulated time."""
    installed |= {'robot_state_publisher': '/opt', 'rviz2': '/opt'}
    publisher, rviz, *rest = leg(config='hyq_leg', namespace='lab', rviz='true')
    description = publisher.given['parameters'][0]['robot_description'].args[0]
    assert '<robot name="hyq_leg">' in description and len(rest) == 4
    assert publisher.given['parameters'][0]['use_sim_time'] is True
    assert publisher.given['namespace'] == rviz.given['namespace'] == 'lab'
    for node in (publisher, rviz):
        assert dict(node.given['remappings']) == {
            f'/{topic}': f'/lab/{topic}' for topic in ('tf', 'tf_static', 'clock')}
    shown = yaml.safe_load(Path(rviz.given['arguments'][1]).read_text())['Visualization Manager']
    assert shown['Global Options']['Fixed Frame'] == 'world'
    assert [node.given['executable'] for node in leg()][:2] == [
        'robot_state_publisher', 'actuator']


def test_a_leg_is_shown_with_the_lengths_of_its_run(leg, installed):
    installed |= {'robot_state_publisher': '/opt'}
    publisher, *_ = leg(set='leg.parameters.body.thigh.length_m=0.4')
    description = publisher.given['parameters'][0]['robot_description'].args[0]
    assert '<origin xyz="0.4 0.0 0.0" rpy="0.0 0.0 0.0"/>' in description


def test_each_of_several_legs_is_shown_in_its_namespace(leg, installed, tmp_path):
    """With transforms and time of the run, so that they meet in one tree."""
    installed |= {'robot_state_publisher': '/opt'}
    two = isa_ros.load(two_legs()).configuration
    (tmp_path / 'two.yaml').write_text(two.to_yaml())
    publishers = leg(config=str(tmp_path / 'two.yaml'), namespace='lab')[:2]
    assert [own.given['namespace'] for own in publishers] == ['lab/left', 'lab/right']
    assert all(dict(own.given['remappings'])['/tf'] == '/lab/tf' for own in publishers)
    with pytest.raises(ConfigError, match='has no leg or robot, or several'):
        leg(config=str(tmp_path / 'two.yaml'), rviz='true')


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


@pytest.fixture
def robot(actions, monkeypatch):
    """Return what gives the nodes of robot.launch.py, of one launch after the other."""
    arguments, (function,) = actions('robot.launch.py')
    defaults = {name: given['default_value'] for name, given in arguments.items()}

    def nodes(**texts: str):
        found = function.given['function'](defaults | texts)
        ended(found)
        return found
    with held_domain(monkeypatch):
        yield nodes


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
    with pytest.raises(ConfigError, match='herd.yaml has no leg or robot, or several'):
        robot(config=str(tmp_path / 'herd.yaml'), rviz='true')


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
    ({'config': 'rig_rotary'}, 'ros2_control:=leg_torque.yaml: rig_rotary.yaml has no leg'),
    ({'ros2_control': 'leg_sway'}, 'leg_sway: no such file; shipped: leg_torque.yaml, leg_traj')])
def test_ros2_control_without_its_packages_a_leg_or_a_file_is_refused(
        leg, installed, texts, message):
    installed |= {'robot_state_publisher': '/opt'}
    with pytest.raises(ConfigError, match=message):
        leg(**{'ros2_control': 'leg_torque'} | texts)


@pytest.mark.parametrize(('texts', 'message'), [
    ({'rviz': 'true'}, 'rviz:=true needs the package robot_state_publisher, not installed'),
    ({'rviz': 'maybe'}, 'rviz:=maybe, must be true or false'),
    ({'rviz': 'true', 'config': 'rig_rotary'}, 'rviz:=true: rig_rotary.yaml has no leg')])
def test_rviz_without_its_packages_or_a_leg_is_refused(leg, texts, message):
    with pytest.raises(ConfigError, match=message):
        leg(**texts)


def test_in_one_process_the_coordinator_is_alone_and_gets_every_argument(leg):
    coordinator, = leg(
        config='rig_rotary', scenario='step', out='bag', duration='0.5', in_process='true',
        real_time_factor='2', paused='1', compression='lz4', split_mb='0', overwrite='true',
        join_timeout='7', restore='a.json', save='b.json', sync='true',
        seed='7', start_time='9')
    assert parameters(coordinator) == {
        'config_file': str(find('rig_rotary', CONFIG).resolve()),
        'scenario_file': str(find('step', SCENARIOS).resolve()), 'out': 'bag',
        'duration': 0.5, 'in_process': True, 'real_time_factor': 2.0, 'paused': True,
        'compression': 'lz4', 'split_mb': 0.0, 'overwrite': True, 'join_timeout_s': 7.0,
        'restore': 'a.json', 'save': 'b.json', 'sync': True, 'seed': 7,
        'start_time': 9, 'fail_on_trip': False}


def test_one_actuator_runs_its_model_at_real_time(actions):
    arguments, (function,) = actions('actuator.launch.py')
    defaults = {name: given['default_value'] for name, given in arguments.items()}
    assert defaults == {
        'model': '', 'name': 'actuator', 'namespace': '', 'real_time_factor': '1.0',
        'config_file': '', 'scenario_file': ''}
    node, = function.given['function'](defaults)
    assert node.given['executable'] == 'actuator'
    assert set(node.given['parameters'][0]) == {
        'model', 'real_time_factor', 'config_file', 'scenario_file'}
    assert parameters(node, 'model', 'config_file') == {'model': 'isa_v5', 'config_file': ''}
    with pytest.raises(RuntimeError, match='actuator-1: ended with exit code 2'):
        node.given['on_exit'](ProcessExited('actuator-1', 2), Context())


def test_one_actuator_of_a_run_file_has_its_model(actions):
    arguments, (function,) = actions('actuator.launch.py')
    defaults = {name: given['default_value'] for name, given in arguments.items()}
    node, = function.given['function'](defaults | {'config_file': 'leg', 'scenario_file': 'drop'})
    assert parameters(node, 'model', 'config_file', 'scenario_file') == {
        'model': '', 'config_file': 'leg', 'scenario_file': 'drop'}
