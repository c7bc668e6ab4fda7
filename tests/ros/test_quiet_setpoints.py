"""Setpoints of quiet ticks on topics of nodes in this process, for subscriptions of any time."""

from collections.abc import Iterator

from isa_ros.config.assembly import timing_of
from isa_ros.nodes.actuator.node import ActuatorNode, NodeSetup
from isa_ros.nodes.middleware.qos import KEPT
from isa_ros.run.outlets import Outlets
from isa_ros.run.output import packer_of, RunOutput
from isa_ros.scripting.run import load
from isa_ros.simulation import Simulation
import pytest
from rclpy.node import Node
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState
from tests.ros.spinning import Spinning

pytestmark = pytest.mark.ros
PATIENT = QoSProfile(depth=100, durability=KEPT.durability)
"""Of a subscription that has room for all of the ticks."""


@pytest.fixture
def leg(observer: Node) -> Iterator[Simulation]:
    """Return a leg that trots, whose actuators have nodes in this process."""
    simulation = load('leg', scenario='trot_leg').simulation()
    run, rows = simulation.scenario.run, simulation.loop.rows
    nodes = [ActuatorNode(
        lambda _, own=own, actuator=actuator: NodeSetup(own, timing_of(run), actuator),
        own.name, has_mailbox=False, context=observer.context, enable_rosout=False)
        for own, actuator in zip(run.actuators, simulation.group.actuators)]
    simulation.loop.sinks = (RunOutput(
        packer_of(run, rows.published), run.step_ns, None,
        Outlets(actuators=[node.outlet for node in nodes])),)
    simulation.loop.begin()
    yield simulation
    for node in nodes:
        node.destroy_node()


def test_a_later_subscription_receives_the_last_ones_and_then_each(
        observer: Node, leg: Simulation) -> None:
    """Of a call that nobody heard the last ten; then every tick is one of Python."""
    loop = leg.loop
    loop.advance()
    loop.advance_quietly(41)
    assert loop.ticks == 41
    heard: list[int] = []
    own = observer.create_subscription(
        JointState, '/hfe/applied_setpoint',
        lambda message: heard.append(message.header.stamp.nanosec // 1_000_000), PATIENT)
    spinning = Spinning(observer)
    spinning.wait_for(lambda: len(heard) == KEPT.depth, 'the last setpoints')
    assert heard == list(range(41 - KEPT.depth, 41))    # each has the begin of its tick
    loop.advance_quietly(61)
    assert loop.ticks == 41
    for _ in range(20):
        loop.advance()
    spinning.wait_for(lambda: len(heard) == KEPT.depth + 20, 'those of the next ticks')
    assert heard == list(range(41 - KEPT.depth, 61))
    observer.destroy_subscription(own)
