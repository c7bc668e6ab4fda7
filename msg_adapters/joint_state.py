"""sensor_msgs/JointState: joints and named scalars; all arrays have full length."""

from collections.abc import Mapping, Sequence
import struct

from msg_adapters.cdr_reader import decode
from msg_adapters.template import Fields, STAMP
from sensor_msgs.msg import JointState

TYPE = 'sensor_msgs/msg/JointState'
ARRAYS = ('position', 'velocity', 'effort')
_ENCAPSULATION, _STRINGS = 4, 12
"""Bytes before the message, and before the first string: behind the stamp of 8 bytes."""


def joint_state(frame_id: str, names: Sequence[str]) -> JointState:
    """Return the message of these entries, in this order, all values zero."""
    zeros = [0.0] * len(names)
    message = JointState(name=list(names), position=zeros, velocity=zeros, effort=zeros)
    message.header.frame_id = frame_id
    return message


def entries(n: int, **columns: Sequence[int]) -> Fields:
    """
    Return the template fields of ``n`` entries.

    ``columns`` maps position, velocity, effort to value indices, (n,) or fewer: with a shorter
    array the remaining entries are zero.
    """
    fields = dict(STAMP)
    for array, indices in columns.items():
        if array not in ARRAYS or len(indices) > n:
            raise ValueError(f'{array} of {len(indices)} values, must be in {ARRAYS}, <= {n}')
        fields |= {f'{array}[{k}]': index for k, index in enumerate(indices)}
    return fields


def is_whole(data: bytes) -> bool:
    """
    Return whether all lengths within the CDR bytes of a message end within the bytes.

    The deserialiser of Fast DDS refuses others too, but prints a line for each to the terminal.
    """
    order = '<' if data[1:2] == b'\1' else '>'
    length = struct.Struct(f'{order}I').unpack_from
    try:
        place = _STRINGS + length(data, _STRINGS)[0] + 4    # behind the frame
        place += -place % 4
        (count,), place = length(data, place), place + 4
        if count > len(data) - place:
            return False
        for _ in range(count):
            place += length(data, place)[0] + 4
            place += -place % 4
        for _ in ARRAYS:
            (count,), place = length(data, place), place + 4
            if count:
                place += (_ENCAPSULATION - place) % 8 + 8 * count
            if place > len(data):
                return False
            place += -place % 4
    except struct.error:
        return False
    return True


def arrays_of(data: bytes) -> tuple[Sequence[float], ...]:
    """Return position, velocity and effort of a recorded message; raises `CdrError`."""
    message = decode(data, JointState)
    return tuple(getattr(message, array) for array in ARRAYS)


def actuator_joint_state(name: str, columns: Mapping[str, int]) -> tuple[JointState, Fields]:
    """Return encoder position (m | rad), estimated speed and measured force (N | Nm)."""
    fields = entries(
        1, position=[columns['position']], velocity=[columns['velocity']],
        effort=[columns['force']])
    return joint_state(name, [name]), fields


def valve(name: str, columns: Mapping[str, int]) -> tuple[JointState, Fields]:
    """
    Return spool and supply of a valve.

    Spool: position (m), speed (m/s), coil current (A) as effort. Supply: oil drawn since
    t = 0 (m3) as position, its mean flow over the tick (m3/s) as velocity.
    """
    fields = entries(
        2, position=[columns['spool'], columns['supply_volume']],
        velocity=[columns['spool_velocity'], columns['supply_flow']],
        effort=[columns['current']])
    return joint_state(name, [f'{name}/spool', f'{name}/supply']), fields


def references(name: str, columns: Mapping[str, int]) -> tuple[JointState, Fields]:
    """Return the cascade's references, outermost first, each in its unit, in ``position``."""
    loops = ('position', 'force', 'spool', 'current')
    fields = entries(4, position=[columns[f'{loop}_reference'] for loop in loops])
    return joint_state(name, [f'{name}/{loop}' for loop in loops]), fields
