"""
Where the roots of the robots of a run are in the world, for rviz: ``tf`` and ``tf_static``.

Both are in the namespace of the run, with the frames of all its robots, each behind its prefix; a
robot_state_publisher adds the joints. Nothing of them is recorded: ``tf`` repeats what odometry
says, ``tf_static`` what the run file says. They need the package tf2_msgs.
"""

from collections.abc import Sequence

from isa_ros.config.robots.start import robot_start
from isa_ros.config.runs.robot_config import RobotConfig
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.topic import Topic
from isa_ros.nodes.middleware.publishers import PreparedPublishers
from isa_ros.nodes.middleware.qos import FIXED, MOVING
from isa_ros.run.packing import Messages
from msg_adapters.coordinator_messages import WORLD_FRAME
from msg_adapters.odometry import TYPE as ODOMETRY
from msg_adapters.transform import fixed_transform, transform_of
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.serialization import deserialize_message
from tf2_msgs.msg import TFMessage


class TransformPublishers(PreparedPublishers):
    """Publishers of topics, and of the transforms of those that are odometry."""

    def __init__(self, node: Node, topics: Sequence[Topic]) -> None:
        self._moving = node.create_publisher(TFMessage, 'tf', MOVING)
        self._slots = [slot for slot, own in enumerate(topics) if own.type_name == ODOMETRY]
        super().__init__(node, topics)

    def refresh(self) -> None:
        """Count the subscriptions again; as of `PreparedPublishers`."""
        super().refresh()
        self._is_followed = bool(self._slots and self._moving.get_subscription_count())
        if self._is_followed:
            self.is_subscribed = True
            self.wanted = sorted({*(self.wanted or ()), *self._slots})

    def publish(self, messages: Messages) -> None:
        """Publish the messages, and all transforms in one message if somebody follows them."""
        super().publish(messages)
        if not self._is_followed:
            return
        found = [message for slot in self._slots if (message := messages[slot]) is not None]
        if found:
            self._moving.publish(TFMessage(transforms=[
                transform_of(deserialize_message(message, Odometry)) for message in found]))


def publish_fixed(node: Node, run: RunConfig) -> Publisher | None:
    """
    Publish where the fixed roots of a run are, and return what keeps them for later subscriptions.

    None: there is no such root, but the world itself.
    """
    found = []
    for body in run.bodies:
        if not isinstance(body, RobotConfig) or body.sheet.is_free:
            continue
        root = f'{body.prefix}{body.sheet.links[0].name}'
        if root != WORLD_FRAME:
            start = robot_start(body.start, body.tree, body.sheet.contacts, body.passive)
            found.append(fixed_transform(WORLD_FRAME, root, start.position, start.quaternion))
    if not found:
        return None
    publisher = node.create_publisher(TFMessage, 'tf_static', FIXED)
    publisher.publish(TFMessage(transforms=found))
    return publisher
