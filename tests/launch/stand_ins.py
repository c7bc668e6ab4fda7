"""
What launch files take from `launch` and `launch_ros`, which are not on PyPI.

Each class keeps what it was made with; a context is the texts of the arguments by name.
"""

from collections.abc import Mapping
from types import ModuleType
from typing import Any


class Made:
    """Keeps its arguments."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        self.args, self.given = args, kwargs


class LaunchDescription(Made):
    """The actions of a launch file."""


class DeclareLaunchArgument(Made):
    """An argument: its name first, then default_value and description."""


class OpaqueFunction(Made):
    """A function of the context that returns actions."""


class Shutdown(Made):
    """The end of the launch."""


class Node(Made):
    """A node in a process of its own."""


class ParameterValue(Made):
    """A value first, then value_type."""


class LaunchConfiguration(Made):
    """The value of an argument."""

    def perform(self, context: Mapping[str, str]) -> str:
        return context[self.args[0]]


def modules() -> dict[str, ModuleType]:
    """Return the modules by name."""
    contents: dict[str, dict[str, Any]] = {
        'launch': {'LaunchDescription': LaunchDescription, 'LaunchContext': dict},
        'launch.actions': {
            'DeclareLaunchArgument': DeclareLaunchArgument, 'OpaqueFunction': OpaqueFunction,
            'Shutdown': Shutdown},
        'launch.substitutions': {'LaunchConfiguration': LaunchConfiguration},
        'launch_ros': {},
        'launch_ros.actions': {'Node': Node},
        'launch_ros.parameter_descriptions': {'ParameterValue': ParameterValue}}
    made = {}
    for name, members in contents.items():
        made[name] = ModuleType(name)
        vars(made[name]).update(members)
    return made
