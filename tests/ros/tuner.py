"""A user's node that tunes an actuator by the services of its parameters."""

from typing import Any

from rcl_interfaces.msg import Parameter, ParameterEvent, ParameterType, ParameterValue
from rcl_interfaces.srv import (
    DescribeParameters, GetParameters, SetParameters, SetParametersAtomically)
from rclpy.node import Node
from sensor_msgs.msg import JointState
from tests.ros.spinning import Spinning


class Tuner:
    """A user's node for tuning one actuator: the standard services, its state, two echoes."""

    def __init__(self, node: Node, name: str) -> None:
        self.name = name
        self.node = node
        self.events: list[ParameterEvent] = []
        self.setpoints: list[JointState] = []
        self.state: list[JointState] = []
        node.create_subscription(JointState, f'/{name}/joint_states', self.state.append, 10)
        node.create_subscription(
            ParameterEvent, f'/{name}/applied_parameters', self.events.append, 10)
        node.create_subscription(
            JointState, f'/{name}/applied_setpoint', self.setpoints.append, 10)
        self._spinning = Spinning(node)
        self.wait_for = self._spinning.wait_for
        self._clients = {
            service: node.create_client(service, f'/{name}/{topic}') for service, topic in (
                (SetParameters, 'set_parameters'), (GetParameters, 'get_parameters'),
                (SetParametersAtomically, 'set_parameters_atomically'),
                (DescribeParameters, 'describe_parameters'))}

    def connect(self) -> None:
        """Wait until the services are available and the state arrives."""
        self.wait_for(
            lambda: self.state and all(
                client.service_is_ready() for client in self._clients.values()), 'connection')

    def let_run(self) -> None:
        """Wait for 0.1 s of simulation, longer than the queue of the state."""
        begin = nanoseconds(self.state[-1].header.stamp)
        self.wait_for(
            lambda: nanoseconds(self.state[-1].header.stamp) - begin > 100_000_000,
            'simulated time')

    def call(self, request: Any) -> Any:
        """Return the answer to a request."""
        service = next(s for s in self._clients if isinstance(request, s.Request))
        future = self._clients[service].call_async(request)
        self.wait_for(future.done, 'the answer')
        return future.result()

    def tune(self, name: str, value: float) -> Any:
        """Set one parameter and return the result."""
        return self.call(SetParameters.Request(parameters=[double(name, value)])).results[0]

    def get(self, *names: str) -> list[float]:
        """Return the values of parameters."""
        return [v.double_value for v in self.call(GetParameters.Request(names=names)).values]


def nanoseconds(stamp: Any) -> int:
    return int(stamp.sec) * 10**9 + int(stamp.nanosec)


def double(name: str, value: float) -> Parameter:
    return Parameter(name=name, value=ParameterValue(
        type=ParameterType.PARAMETER_DOUBLE, double_value=value))


def string(name: str, value: str) -> Parameter:
    return Parameter(name=name, value=ParameterValue(
        type=ParameterType.PARAMETER_STRING, string_value=value))
