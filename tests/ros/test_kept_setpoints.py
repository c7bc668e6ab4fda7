"""Commands that a node has kept for later subscriptions, handed to its publishers."""

from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.core.signals import COMMAND, HAS_SETPOINT
from isa_ros.nodes.actuator.node import ActuatorNode, NodeSetup
from isa_ros.nodes.middleware.qos import KEPT
from msg_adapters.cdr_reader import decode
import numpy as np
import pytest
from sensor_msgs.msg import JointState
from tests.ros.driven import noted

pytestmark = pytest.mark.ros

COMMANDS = KEPT.depth + 3
STEP_NS = DEFAULT_TIMING.step_ns


def command(position: float) -> np.void:
    row = np.zeros(1, COMMAND)[0]
    row['kinds'], row['position'] = HAS_SETPOINT, position
    return row


@pytest.mark.parametrize(('is_subscribed', 'expected'), [(True, COMMANDS), (False, KEPT.depth)])
def test_a_new_subscription_gets_all_and_a_later_one_the_last(observer, is_subscribed, expected):
    """Who reads them is asked at that moment; each has the begin of its tick."""
    setup = NodeSetup(default_actuator('isa_v5', 'kfe'), DEFAULT_TIMING)
    node = ActuatorNode(lambda _: setup, 'kfe', has_mailbox=True, context=observer.context,
                        enable_rosout=False)
    applied = node.actuator.memory.applied
    applied[0] = command(0.07)
    messages: list[tuple[int, bytes]] = []
    noted(node.outlet, is_subscribed, messages)
    node.outlet.is_subscribed = not is_subscribed   # as it was when last counted
    node.publish_commands([(k * STEP_NS, command(0.01 + 1e-4 * k))
                           for k in range(1, COMMANDS + 1)])
    found = [decode(data, JointState) for _, data in messages]
    numbers = range(COMMANDS + 1 - expected, COMMANDS + 1)
    assert [own.position[0] for own in found] == [0.01 + 1e-4 * k for k in numbers]
    assert [own.header.stamp.nanosec for own in found] == [(k - 1) * STEP_NS for k in numbers]
    assert applied['position'].tolist() == [0.07]
    node.destroy_node()
