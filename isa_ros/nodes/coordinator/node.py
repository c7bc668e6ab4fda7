"""ROS 2 face of the run: time, events, supplies and body on topics."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.core.topic import Topic
from isa_ros.errors import ConfigError
from isa_ros.nodes.coordinator.services import REAL_TIME_FACTOR
from isa_ros.nodes.middleware.publishers import PreparedPublishers
from isa_ros.nodes.middleware.refusals import refusals
from isa_ros.run.narrator import Outlet, Outlets
from isa_ros.run.pacing import JOIN_TIMEOUT_S
from isa_ros.run.session import Request
from msg_adapters import clock, event
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter

NAME = 'coordinator'
_OWN = f'/{NAME}/'
_STRINGS = Parameter.Type.STRING_ARRAY


class CoordinatorNode(Node):
    """Publish time, events, supplies and body of a run."""

    def __init__(self, **kwargs: Any) -> None:
        with refusals():
            super().__init__(NAME, start_parameter_services=False, **kwargs)
        self._time = PreparedPublishers(self, [clock.TOPIC])
        self._events = _Events(self, [(_relative(event.TOPIC[0]), event.TOPIC[1])])

    def outlets(self, surroundings: Sequence[Topic], actuators: Sequence[Outlet]) -> Outlets:
        """
        Advertise the topics of supplies and body, and return the publishers of a run.

        ``actuators`` are those of the actuators in this process, none where they have their own.
        """
        shown = PreparedPublishers(
            self, [(_relative(topic.name), topic.type_name) for topic in surroundings])
        return Outlets(self._time, self._events, shown, actuators)

    def request(self) -> Request:
        """
        Declare the parameters of a run and return what they ask for.

        Raises
        ------
        ConfigError
            No configuration is named.

        """
        defaults = {
            'config_file': ('', 'run file'),
            'scenario_file': ('', 'what is commanded; empty: nothing'),
            'out': ('', 'directory of the bag; empty: a new one in runs/'),
            'duration': (0.0, 'simulated time, s; 0: that of the scenario'),
            'real_time_factor': (0.0, 'not faster than this; 0: as fast as it can'),
            'controllers': ([], 'controllers that take part, besides those of the run file'),
            'paused': (False, 'wait for ~/step or the end of the pause before tick 0'),
            'restore': ('', 'saved state to go on from; empty: begin at t = 0'),
            'save': ('', 'file for the state at the end; empty: not saved'),
            'overwrite': (False, 'replace the bag in an existing directory'),
            'compression': ('', 'of the bag: none, lz4, zstd; empty: that of the run file'),
            'split_mb': (-1.0, 'size of the files of a bag, MB; 0: one; < 0: as the run file'),
            'in_process': (False, 'all nodes in this process'),
            'join_timeout_s': (JOIN_TIMEOUT_S, 'how long participants are waited for, s'),
        }
        values: dict[str, Any] = {
            name: self.declare_parameter(
                name, _STRINGS if default == [] else default,
                ParameterDescriptor(description=text, read_only=name != REAL_TIME_FACTOR)).value
            for name, (default, text) in defaults.items()}
        if not values['config_file']:
            raise ConfigError(f'{NAME}: set the parameter config_file')
        return Request(
            config=find(values['config_file'], CONFIG),
            scenario=(find(values['scenario_file'], SCENARIOS)
                      if values['scenario_file'] else None),
            out=_path(values['out']), save=_path(values['save']),
            restore=_path(values['restore']), controllers=tuple(values['controllers'] or ()),
            is_paused=values['paused'],
            duration_s=values['duration'] or None,
            real_time_factor=values['real_time_factor'],
            overwrite=values['overwrite'], in_process=values['in_process'],
            compression=values['compression'] or None,
            split_mb=values['split_mb'] if values['split_mb'] >= 0.0 else None,
            namespace=self.get_namespace().strip('/'),
            join_timeout_s=values['join_timeout_s'], is_alone=True)


def _path(text: str) -> Path | None:
    return Path(text) if text else None


def _relative(name: str) -> str:
    """Return a topic of the bag as the node names it, so that namespaces work."""
    return f'~/{name.removeprefix(_OWN)}' if name.startswith(_OWN) else name.removeprefix('/')


class _Events(PreparedPublishers):
    """Events are rare: subscriptions are looked for at each."""

    def is_heard(self) -> bool:
        """Return whether there is a subscription at this moment."""
        self.refresh()
        return super().is_heard()
