"""Whether the bytes of a JointState are whole, held against the messages themselves."""

from hypothesis import given, strategies as st
from msg_adapters.joint_state import is_whole
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState

TEXTS = st.text('abc/_', max_size=9)
VALUES = st.lists(st.floats(width=64, allow_nan=False), max_size=4)
MESSAGES = st.builds(
    lambda frame, names, position, velocity, effort: _with(
        frame, JointState(name=names, position=position, velocity=velocity, effort=effort)),
    TEXTS, st.lists(TEXTS, max_size=4), VALUES, VALUES, VALUES)


def _with(frame: str, message: JointState) -> JointState:
    message.header.frame_id = frame
    return message


def read(data: bytes) -> JointState | None:
    """Return what the middleware reads, None if it refuses the bytes."""
    try:
        return deserialize_message(data, JointState)
    except (_rclpy.RCLError, _rclpy.RMWError):
        return None


@given(MESSAGES)
def test_what_is_whole_is_what_the_middleware_reads(message):
    """The beginnings of a message are none, but for those that lack bytes behind its end."""
    data = bytes(serialize_message(message))
    assert is_whole(data)
    for k in range(4, len(data)):
        assert is_whole(data[:k]) == (read(data[:k]) == message), k
    assert not any(is_whole(data[:k]) for k in range(4))


def test_the_other_byte_order_is_read_too():
    """The same message with numbers that begin with their most significant byte."""
    little = bytes.fromhex('00010000' '00000000' '00000000' '01000000' '00000000'
                           '00000000' '01000000' '00000000' '0000000000000000' '00000000')
    assert is_whole(little)
    big = bytes.fromhex('00000000' '00000000' '00000000' '00000001' '00000000'
                        '00000000' '00000001' '00000000' '0000000000000000' '00000000')
    assert is_whole(big)
    assert not is_whole(big[:28])


def test_a_count_beyond_the_bytes_is_refused_at_once():
    data = bytes(4 + 8 + 4) + bytes([0xFF] * 4)
    assert not is_whole(b'\0\1' + data[2:])
