"""Launch files with stand-ins for the packages of ROS: their actions and nodes."""

from importlib.util import module_from_spec, spec_from_file_location
import sys

import pytest
from tests.launch import stand_ins
from tests.launch.launched import ended, LAUNCH
from tests.ros.domains import held_domain


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
