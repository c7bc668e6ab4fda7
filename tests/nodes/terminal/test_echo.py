"""How a topic is echoed: what is there to be read, with which quality, in which order."""

from types import SimpleNamespace

from diagnostic_msgs.msg import DiagnosticStatus
from isa_ros.nodes.terminal.echo import _published, _quality, message_text
import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState

RELIABLE, BEST_EFFORT = ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT
KEPT, VOLATILE = DurabilityPolicy.TRANSIENT_LOCAL, DurabilityPolicy.VOLATILE


class Graph:
    """The graph as the node isa_7 sees it: (node, quality) of each publisher by topic."""

    def __init__(self, publishers: dict[str, list[tuple[str, QoSProfile]]]) -> None:
        self.publishers = publishers

    def get_name(self) -> str:
        return 'isa_7'

    def get_topic_names_and_types(self) -> list[tuple[str, list[str]]]:
        return [(name, ['a/msg/B', 'a/msg/C']) for name in self.publishers]

    def get_publishers_info_by_topic(self, name: str) -> list[SimpleNamespace]:
        return [SimpleNamespace(node_name=node, qos_profile=quality)
                for node, quality in self.publishers[name]]


def seen(**publishers: list[tuple[str, QoSProfile]]) -> SimpleNamespace:
    """Return a visitor of a graph."""
    return SimpleNamespace(node=Graph(publishers))


def quality(reliability: ReliabilityPolicy, durability: DurabilityPolicy) -> QoSProfile:
    return QoSProfile(depth=3, reliability=reliability, durability=durability)


@pytest.mark.parametrize(('offered', 'expected'), [
    ([(RELIABLE, KEPT)], (RELIABLE, KEPT)),
    ([(RELIABLE, KEPT), (BEST_EFFORT, KEPT)], (BEST_EFFORT, KEPT)),
    ([(RELIABLE, VOLATILE), (RELIABLE, KEPT)], (RELIABLE, VOLATILE))])
def test_every_publisher_can_serve_the_quality_that_is_asked_for(offered, expected):
    """The best one of the weakest: a stronger one would silence a publisher."""
    found = _quality(seen(ram=[('ram', quality(*own)) for own in offered]), 'ram')
    assert (found.reliability, found.durability) == expected


def test_what_only_this_node_publishes_is_not_there():
    own, other = (('isa_7', quality(RELIABLE, VOLATILE)), ('ram', quality(RELIABLE, VOLATILE)))
    assert _published(seen(mine=[own], both=[own, other], nobody=[])) == {
        'both': 'a/msg/B, a/msg/C'}


def test_a_message_has_the_order_of_its_type():
    text = message_text(JointState(name=['ram'], position=[0.25], effort=[70.0]))
    keys = [line.partition(':')[0] for line in text.splitlines() if not line.startswith(' ')]
    assert keys == ['header', 'name', 'position', 'velocity', 'effort']
    assert 'position: [0.25]\n' in text


def test_a_byte_is_a_number():
    text = message_text(DiagnosticStatus(level=DiagnosticStatus.ERROR, message='fault'))
    assert text.startswith('level: 2\n')
