"""ROS 2 node of the coordinator: time, events, supplies and body on topics."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.topic import Topic
from isa_ros.errors import ConfigError
from isa_ros.nodes.coordinator.parameters import SupplyParameters
from isa_ros.nodes.coordinator.services import REAL_TIME_FACTOR, STEP_COUNT
from isa_ros.nodes.middleware.parameters import declare, refuse_unknown
from isa_ros.nodes.middleware.publishers import PreparedPublishers
from isa_ros.nodes.middleware.refusals import refusals
from isa_ros.run.option import Option
from isa_ros.run.options import OPTIONS, Request, request_of_parameters
from isa_ros.run.outlets import Outlet, Outlets
from msg_adapters import clock, event
from msg_adapters.optional import is_installed, TRANSFORMS
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter

NAME = 'coordinator'
_OWN = f'/{NAME}/'


class CoordinatorNode(Node):
    """Publish time, events, supplies and body of a run."""

    def __init__(self, **kwargs: Any) -> None:
        self.supplies: SupplyParameters | None = None
        """Parameters of the supplies, once there is a run."""
        with refusals():
            super().__init__(NAME, start_parameter_services=False, **kwargs)
        self._time = PreparedPublishers(
            self, [Topic(_relative(clock.TOPIC[0]), clock.TOPIC[1])])
        self._events = _Events(
            self, [Topic(_relative(event.TOPIC[0]), event.TOPIC[1])])

    def get_parameter(self, name: str) -> Parameter:
        """Return a parameter; of a supply its current value, set by a service or a fault."""
        changed = None if self.supplies is None else self.supplies.get(name)
        return super().get_parameter(name) if changed is None else changed

    def outlets(self, surroundings: Sequence[Topic], actuators: Sequence[Outlet]) -> Outlets:
        """
        Create the publishers of supplies and body, and return all publishers of a run.

        ``actuators`` are those of the actuators in this process; empty if their own nodes publish.
        """
        topics = [replace(topic, name=_relative(topic.name)) for topic in surroundings]
        return Outlets(self._time, self._events, self._published(topics), actuators)

    def _published(self, topics: Sequence[Topic]) -> PreparedPublishers:
        """Create the publishers of supplies and body, with transforms where they may be."""
        if not is_installed(TRANSFORMS):
            return PreparedPublishers(self, topics)
        from isa_ros.nodes.coordinator.transforms import TransformPublishers
        return TransformPublishers(self, topics)

    def show_fixed(self, run: RunConfig) -> None:
        """Publish where the fixed roots of robots are, as long as this node is."""
        if is_installed(TRANSFORMS):
            from isa_ros.nodes.coordinator.transforms import publish_fixed
            self._fixed = publish_fixed(self, run)

    def request(self) -> Request:
        """
        Declare the parameters of a run and return the request they describe.

        Raises
        ------
        ConfigError
            A parameter is unknown or has a wrong type, or config_file is not set.

        """
        values = {option.parameter: self._declared(option)
                  for option in OPTIONS if option.is_parameter}
        refuse_unknown(self, (STEP_COUNT,))
        if not values['config_file']:
            raise ConfigError(f'{NAME}: set the parameter config_file')
        return request_of_parameters(
            values, namespace=self.get_namespace().strip('/'), is_alone=True)

    def _declared(self, option: Option) -> Any:
        """Declare the parameter of an option and return its value."""
        default = option.parameter_default
        return declare(
            self, option.parameter, Parameter.Type.STRING_ARRAY if default is None else default,
            ParameterDescriptor(description=option.description,
                                read_only=option.parameter != REAL_TIME_FACTOR))


def _relative(name: str) -> str:
    """Return the node's relative name of a topic of the bag, so that namespaces work."""
    return f'~/{name.removeprefix(_OWN)}' if name.startswith(_OWN) else name.removeprefix('/')


class _Events(PreparedPublishers):
    """Publisher of events; they are rare, so that subscriptions are counted at each."""

    def has_subscribers(self) -> bool:
        """Return whether there is a subscription now."""
        self.refresh()
        return super().has_subscribers()
