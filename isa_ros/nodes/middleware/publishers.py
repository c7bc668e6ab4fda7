"""Publishers of serialised messages, for topics with a subscription only."""

from collections.abc import Collection, Sequence
from typing import Any

from isa_ros.core.topic import Topic
from isa_ros.nodes.middleware.qos import KEPT, STATE
from isa_ros.run.packing import Messages
from msg_adapters.cdr_reader import message_class
from rclpy.node import Node

_REFRESH_TICKS = 20  # a new subscription is noticed within that many ticks


class PreparedPublishers:
    """
    An `Outlet` with one publisher per topic, in the order of the messages.

    Messages of publishers without a matched subscription are not passed to the middleware: eight
    of them would take 36 us per tick. Those of a topic that is kept always are.
    """

    def __init__(self, node: Node, topics: Sequence[Topic]) -> None:
        self._publishers = [
            node.create_publisher(
                message_class(topic.type_name), topic.name, KEPT if topic.qos.is_kept else STATE)
            for topic in topics]
        self._handles: list[Any] = [publisher.handle for publisher in self._publishers]
        self._is_kept = [topic.qos.is_kept for topic in topics]
        self.refresh()
        self._countdown = 0

    def has_subscribers(self) -> bool:
        """Return whether there is a subscription; call this once per tick."""
        if self._countdown == 0:
            self.refresh()
        self._countdown -= 1
        return self.is_subscribed

    def skip(self, n_ticks: int) -> None:
        """Pass so many ticks without a message."""
        self._countdown = max(0, self._countdown - n_ticks)

    def publish(self, messages: Messages) -> None:
        """Publish the messages that are not None: on topics with a subscription, and kept ones."""
        for slot, publish_raw in self._passed:
            message = messages[slot]
            if message is not None:
                publish_raw(message)

    def refresh(self) -> None:
        """Count the subscriptions again."""
        self._countdown = _REFRESH_TICKS
        subscribed = [bool(handle.get_subscription_count()) for handle in self._handles]
        self.is_subscribed = any(subscribed)
        """Whether there was a subscription when they were last counted."""
        self.wanted: Collection[int] | None = [
            slot for slot, is_kept in enumerate(self._is_kept) if subscribed[slot] or is_kept]
        """Places of the messages that are passed to the middleware."""
        self._passed: list[tuple[int, Any]] = [
            (slot, self._handles[slot].publish_raw) for slot in self.wanted]
