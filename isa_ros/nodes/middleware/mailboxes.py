"""
Mailboxes: receive the messages of one topic of the private wire.

An executor of rclpy builds a new wait set on every spin, which takes most of the time of a tick.
Here one wait set is kept as long as its subscription. It uses rclpy's semi-private handles; with
a version of rclpy without them, a slightly slower `EventsExecutor` is used.
"""

from collections import deque
from typing import Any, Protocol

from isa_ros.nodes.middleware.handles import has_handles
from isa_ros.nodes.middleware.qos import LOCKSTEP
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from std_msgs.msg import UInt8MultiArray

SLICE_S = 0.1
"""Longest single wait: Python runs signal handlers between two waits."""

TOPIC_CHECK_S = 0.1
"""Host time between two checks of the wire's topics while the ticks use sockets."""

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
        """Return the number of matched publishers."""
        ...


class WaitSetMailbox:
    """A mailbox with a wait set of its own."""

    def __init__(self, node: Node, topic: str) -> None:
        self._subscription = node.create_subscription(
            UInt8MultiArray, topic, _unexpected, LOCKSTEP, raw=True)
        handle: Any = self._subscription.handle
        self._take: Any = handle.take_message
        self._handle = handle
        self._wait_set: Any = _rclpy.WaitSet(1, 0, 0, 0, 0, 0, node.context.handle)

    def wait(self, timeout_s: float) -> bytes | None:
        """Return the next message, or None if none arrives within ``timeout_s``."""
        # The wait returns at once if there is a message; a check before it would rarely find one.
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
        """Return the number of matched publishers."""
        return int(self._handle.get_publisher_count())


class ExecutorMailbox:
    """A mailbox with an executor that also serves the node's other subscriptions."""

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
        """Return the number of matched publishers."""
        handle: Any = self._subscription.handle
        return int(handle.get_publisher_count())


def open_mailbox(node: Node, topic: str) -> Mailbox:
    """Subscribe ``node`` to one topic of the private wire."""
    return WaitSetMailbox(node, topic) if has_handles() else ExecutorMailbox(node, topic)


def _unexpected(message: bytes) -> None:
    """Raise an error: rclpy requires a callback, but the mailbox takes the messages itself."""
    raise RuntimeError('a mailbox must not be added to an executor')
