"""diagnostic_msgs/DiagnosticArray on ``/diagnostics``: the states of the parts of a run."""

from collections.abc import Mapping, Sequence
import struct
from typing import NamedTuple

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from msg_adapters.cdr import ENCAPSULATION, Message, put_length, put_string
from msg_adapters.cdr_reader import decode
from msg_adapters.template import stamp

TYPE = 'diagnostic_msgs/msg/DiagnosticArray'
TOPIC = ('/diagnostics', TYPE)

OK = DiagnosticStatus.OK
LEVEL, MESSAGE = 'level', 'message'     # what a status has beside its values
DIGITS = 9      # of a number in a message
_STAMP = struct.Struct('<iI')


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
    """
    Return the CDR bytes of the statuses at ``t_ns``; numbers have `DIGITS` digits.

    They are written as they come: objects of messages, some hundred, would take most of the time.
    """
    buffer = bytearray(ENCAPSULATION + _STAMP.pack(*stamp(t_ns)))
    put_string(buffer, '')      # the frame
    put_length(buffer, len(statuses))
    for status in statuses:
        buffer += status.level
        put_string(buffer, f'{status.hardware}: {status.task}')
        put_string(buffer, status.message)
        put_string(buffer, status.hardware)
        put_length(buffer, len(status.values))
        for key, value in status.values.items():
            put_string(buffer, key)
            put_string(buffer, _text(value))
    return bytes(buffer)


def _text(value: float | str) -> str:
    return value if isinstance(value, str) else f'{value:.{DIGITS}g}'


def texts_of(message: Message) -> dict[str, dict[str, str]] | None:
    """Return level, values by key and message of each status by its name; None: no statuses."""
    if not isinstance(message, DiagnosticArray):
        return None
    return {status.name: {LEVEL: str(ord(status.level)), **{
        pair.key: pair.value for pair in status.values}, MESSAGE: status.message}
        for status in message.status}


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
