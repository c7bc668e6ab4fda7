"""rcl_interfaces/Log: events of a run, such as a pause, on ``~/events`` of the coordinator."""

from builtin_interfaces.msg import Time
from msg_adapters.cdr import encode
from msg_adapters.cdr_reader import decode
from msg_adapters.template import stamp
from rcl_interfaces.msg import Log

TYPE = 'rcl_interfaces/msg/Log'
NAME = 'coordinator'
TOPIC = ('/coordinator/events', TYPE)


def pack(t_ns: int, text: str) -> bytes:
    """Return the CDR bytes of an event that took effect at ``t_ns``; the level is INFO."""
    seconds, nanoseconds = stamp(t_ns)
    time = Time(sec=seconds, nanosec=nanoseconds)
    return encode(Log(stamp=time, level=Log.INFO, name=NAME, msg=text))


def text(data: bytes) -> str:
    """
    Return the text of an event; inverse of `pack`.

    Raises
    ------
    CdrError
        The bytes are not a Log.

    """
    message: Log = decode(data, Log)
    return str(message.msg)
