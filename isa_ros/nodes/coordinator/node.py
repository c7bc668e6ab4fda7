"""ROS 2 face of the run: time, leg and supply on topics."""

from collections.abc import Sequence
from typing import Any

from isa_ros.errors import ConfigError
from isa_ros.nodes.coordinator.services import REAL_TIME_FACTOR
from isa_ros.nodes.middleware.publishers import PreparedPublishers
from isa_ros.nodes.middleware.refusals import refusals
from isa_ros.run.exchange import Messages
from isa_ros.run.options import Option, OPTIONS, Request, request_of_parameters
from isa_ros.surroundings.surroundings import CLOCK_TOPIC, EVENT_TOPIC
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter

NAME = 'coordinator'
_OWN = f'/{NAME}/'


class CoordinatorNode(Node):
    """Publish what the coordinator of a run has to say."""

    def __init__(self, **kwargs: Any) -> None:
        with refusals():
            super().__init__(NAME, start_parameter_services=False, **kwargs)
        self._time = PreparedPublishers(self, [CLOCK_TOPIC])
        self._events = PreparedPublishers(self, [(_relative(EVENT_TOPIC[0]), EVENT_TOPIC[1])])
        self._shown: PreparedPublishers | None = None

    def advertise(self, topics: Sequence[tuple[str, str]]) -> None:
        """Advertise the topics of the shared load, (name in the bag, type) each."""
        self._shown = PreparedPublishers(
            self, [(_relative(name), type_) for name, type_ in topics])

    def publish(self, messages: Messages) -> None:
        """Publish the messages of the shared load to whoever listens."""
        if self._shown is not None:
            self._shown.publish(messages)

    def publish_clock(self, clock: bytes) -> None:
        """Publish `/clock`."""
        self._time.publish((clock,))

    def publish_event(self, event: bytes) -> None:
        """Publish what was done to the run."""
        self._events.refresh()
        self._events.publish((event,))

    def request(self) -> Request:
        """
        Declare the parameters of a run and return what they ask for.

        Raises
        ------
        ConfigError
            No configuration is named.

        """
        values = {option.parameter: self._declared(option)
                  for option in OPTIONS if option.is_parameter}
        if not values['config_file']:
            raise ConfigError(f'{NAME}: set the parameter config_file')
        return request_of_parameters(
            values, namespace=self.get_namespace().strip('/'), is_alone=True)

    def _declared(self, option: Option) -> Any:
        """Declare the parameter of an option and return its value."""
        default = option.parameter_default
        return self.declare_parameter(
            option.parameter, Parameter.Type.STRING_ARRAY if default is None else default,
            ParameterDescriptor(description=option.description,
                                read_only=option.parameter != REAL_TIME_FACTOR)).value


def _relative(name: str) -> str:
    """Return a topic of the bag as the node names it, so that namespaces work."""
    return f'~/{name.removeprefix(_OWN)}' if name.startswith(_OWN) else name.removeprefix('/')
