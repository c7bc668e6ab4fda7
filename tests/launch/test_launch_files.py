"""The launch files of a leg and of one actuator: their arguments and the nodes they start."""

import os
from pathlib import Path

import isa_ros
from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.errors import ConfigError
from isa_ros.nodes.middleware.domain import CLAIMED_BY
from isa_ros.processes.processes import MODULES
from isa_ros.run.options import OPTIONS
import pytest
from tests.launch import stand_ins
from tests.launch.launched import ended, parameters
from tests.launch.stand_ins import Context, ProcessExited
from tests.scripting.legs import two_legs
import yaml


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
    with pytest.raises(ConfigError, match='has no body with a URDF, or several'):
        leg(config=str(tmp_path / 'two.yaml'), rviz='true')


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
