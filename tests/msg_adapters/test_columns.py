"""Columns of numbers: what decoding each message gives, and None where layouts differ."""

from msg_adapters.cdr import encode
from msg_adapters.cdr_reader import decode, flatten
from msg_adapters.joint_state import joint_state
from msg_adapters.template import number_columns
import numpy as np
from sensor_msgs.msg import JointState


def message(value: float, name: str = 'hip') -> bytes:
    state = joint_state('frame', [name])
    state.position, state.velocity, state.effort = [value], [2.0 * value], [np.pi]
    state.header.stamp.sec = int(value)
    return encode(state)


def test_every_number_is_that_of_the_decoded_message() -> None:
    messages = [message(float(k)) for k in range(5)]
    found = number_columns(messages, JointState)
    assert found is not None
    for k, data in enumerate(messages):
        decoded = {path: value for path, value in flatten(decode(data, JointState))
                   if path in (found.dtype.names or ())}
        assert decoded == {path: found[path][k] for path in decoded}
        assert {'header.stamp.sec', 'position[0]', 'velocity[0]', 'effort[0]'} <= set(decoded)


def test_another_text_of_the_same_size_is_another_layout() -> None:
    assert number_columns([message(1.0), message(1.0, 'hop')], JointState) is None


def test_another_size_is_another_layout() -> None:
    assert number_columns([message(1.0), message(1.0, 'shoulder')], JointState) is None


def test_padding_is_part_of_the_layout() -> None:
    """Bytes that no field covers are as in the canonical encoding, or there are no columns."""
    padded = bytearray(message(1.0))
    at = padded.index(b'frame\0') + len(b'frame\0')
    assert padded[at:at + 1] == b'\0'
    padded[at] = 0xff
    assert number_columns([message(1.0), bytes(padded)], JointState) is None
    assert number_columns([bytes(padded)], JointState) is None
