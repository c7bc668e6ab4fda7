"""Publish prepared bytes where there is a subscription, and spend nothing where there is none."""

from collections.abc import Sequence
from typing import Any

from isa_ros.nodes.middleware.qos import STATE
from isa_ros.run.packing import Messages
from msg_adapters.cdr_reader import message_class
from rclpy.node import Node

_REFRESH_TICKS = 20  # a new subscription is noticed within that many ticks


class PreparedPublishers:
    """
    One publisher per topic, (name, type) each, in the order of the messages.

    A publisher without matched subscription cannot reach anyone, so its message is not
    even handed to the middleware: eight of them would cost 36 us a tick.
    """

    def __init__(self, node: Node, topics: Sequence[tuple[str, str]]) -> None:
        self._publishers = [
            node.create_publisher(message_class(type_), name, STATE) for name, type_ in topics]
        self._handles: list[Any] = [publisher.handle for publisher in self._publishers]
        self._listened: list[tuple[int, Any]] = []
        self._countdown = 0

    def is_heard(self) -> bool:
        """Return whether there is a subscription; to be asked once a tick."""
        if self._countdown == 0:
            self.refresh()
        self._countdown -= 1
        return bool(self._listened)

    def send(self, messages: Messages) -> None:
        """Publish what is not None to those subscriptions that `is_heard` found."""
        for slot, publish_raw in self._listened:
            message = messages[slot]
            if message is not None:
                publish_raw(message)

    def refresh(self) -> None:
        """Look anew for subscriptions."""
        self._countdown = _REFRESH_TICKS
        self._listened = [
            (slot, handle.publish_raw) for slot, handle in enumerate(self._handles)
            if handle.get_subscription_count()]
