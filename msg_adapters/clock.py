"""rosgraph_msgs/Clock: simulation time."""

from msg_adapters.template import Fields, NANOSEC, SEC
from rosgraph_msgs.msg import Clock

TYPE = 'rosgraph_msgs/msg/Clock'


def clock() -> tuple[Clock, Fields]:
    """Return the message of a time."""
    return Clock(), {'clock.sec': SEC, 'clock.nanosec': NANOSEC}
