"""Warnings about publishers whose quality of service prevents their setpoints from arriving."""

import time

from rclpy.node import Node
from rclpy.qos import qos_check_compatible, QoSCompatibility
from rclpy.subscription import Subscription

PERIOD_S = 1.0


class IncompatiblePublishers:
    """
    Checks the publishers of one subscription's topic.

    rclpy's event reports an incompatible publisher without its name; the graph has the name.
    """

    def __init__(self, node: Node, subscription: Subscription) -> None:
        self._node = node
        self._topic = subscription.topic_name
        self._qos = subscription.qos_profile
        self._checked: set[tuple[int, ...]] = set()
        self._next = 0.0

    def check(self) -> None:
        """Log every new incompatible publisher; reads the graph once per `PERIOD_S`."""
        now = time.monotonic()
        if now < self._next:
            return
        self._next = now + PERIOD_S
        for publisher in self._node.get_publishers_info_by_topic(self._topic):
            identity = tuple(publisher.endpoint_gid)
            if identity in self._checked:
                continue
            self._checked.add(identity)
            compatibility, reason = qos_check_compatible(publisher.qos_profile, self._qos)
            if compatibility == QoSCompatibility.ERROR:
                namespace = publisher.node_namespace.rstrip('/')
                self._node.get_logger().warning(
                    f'{namespace}/{publisher.node_name}: its {self._topic} cannot be received: '
                    f'{reason.strip()}')
