"""
What launch files take from `launch` and `launch_ros`, which are not on PyPI.

Each class keeps what it was made with; a context is the texts of the arguments by name.
"""

from collections.abc import Mapping
from types import ModuleType
from typing import Any, NamedTuple


class Made:
    """Keeps its arguments."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        self.args, self.given = args, kwargs


class LaunchDescription(Made):
    """The actions of a launch file."""


class Action(Made):
    """Any action."""


class DeclareLaunchArgument(Made):
    """An argument: its name first, then default_value and description."""


class OpaqueFunction(Made):
    """A function of the context that returns actions."""


class Shutdown(Made):
    """The end of the launch."""


class ProcessExited(NamedTuple):
    """The event that a process has ended."""

    process_name: str
    returncode: int


class Context(dict[str, str]):
    """The context of a launch; `is_shutdown`: it ends already."""

    is_shutdown = False


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
        'launch': {'Action': Action, 'LaunchDescription': LaunchDescription,
                   'LaunchContext': Context},
        'launch.actions': {
            'DeclareLaunchArgument': DeclareLaunchArgument, 'OpaqueFunction': OpaqueFunction,
            'Shutdown': Shutdown},
        'launch.events': {}, 'launch.events.process': {'ProcessExited': ProcessExited},
        'launch.substitutions': {'LaunchConfiguration': LaunchConfiguration},
        'launch_ros': {},
        'launch_ros.actions': {'Node': Node},
        'launch_ros.parameter_descriptions': {'ParameterValue': ParameterValue}}
    made = {}
    for name, members in contents.items():
        made[name] = ModuleType(name)
        vars(made[name]).update(members)
    return made
