"""diagnostic_msgs/DiagnosticArray on ``/diagnostics``: the states of the parts of a run."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from msg_adapters.cdr import encode
from msg_adapters.cdr_reader import decode
from msg_adapters.template import stamp
from std_msgs.msg import Header

TYPE = 'diagnostic_msgs/msg/DiagnosticArray'
TOPIC = ('/diagnostics', TYPE)

OK = DiagnosticStatus.OK
DIGITS = 9      # of a number in a message


class Status(NamedTuple):
    """One status of a `DiagnosticArray`."""

    hardware: str
    """Name of the actuator or supply."""
    task: str
    """What of it; the name of the status is 'HARDWARE: TASK'."""
    message: str
    values: Mapping[str, float | str]
    level: bytes = OK


def pack(t_ns: int, statuses: Sequence[Status]) -> bytes:
    """Return the CDR bytes of the statuses at ``t_ns``; numbers have `DIGITS` digits."""
    seconds, nanoseconds = stamp(t_ns)
    return encode(DiagnosticArray(
        header=Header(stamp=Time(sec=seconds, nanosec=nanoseconds)),
        status=[DiagnosticStatus(
            level=status.level, name=f'{status.hardware}: {status.task}',
            message=status.message, hardware_id=status.hardware,
            values=[KeyValue(key=key, value=_text(value))
                    for key, value in status.values.items()]) for status in statuses]))


def _text(value: float | str) -> str:
    return value if isinstance(value, str) else f'{value:.{DIGITS}g}'


def values(data: bytes, task: str) -> dict[str, dict[str, str]]:
    """
    Return the values of a task by hardware and key.

    Raises
    ------
    CdrError
        The bytes are not a DiagnosticArray.

    """
    return {
        status.hardware_id: {pair.key: pair.value for pair in status.values}
        for status in decode(data, DiagnosticArray).status
        if status.name == f'{status.hardware_id}: {task}'}
