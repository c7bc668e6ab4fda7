"""The launch files: their arguments and the nodes they start."""

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
import sys

from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.processes.processes import MODULES
import pytest
from tests.launch import stand_ins

LAUNCH = Path(__file__).parents[2] / 'launch'


@pytest.fixture
def actions(monkeypatch):
    """Return what gives the arguments and the other actions of a launch file."""
    for name, module in stand_ins.modules().items():
        monkeypatch.setitem(sys.modules, name, module)

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
def leg(actions):
    """Return what gives the nodes of leg.launch.py for the texts of some arguments."""
    arguments, (function,) = actions('leg.launch.py')
    defaults = {name: given['default_value'] for name, given in arguments.items()}

    def nodes(**texts: str):
        return function.given['function'](defaults | texts)
    return nodes


def parameters(node) -> dict[str, object]:
    """Return the parameters of a node, each of the type that is said to be its own."""
    values = {}
    for key, value in node.given['parameters'][0].items():
        assert value.given['value_type'] is type(value.args[0])
        values[key] = value.args[0]
    return values


def test_the_leg_has_the_arguments_of_the_interface(actions):
    arguments, _ = actions('leg.launch.py')
    assert {'config', 'out', 'duration', 'in_process', 'real_time_factor',
            'namespace'} <= set(arguments)
    assert arguments['config']['default_value'] == 'leg.yaml'
    assert all(given['description'] for given in arguments.values())


def test_the_leg_is_three_actuators_and_a_coordinator_that_ends_the_launch(leg):
    *actuators, coordinator = leg(namespace='lab')
    assert [node.given['name'] for node in actuators] == ['haa', 'hfe', 'kfe']
    assert all(node.given['executable'] in MODULES and node.given['namespace'] == 'lab'
               for node in (*actuators, coordinator))
    assert parameters(actuators[0]) == {
        'lockstep': True, 'config_file': str(find('leg', CONFIG).resolve())}
    assert all(node.given['on_exit'] is None for node in actuators)
    assert isinstance(coordinator.given['on_exit'][0], stand_ins.Shutdown)


def test_in_one_process_the_coordinator_is_alone_and_gets_every_argument(leg):
    coordinator, = leg(
        config='rig_rotary', scenario='step', out='bag', duration='0.5', in_process='true',
        real_time_factor='2', paused='1', compression='lz4', split_mb='0', sync='true')
    assert parameters(coordinator) == {
        'config_file': str(find('rig_rotary', CONFIG).resolve()),
        'scenario_file': str(find('step', SCENARIOS).resolve()), 'out': 'bag',
        'duration': 0.5, 'in_process': True, 'real_time_factor': 2.0, 'paused': True,
        'compression': 'lz4', 'split_mb': 0.0, 'sync': True}


def test_one_actuator_runs_its_model_at_real_time(actions):
    arguments, (node,) = actions('actuator.launch.py')
    assert {name: given['default_value'] for name, given in arguments.items()} == {
        'model': 'isa_v5', 'name': 'actuator', 'namespace': '', 'real_time_factor': '1.0'}
    assert node.given['executable'] == 'actuator'
    assert set(node.given['parameters'][0]) == {'model', 'real_time_factor'}
