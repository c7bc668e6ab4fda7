"""
Servers: process the setpoints and service requests of a node between two ticks.

They are taken directly from rclpy's semi-private handles; with a version of rclpy without them,
a slightly slower `EventsExecutor` is used.
"""

from collections.abc import Callable, Sequence
import time
from typing import Any, Protocol

from isa_ros.nodes.middleware.handles import has_handles
from msg_adapters.joint_state import is_whole
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from rclpy.service import Service
from rclpy.subscription import Subscription
from sensor_msgs.msg import JointState

SERVICE_PERIOD_S = 0.005
"""Host time between two checks of a node's services; setpoints are checked at every tick."""

SELDOM_PERIOD_S = 0.05
"""The same for services that need not answer at once: those of parameters."""

WARNING_PERIOD_S = 10.0

_NOT_OF_ITS_TYPE = (_rclpy.RCLError, _rclpy.RMWError)


class Server(Protocol):
    """The setpoints and services of one node."""

    def serve(self) -> None:
        """Run the callbacks of everything that has arrived; do not wait."""
        ...


class DirectServer:
    """
    Takes messages and requests from the handles, in the order of the arguments.

    ``is_over``: whether further requests wait for another call, as after one that ends a run.
    """

    def __init__(
            self, log: RcutilsLogger, subscriptions: Sequence[Subscription],
            services: Sequence[Service], seldom: Sequence[Service] = (),
            is_over: Callable[[], bool] = lambda: False) -> None:
        self._log, self._is_over = log, is_over
        self._subscriptions: list[Any] = [
            (s.handle.take_message, s.msg_type, s) for s in subscriptions]
        self._services, self._seldom = _taken(services), _taken(seldom)
        self._services_due = self._seldom_due = 0.0

    def serve(self) -> None:
        """Run the callbacks of everything that has arrived; do not wait."""
        self._serve_subscriptions()
        now = time.monotonic()
        if now >= self._services_due:  # a check takes 5 us, a sixth of an actuator's tick
            self._services_due = now + SERVICE_PERIOD_S
            self._serve(self._services)
        if now >= self._seldom_due:
            self._seldom_due = now + SELDOM_PERIOD_S
            self._serve(self._seldom)

    def _serve_subscriptions(self) -> None:
        for take_message, message_type, subscription in self._subscriptions:
            # As bytes: otherwise a message object is created even if there is no message.
            while (taken := take_message(message_type, True)) is not None:
                if message_type is JointState and not is_whole(taken[0]):
                    self._discard(f'a message on {subscription.topic_name}')
                    continue
                try:
                    message = deserialize_message(taken[0], message_type)
                except _NOT_OF_ITS_TYPE:  # bytes of a publisher of serialised messages
                    self._discard(f'a message on {subscription.topic_name}')
                    continue
                subscription.callback(message)

    def _serve(self, services: Sequence[Any]) -> None:
        for take_request, service_type, service in services:
            while not self._is_over():
                try:
                    request, header = take_request(service_type.Request)
                except _NOT_OF_ITS_TYPE:
                    self._discard(f'a request to {service.srv_name}')
                    break
                if header is None:
                    break
                service.send_response(
                    service.callback(request, service_type.Response()), header)

    def _discard(self, what: str) -> None:
        self._log.warning(
            f'{what} is discarded: its bytes are not of its type',
            throttle_duration_sec=WARNING_PERIOD_S)


def _taken(services: Sequence[Service]) -> list[Any]:
    return [(s.handle.service_take_request, s.srv_type, s) for s in services]


class ExecutorServer:
    """
    Serves a node with its own executor, unless its mailbox's executor already does.

    ``node``: None if the mailbox's executor serves it.
    """

    def __init__(self, node: Node | None) -> None:
        self._executor: Any = None
        if node is not None:
            self._executor = EventsExecutor(context=node.context)
            self._executor.add_node(node)

    def serve(self) -> None:
        """Run the callbacks of everything that has arrived; do not wait."""
        if self._executor is not None:
            self._executor.spin_once(0.0)


def open_server(
        node: Node, subscriptions: Sequence[Subscription], services: Sequence[Service],
        seldom: Sequence[Service], has_mailbox: bool) -> Server:
    """
    Return the server of a node between ticks; ``has_mailbox``: the node also has a mailbox.

    ``seldom`` are services that are checked less often.
    """
    if has_handles():
        return DirectServer(node.get_logger(), subscriptions, services, seldom)
    return ExecutorServer(None if has_mailbox else node)
