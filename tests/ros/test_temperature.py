"""The temperature of the oil on a topic of the actuator's node."""

from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.config.runs.run_config import ActuatorConfig
from isa_ros.nodes.actuator.node import ActuatorNode, NodeSetup
import pytest
from rclpy.node import Node
from sensor_msgs.msg import Temperature
from tests.ros.spinning import Spinning
from tests.sheets import actuator_sheet

pytestmark = pytest.mark.ros


def knee(*variants: str) -> ActuatorConfig:
    """Return an ISA v5 with some variants."""
    own = default_actuator('isa_v5', 'knee')
    sheet = actuator_sheet('isa_v5', 'default', *variants)
    return ActuatorConfig('knee', 'isa_v5', 'default', sheet, own.load, own.initial_position)


@pytest.mark.parametrize('variants', [[], ['thermal']], ids=['constant', 'heated'])
def test_a_heated_actuator_publishes_its_temperature(
        variants: list[str], observer: Node) -> None:
    """At t = 0 and, of 1.5 s, at 1 s; without the model there is no such topic."""
    heard: list[Temperature] = []
    setup = NodeSetup(knee(*variants), DEFAULT_TIMING)
    node = ActuatorNode(
        lambda _: setup, 'knee', has_mailbox=False, context=observer.context,
        enable_rosout=False)
    try:
        topics = [name for name, _ in node.get_topic_names_and_types()]
        assert ('/knee/temperature' in topics) is bool(variants)
        if not variants:
            return
        observer.create_subscription(Temperature, '/knee/temperature', heard.append, 10)
        spinning = Spinning(observer)
        spinning.wait_for(
            lambda: node.count_subscribers('/knee/temperature') and any(
                handle.get_subscription_count() for handle in node.outlet._handles), 'a match')
        node.outlet.refresh()
        node.publish()
        for _ in range(1500):
            node.actuator.tick()
            node.publish()
        spinning.wait_for(lambda: len(heard) == 2, 'two temperatures')
        assert [message.header.stamp.sec for message in heard] == [0, 1]
        assert heard[0].temperature == 40.0 and 40.0 < heard[1].temperature < 42.0
    finally:
        node.destroy_node()
