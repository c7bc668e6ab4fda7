"""Setpoints that arrive between two ticks: none is pushed out of the queue by another."""

import math

from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.nodes.actuator.node import ActuatorNode, NodeSetup
import pytest
from rclpy.duration import Duration
from sensor_msgs.msg import JointState
from tests.ros.started import wait_for

pytestmark = pytest.mark.ros


def test_a_valid_one_is_in_force_whatever_arrives_behind_it(observer):
    """The last valid position, with a gain of the one before; what is refused changes nothing."""
    setup = NodeSetup(default_actuator('isa_v5', 'kfe'), DEFAULT_TIMING)
    node = ActuatorNode(lambda _: setup, 'kfe', has_mailbox=True, context=observer.context,
                        enable_rosout=False)
    publisher = observer.create_publisher(JointState, '/kfe/setpoint', 50)
    wait_for(lambda: publisher.get_subscription_count() == 1 and node.is_commanded, 'a match')
    publisher.publish(JointState(name=['kfe', 'kfe/stiffness'], position=[0.03, 1.5e5]))
    publisher.publish(JointState(name=['kfe'], position=[0.04]))
    for name, position in (('other', 0.05), ('kfe', math.nan), ('kfe', 9.0)) * 10:
        publisher.publish(JointState(name=[name], position=[position]))
    assert publisher.wait_for_all_acked(Duration(seconds=20.0))
    node.serve()
    node.actuator.tick()
    applied, = node.actuator.memory.applied
    assert (applied['position'], applied['stiffness']) == (0.04, 1.5e5)
    node.destroy_node()
