"""Warnings about publishers whose type or quality of service keeps setpoints from arriving."""

import time

from rclpy.node import Node
from rclpy.qos import qos_check_compatible, QoSCompatibility
from rclpy.subscription import Subscription
from rclpy.topic_endpoint_info import TopicEndpointInfo

PERIOD_S = 1.0
_UNKNOWN = '_NODE_NAME_UNKNOWN_'    # of rmw: the graph has a publisher before its node


class IncompatiblePublishers:
    """
    Checks the publishers of one subscription's topic; ``type_`` is the name of its type.

    rclpy's event reports an incompatible publisher without its name, and has none for one of
    another type; the graph has name and type.
    """

    def __init__(self, node: Node, subscription: Subscription, type_: str) -> None:
        self._node = node
        self._topic = subscription.topic_name
        self._qos = subscription.qos_profile
        self._type = type_
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
            if identity in self._checked or publisher.node_name == _UNKNOWN:
                continue
            self._checked.add(identity)
            if reason := self._reason(publisher):
                namespace = publisher.node_namespace.rstrip('/')
                self._node.get_logger().warning(
                    f'{namespace}/{publisher.node_name}: its {self._topic} cannot be received: '
                    f'{reason}')

    def _reason(self, publisher: TopicEndpointInfo) -> str:
        """Return why messages of a publisher do not arrive; '': they do."""
        if publisher.topic_type != self._type:
            return f'it is of type {publisher.topic_type}, must be {self._type}'
        compatibility, reason = qos_check_compatible(publisher.qos_profile, self._qos)
        return str(reason).strip() if compatibility == QoSCompatibility.ERROR else ''
