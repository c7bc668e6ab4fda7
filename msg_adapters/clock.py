"""rosgraph_msgs/Clock: simulation time."""

from msg_adapters.template import Fields
from rosgraph_msgs.msg import Clock

TYPE = 'rosgraph_msgs/msg/Clock'


def clock() -> tuple[Clock, Fields]:
    """Return the message whose time is (sec, nanosec), values 0 and 1."""
    return Clock(), {'clock.sec': 0, 'clock.nanosec': 1}
