"""
A body under ros2_control: what a file of controllers claims, and the tag of its hardware.

The hardware is `JointStateTopicSystem` of the package ``joint_state_topic_hardware_interface``
1.1.0. It publishes one JointState with all joints of the tag and an array for each kind of
command interface, NaN where no controller has claimed one. An array is without gaps, so that all
joints of the tag have the same command interfaces, and joints without a drive are left out.
Each of them is compared with the state interface of the same name.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from isa_ros.config.runs.body_config import BodyConfig, JOINT_COMMAND
from isa_ros.config.text.sections import names_at, Place, refuse_unknown, section_at
from isa_ros.config.text.yaml_text import read, Tree
from isa_ros.errors import ConfigError
from isa_ros.surroundings.messages import JOINT_STATES

PLUGIN = 'joint_state_topic_hardware_interface/JointStateTopicSystem'
MANAGER = 'controller_manager'
INTERFACES = ('position', 'velocity', 'effort')
"""Of a joint, in the words of ros2_control: the arrays of a JointState."""
_ALWAYS = -1
"""Threshold of the difference below which a command is not published: of a command to stay where
the joint is, the difference is 0."""


class Ros2Controllers(NamedTuple):
    """The controllers of a file."""

    types: dict[str, str]
    """By name, in the order of the file: package/class."""
    commands: tuple[str, ...]
    """Interfaces of `INTERFACES` that each commands, if any."""

    @property
    def packages(self) -> list[str]:
        """Return what has to be installed."""
        plugins = (PLUGIN, *self.types.values())
        return [MANAGER, *dict.fromkeys(plugin.partition('/')[0] for plugin in plugins)]


def controllers_of(path: Path, body: BodyConfig) -> Ros2Controllers:
    """
    Return the controllers of a parameter file of ros2_control, checked against a body.

    Raises
    ------
    ConfigError
        There are no controllers; a joint or an interface is not the body's; or two controllers
        command different interfaces.

    """
    place = Place(path.name)
    nodes: dict[str, Tree] = {}
    for key, section in read(path).items():
        inner = section_at(section, place / key)
        nodes[key.rpartition('/')[2]] = section_at(
            inner.get('ros__parameters', {}), place / key / 'ros__parameters')
    types = {name: str(own['type']) for name, own in nodes.get(MANAGER, {}).items()
             if isinstance(own, dict) and 'type' in own}
    claims = {}
    for name in types:
        own, below = nodes.get(name, {}), place / name
        _refuse_others(own, 'joints', tuple(body.joint_space), below)
        _refuse_others(own, 'state_interfaces', INTERFACES, below)
        if claimed := {*_refuse_others(own, 'command_interfaces', INTERFACES, below),
                       *_refuse_others(own, 'interface_name', INTERFACES, below)}:
            claims[name] = tuple(one for one in INTERFACES if one in claimed)
    if not claims:
        raise ConfigError(f'{path.name}: no controller of {MANAGER} has command interfaces')
    if len(set(claims.values())) > 1:
        found = '; '.join(f'{name}: {", ".join(own)}' for name, own in claims.items())
        raise ConfigError(f'{path.name}: command interfaces differ ({found}), must be the same')
    return Ros2Controllers(types, next(iter(claims.values())))


def _refuse_others(
        section: Tree, key: str, known: tuple[str, ...], place: Place) -> list[str]:
    """Return the name or the names of a key, none if it is not there."""
    given = section.get(key, [])
    names = names_at([given] if isinstance(given, str) else given, place / key)
    refuse_unknown(names, known, place / key)
    return names


def control_tag(body: BodyConfig, commands: tuple[str, ...], namespace: str) -> Iterator[str]:
    """Yield the lines of the tag, for a run in a namespace or in none, ''."""
    above = f'/{namespace}' if namespace else ''
    parameters = {
        'joint_commands_topic': f'{above}/{body.prefix}{JOINT_COMMAND}',
        'joint_states_topic': f'{above}/{body.prefix}{JOINT_STATES}',
        'trigger_joint_command_threshold': _ALWAYS}
    yield '  <ros2_control name="isa_ros" type="system">'
    yield '    <hardware>'
    yield f'      <plugin>{PLUGIN}</plugin>'
    for name, value in parameters.items():
        yield f'      <param name="{name}">{value}</param>'
    yield '    </hardware>'
    for joint in body.joint_space:
        yield f'    <joint name="{joint}">'
        for name in commands:
            yield f'      <command_interface name="{name}"/>'
        for name in INTERFACES:
            yield f'      <state_interface name="{name}"/>'
        yield '    </joint>'
    yield '  </ros2_control>'
