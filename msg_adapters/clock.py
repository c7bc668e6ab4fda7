"""rosgraph_msgs/Clock: simulation time."""

import struct

from msg_adapters.cdr import ENCAPSULATION
from msg_adapters.template import Fields, NANOSEC, SEC, stamp
from rosgraph_msgs.msg import Clock

TYPE = 'rosgraph_msgs/msg/Clock'
TOPIC = ('/clock', TYPE)
_TIME = struct.Struct('<iI')


def clock() -> tuple[Clock, Fields]:
    """Return the prepared message of a time."""
    return Clock(), {'clock.sec': SEC, 'clock.nanosec': NANOSEC}


def pack(t_ns: int) -> bytes:
    """Return the CDR bytes of simulation time ``t_ns``."""
    return ENCAPSULATION + _TIME.pack(*stamp(t_ns))
