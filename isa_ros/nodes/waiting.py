"""
Waiting for one subscription, and serving the rest of a node between two ticks.

An executor of rclpy builds its wait set anew on every spin, which is most of the time of a
tick. Here one wait set lives as long as its subscription, and setpoints and services are
taken directly when there is time for them. Both use rclpy's semi-private handles; where
these have changed, an `EventsExecutor` does the same a little slower.
"""

from collections import deque
from collections.abc import Sequence
import time
from typing import Any, Protocol

from isa_ros.nodes.qos import LOCKSTEP
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from rclpy.service import Service
from rclpy.subscription import Subscription
from std_msgs.msg import UInt8MultiArray

SLICE_S = 0.1
"""Longest wait in one piece: a signal handler of Python runs between two pieces."""

LOOK_S = 0.1
"""Host time between two looks at the wire's topics while sockets carry its ticks."""

SERVICE_PERIOD_S = 0.005
"""Host time between two looks at a node's services; a setpoint is looked for at every tick."""

SELDOM_PERIOD_S = 0.05
"""The same for services that need not answer at once: a parameter's."""

_NS_PER_SECOND = 1_000_000_000


class Mailbox(Protocol):
    """The messages of one topic of the private wire, as bytes."""

    def wait(self, timeout_s: float) -> bytes | None:
        """Return the next message, or None if none arrives within ``timeout_s``."""
        ...

    def take(self) -> bytes | None:
        """Return the next message if there is one."""
        ...

    def count_senders(self) -> int:
        """Return how many publishers are matched at this moment."""
        ...


class Server(Protocol):
    """The setpoints and services of one node."""

    def serve(self) -> None:
        """Run the callbacks of everything that has arrived; do not wait."""
        ...


class WaitSetMailbox:
    """A subscription with a wait set of its own."""

    def __init__(self, node: Node, topic: str) -> None:
        self._subscription = node.create_subscription(
            UInt8MultiArray, topic, _unexpected, LOCKSTEP, raw=True)
        handle: Any = self._subscription.handle
        self._take: Any = handle.take_message
        self._handle = handle
        self._wait_set: Any = _rclpy.WaitSet(1, 0, 0, 0, 0, 0, node.context.handle)

    def wait(self, timeout_s: float) -> bytes | None:
        """Return the next message, or None if none arrives within ``timeout_s``."""
        # It returns at once while there is a message; to look before it is mostly in vain.
        wait_set = self._wait_set
        wait_set.clear_entities()
        wait_set.add_subscription(self._handle)
        wait_set.wait(int(timeout_s * _NS_PER_SECOND))
        return self.take()

    def take(self) -> bytes | None:
        """Return the next message if there is one."""
        taken = self._take(UInt8MultiArray, True)
        return None if taken is None else taken[0]

    def count_senders(self) -> int:
        """Return how many publishers are matched at this moment."""
        return int(self._handle.get_publisher_count())


class DirectServer:
    """Take what has arrived from the handles themselves, in the order given."""

    def __init__(
            self, subscriptions: Sequence[Subscription], services: Sequence[Service],
            seldom: Sequence[Service] = ()) -> None:
        self._subscriptions: list[Any] = [
            (s.handle.take_message, s.msg_type, s.callback) for s in subscriptions]
        self._services, self._seldom = _taken(services), _taken(seldom)
        self._services_due = self._seldom_due = 0.0

    def serve(self) -> None:
        """Run the callbacks of everything that has arrived; do not wait."""
        self._serve_subscriptions()
        now = time.monotonic()
        if now >= self._services_due:  # an empty look costs 5 us, a sixth of an actuator's tick
            self._services_due = now + SERVICE_PERIOD_S
            _serve(self._services)
        if now >= self._seldom_due:
            self._seldom_due = now + SELDOM_PERIOD_S
            _serve(self._seldom)

    def _serve_subscriptions(self) -> None:
        for take_message, message_type, callback in self._subscriptions:
            # As bytes: an empty take would cost a message object all the same.
            while (taken := take_message(message_type, True)) is not None:
                callback(deserialize_message(taken[0], message_type))


def _taken(services: Sequence[Service]) -> list[Any]:
    return [(s.handle.service_take_request, s.srv_type, s) for s in services]


def _serve(services: Sequence[Any]) -> None:
    for take_request, service_type, service in services:
        while True:
            request, header = take_request(service_type.Request)
            if header is None:
                break
            service.send_response(
                service.callback(request, service_type.Response()), header)


class ExecutorMailbox:
    """The same on an executor that also serves the node's other subscriptions."""

    def __init__(self, node: Node, topic: str) -> None:
        self._messages: deque[bytes] = deque()
        self._subscription = node.create_subscription(
            UInt8MultiArray, topic, self._on_message, LOCKSTEP, raw=True)
        self._executor: Any = EventsExecutor(context=node.context)
        self._executor.add_node(node)

    def _on_message(self, message: bytes) -> None:
        self._messages.append(message)

    def wait(self, timeout_s: float) -> bytes | None:
        """Return the next message, or None if none arrives within ``timeout_s``."""
        if not self._messages:
            self._executor.spin_once(timeout_s)
        return self._messages.popleft() if self._messages else None

    def take(self) -> bytes | None:
        """Return the next message if there is one."""
        return self.wait(0.0)

    def count_senders(self) -> int:
        """Return how many publishers are matched at this moment."""
        handle: Any = self._subscription.handle
        return int(handle.get_publisher_count())


class ExecutorServer:
    """
    Serve a node on an executor of its own, unless its mailbox's executor already does.

    ``node`` is None where it does.
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


def has_handles() -> bool:
    """Return whether rclpy has the semi-private handles that `WaitSetMailbox` uses."""
    needed = {
        'WaitSet': ('clear_entities', 'add_subscription', 'wait'),
        'Subscription': ('take_message', 'get_publisher_count'),
        'Service': ('service_take_request',),
    }
    return all(hasattr(getattr(_rclpy, owner, None), name)
               for owner, names in needed.items() for name in names)


def open_mailbox(node: Node, topic: str) -> Mailbox:
    """Subscribe ``node`` to one topic of the private wire."""
    return WaitSetMailbox(node, topic) if has_handles() else ExecutorMailbox(node, topic)


def open_server(
        node: Node, subscriptions: Sequence[Subscription], services: Sequence[Service],
        seldom: Sequence[Service], has_mailbox: bool) -> Server:
    """
    Return what serves the node between ticks; ``has_mailbox``: it waits for steps itself.

    ``seldom`` are services that are looked at less often.
    """
    if has_handles():
        return DirectServer(subscriptions, services, seldom)
    return ExecutorServer(None if has_mailbox else node)


def _unexpected(message: bytes) -> None:
    """Stand where rclpy asks for a callback; the mailbox takes the messages itself."""
    raise RuntimeError('a mailbox must not be added to an executor')
