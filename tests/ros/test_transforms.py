"""Where robots are on tf and tf_static, as rviz reads it; nothing of it is recorded."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.robot_config import RobotConfig
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.text.yaml_text import dump
from isa_ros.core.topic import Topic
from isa_ros.nodes.coordinator import node as node_module
from isa_ros.nodes.coordinator.node import CoordinatorNode
from msg_adapters.odometry import odometry, TYPE
from nav_msgs.msg import Odometry
import pytest
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import deserialize_message, serialize_message
from tests.ros.faults import mcap_file
from tests.ros.spinning import Spinning
from tests.ros.started import bringup

pytestmark = pytest.mark.ros
TOPICS = [Topic('r1/foot/ground_contact', 'geometry_msgs/msg/WrenchStamped'),
          Topic('r1/odom', TYPE), Topic('r2/odom', TYPE)]
ROBOTS: dict[str, Any] = {'name': 'three', 'robots': {
    'walker': {'file': 'quadruped'}, 'rail': {'file': 'two_joint_leg'}, 'leg': {'file': 'leg'}}}
ROUNDINGS = 2e-15   # some of numbers below 2
TURNED = {'start': {'x_mm': 1250.0, 'height_mm': 300.0, 'yaw_deg': 90.0}}


@pytest.fixture
def node(observer: Node) -> Iterator[CoordinatorNode]:
    found = CoordinatorNode(context=observer.context, enable_rosout=False, namespace='lab')
    yield found
    found.destroy_node()


def bytes_of(child: str, x: float) -> bytes:
    message = odometry('world', child)
    message.pose.pose.position.x = x
    return bytes(serialize_message(message))


def test_without_the_package_nodes_publish_no_transforms(node, observer, monkeypatch):
    """It is never required: all other topics are there."""
    monkeypatch.setattr(node_module, 'is_installed', lambda package: False)
    node.outlets(TOPICS, ())
    node.show_fixed(load_run(find('crane', CONFIG)))
    names = {own.topic_name for own in node.publishers}
    assert {'/lab/r1/odom', '/lab/r2/odom'} <= names
    assert not any('tf' in name for name in names)


def test_all_robots_are_in_one_message_while_somebody_follows(node, observer):
    messages = pytest.importorskip('tf2_msgs.msg')
    outlet = node.outlets(TOPICS, ()).surroundings
    outlet.refresh()
    assert not outlet.has_subscribers() and list(outlet.wanted) == []
    found: list[Any] = []
    observer.create_subscription(messages.TFMessage, '/lab/tf', found.append, 100)
    spinning = Spinning(observer)

    def is_followed() -> bool:
        outlet.refresh()
        return bool(outlet.has_subscribers())
    spinning.wait_for(is_followed, 'the subscription')
    assert list(outlet.wanted) == [1, 2]
    outlet.publish([None, None, None])
    outlet.publish([b'of nobody', bytes_of('r1/trunk', 1.5), bytes_of('r2/trunk', -2.5)])
    outlet.publish([None, None, bytes_of('r2/trunk', 7.0)])
    spinning.wait_for(lambda: len(found) == 2, 'transforms')
    assert [[(own.child_frame_id, own.transform.translation.x) for own in message.transforms]
            for message in found] == [[('r1/trunk', 1.5), ('r2/trunk', -2.5)], [('r2/trunk', 7.0)]]


def test_a_run_without_odometry_follows_nothing(node, observer):
    messages = pytest.importorskip('tf2_msgs.msg')
    outlet = node.outlets(TOPICS[:1], ()).surroundings
    observer.create_subscription(messages.TFMessage, '/lab/tf', print, 100)
    tf = next(own for own in node.publishers if own.topic_name == '/lab/tf')
    Spinning(observer).wait_for(tf.get_subscription_count, 'the subscription')
    outlet.refresh()
    assert not outlet.has_subscribers()


@pytest.mark.slow
@pytest.mark.parametrize('options', [(), ('--in-process',)], ids=['processes', 'one process'])
def test_tf_is_the_odometry_of_the_bag_and_changes_no_byte_of_it(observer, tmp_path, options):
    """Three robots: one walks, one stands on a rail, and a leg whose root is the world."""
    messages = pytest.importorskip('tf2_msgs.msg')
    config = tmp_path / 'three.yaml'
    ROBOTS['robots']['rail']['body'] = TURNED
    config.write_text(dump(ROBOTS))
    moving: list[Any] = []
    fixed: list[Any] = []
    observer.create_subscription(messages.TFMessage, '/lab/tf', moving.append, 2000)
    observer.create_subscription(messages.TFMessage, '/lab/tf_static', fixed.append, QoSProfile(
        depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
    spinning = Spinning(observer)
    with bringup(tmp_path / 'bag', '--namespace', 'lab', '--duration', '0.3',
                 '--real-time-factor', '0.3', *options, config=config) as run:
        spinning.wait_for(lambda: not run.is_running(), 'the end of the run')
        assert run.exit_code() == 0, run.errors
    recorded = {m.t_ns: deserialize_message(m.data, Odometry)
                for m in Bag(tmp_path / 'bag').messages() if m.topic == '/walker/odom'}
    seen = [own for message in moving for own in message.transforms]
    assert len(seen) > 50
    for own in seen:
        stamp = own.header.stamp
        pose = recorded[stamp.sec * 10**9 + stamp.nanosec].pose.pose
        place, turn = own.transform.translation, own.transform.rotation
        assert (own.header.frame_id, own.child_frame_id) == ('world', 'walker/trunk')
        assert (place.x, place.y, place.z) == (pose.position.x, pose.position.y, pose.position.z)
        assert turn == pose.orientation
    (message,) = fixed
    (rail,) = message.transforms
    assert (rail.header.frame_id, rail.child_frame_id) == ('world', 'rail/rail')
    place, turn = rail.transform.translation, rail.transform.rotation
    half = 0.5**0.5
    assert [place.x, place.y, place.z] == pytest.approx([1.25, 0.0, 0.3], abs=ROUNDINGS)
    assert [turn.x, turn.y, turn.z, turn.w] == pytest.approx([0.0, 0.0, half, half], abs=ROUNDINGS)
    saved = isa_ros.load(config, duration=0.3).simulate().save(tmp_path / 'saved')
    assert mcap_file(tmp_path / 'bag').read_bytes() == mcap_file(saved).read_bytes()


def test_the_root_of_a_robot_is_a_link_of_its_description():
    """Else robot_state_publisher and these transforms would make two trees."""
    for name in ('quadruped', 'crane', 'two_joint_leg', 'hyq_quadruped'):
        run = load_run(find(name, CONFIG))
        (body,) = run.bodies
        assert isinstance(body, RobotConfig) and body.root_frame == body.sheet.links[0].name
        assert f'<link name="{body.root_frame}"' in run.description(body, Path())
