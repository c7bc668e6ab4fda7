"""Inertial units of the leg on topics of the coordinator's node."""

import isa_ros
from isa_ros.nodes.coordinator.node import CoordinatorNode
from isa_ros.run.output import packer_of, RunOutput
import pytest
from rclpy.node import Node
from sensor_msgs.msg import Imu
from tests.ros.spinning import Spinning

pytestmark = pytest.mark.ros


def test_a_unit_publishes_its_readings_at_its_own_rate(observer: Node) -> None:
    """Of 50 ms: at t = 0 and every 10 ms, in its own frame."""
    simulation = isa_ros.load('leg').replace(
        {'leg.imus': {'kfe': {'link': 'thigh'}}}).simulation()
    run = simulation.scenario.run
    packer = packer_of(run, simulation.loop.rows.published)
    node = CoordinatorNode(context=observer.context, enable_rosout=False)
    try:
        heard: list[Imu] = []
        observer.create_subscription(Imu, '/kfe/imu', heard.append, 10)
        outlets = node.outlets(packer.surroundings, ())
        spinning = Spinning(observer)

        def is_matched() -> bool:
            outlets.surroundings.refresh()
            return outlets.surroundings.has_subscribers()

        spinning.wait_for(is_matched, 'a match')
        output = RunOutput(packer, run.step_ns, outlets=outlets)
        expected = []
        for _ in range(51):
            output.take(simulation.ticks, simulation.loop.rows)
            if simulation.ticks % 10 == 0:
                expected.append(simulation.body_sample.kfe_specific_force.tolist())
            simulation.step()
        spinning.wait_for(lambda: len(heard) == len(expected), 'six readings')
        assert [message.header.stamp.nanosec for message in heard] == [
            10_000_000 * k for k in range(6)]
        assert {message.header.frame_id for message in heard} == {'kfe_imu'}
        forces = [message.linear_acceleration for message in heard]
        assert [[force.x, force.y, force.z] for force in forces] == expected
    finally:
        node.destroy_node()
