"""Publishers of serialised messages, for topics with a subscription only."""

from collections.abc import Sequence
from typing import Any

from isa_ros.nodes.middleware.qos import STATE
from isa_ros.run.packing import Messages
from msg_adapters.cdr_reader import message_class
from rclpy.node import Node

_REFRESH_TICKS = 20  # a new subscription is noticed within that many ticks


class PreparedPublishers:
    """
    An `Outlet` with one publisher per topic, (name, type), in the order of the messages.

    Messages of publishers without a matched subscription are not passed to the middleware: eight
    of them would take 36 us per tick.
    """

    def __init__(self, node: Node, topics: Sequence[tuple[str, str]]) -> None:
        self._publishers = [
            node.create_publisher(message_class(type_), name, STATE) for name, type_ in topics]
        self._handles: list[Any] = [publisher.handle for publisher in self._publishers]
        self._subscribed: list[tuple[int, Any]] = []
        self._countdown = 0

    def has_subscribers(self) -> bool:
        """Return whether there is a subscription; call this once per tick."""
        if self._countdown == 0:
            self.refresh()
        self._countdown -= 1
        return bool(self._subscribed)

    def publish(self, messages: Messages) -> None:
        """Publish the messages that are not None on the topics with a subscription."""
        for slot, publish_raw in self._subscribed:
            message = messages[slot]
            if message is not None:
                publish_raw(message)

    def refresh(self) -> None:
        """Count the subscriptions again."""
        self._countdown = _REFRESH_TICKS
        self._subscribed = [
            (slot, handle.publish_raw) for slot, handle in enumerate(self._handles)
            if handle.get_subscription_count()]
