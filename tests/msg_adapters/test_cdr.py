"""Canonical CDR: equal to rosbags, readable by rclpy, and every primitive where it says."""

import struct

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import WrenchStamped
from hypothesis import given, settings, strategies as st
from msg_adapters.cdr import CdrError, encode, encode_with_slots, field_type, Message
from msg_adapters.cdr_reader import decode, flatten, message_class
import numpy as np
import pytest
from rclpy.serialization import deserialize_message, serialize_message
from rosbags.typesys import get_typestore, Stores
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import FluidPressure, JointState
from std_msgs.msg import UInt8

STORE = get_typestore(Stores.ROS2_JAZZY)
TYPES = (
    'sensor_msgs/msg/JointState', 'geometry_msgs/msg/WrenchStamped', 'nav_msgs/msg/Odometry',
    'sensor_msgs/msg/FluidPressure', 'rosgraph_msgs/msg/Clock',
    'diagnostic_msgs/msg/DiagnosticArray', 'sensor_msgs/msg/Imu',
    'sensor_msgs/msg/Temperature', 'sensor_msgs/msg/BatteryState',
    'trajectory_msgs/msg/JointTrajectory', 'nav_msgs/msg/Odometry',
    'sensor_msgs/msg/PointCloud2', 'rcl_interfaces/msg/ParameterEvent',
    'std_msgs/msg/Bool', 'std_msgs/msg/Byte', 'std_msgs/msg/ByteMultiArray',
    'std_msgs/msg/Char', 'std_msgs/msg/Empty', 'std_msgs/msg/Float32MultiArray',
    'std_msgs/msg/Header', 'std_msgs/msg/Int16', 'std_msgs/msg/Int64MultiArray',
    'std_msgs/msg/String', 'std_msgs/msg/UInt16MultiArray', 'visualization_msgs/msg/Marker',
)
INTEGERS = {
    'int8': (-2**7, 2**7 - 1), 'uint8': (0, 2**8 - 1), 'int16': (-2**15, 2**15 - 1),
    'uint16': (0, 2**16 - 1), 'int32': (-2**31, 2**31 - 1), 'uint32': (0, 2**32 - 1),
    'int64': (-2**63, 2**63 - 1), 'uint64': (0, 2**64 - 1),
}
TEXTS = st.text(st.characters(codec='utf-8', exclude_characters='\0'), max_size=9)


def items(item):
    """Return values of one element type."""
    if item in INTEGERS:
        return st.integers(*INTEGERS[item])
    if '/' in item:
        return messages(message_class(item))
    return {
        'boolean': st.booleans(), 'octet': st.binary(min_size=1, max_size=1),
        'float': st.floats(width=32, allow_nan=False), 'double': st.floats(allow_nan=False),
    }.get(item, TEXTS)


@st.composite
def messages(draw, cls: type[Message]):
    """Draw a message of a class with every field set."""
    message = cls()
    for name, declared in cls.get_fields_and_field_types().items():
        kind = field_type(declared)
        if kind.is_sequence:
            setattr(message, name, draw(st.lists(items(kind.item), max_size=3)))
        elif kind.length is not None:
            n = kind.length
            setattr(message, name, draw(st.lists(items(kind.item), min_size=n, max_size=n)))
        else:
            setattr(message, name, draw(items(kind.item)))
    return message


DTYPES = {'float': 'f4', 'double': 'f8', 'boolean': '?', 'octet': 'i1'}


def to_rosbags(message):
    """Return the same message in the other library's classes."""
    package, name = type(message).__module__.split('.')[0], type(message).__name__
    values = {}
    for field, declared in message.get_fields_and_field_types().items():
        kind, value = field_type(declared), getattr(message, field)
        is_array = kind.is_sequence or kind.length is not None
        if kind.item == 'octet':
            octets = value if is_array else [value]
            signed = [int.from_bytes(octet, 'little', signed=True) for octet in octets]
            value = signed if is_array else signed[0]
        if '/' in kind.item:
            value = [to_rosbags(item) for item in value] if is_array else to_rosbags(value)
        elif is_array and not kind.item.startswith('string'):
            value = np.array(value, dtype=DTYPES.get(kind.item, kind.item))
        values[field] = value
    if not values:
        values['structure_needs_at_least_one_member'] = 0
    return STORE.types[f'{package}/msg/{name}'](**values)


@pytest.mark.parametrize('type_name', TYPES)
@given(drawn=st.data())
@settings(max_examples=25, deadline=None)
def test_bytes_equal_those_of_rosbags(type_name, drawn):
    """Zero padding included: the reference implementation writes the same string."""
    message = drawn.draw(messages(message_class(type_name)))
    assert encode(message) == bytes(STORE.serialize_cdr(to_rosbags(message), type_name))


@pytest.mark.parametrize('type_name', TYPES)
@given(drawn=st.data())
@settings(max_examples=25, deadline=None)
def test_middleware_reads_what_was_encoded(type_name, drawn):
    message = drawn.draw(messages(message_class(type_name)))
    assert deserialize_message(encode(message), type(message)) == message


@pytest.mark.parametrize('type_name', TYPES)
@given(drawn=st.data())
@settings(max_examples=25, deadline=None)
def test_decoding_inverts_encoding(type_name, drawn):
    message = drawn.draw(messages(message_class(type_name)))
    assert decode(encode(message), type(message)) == message


@given(message=messages(JointState))
@settings(deadline=None)
def test_what_the_middleware_writes_is_decoded(message):
    """Padding of any content and bytes behind the last field are ignored."""
    assert decode(bytes(serialize_message(message)), JointState) == message


@given(message=messages(JointState))
@settings(deadline=None)
def test_every_slot_holds_the_value_of_its_path(message):
    data, slots = encode_with_slots(message)
    values = {
        path: value for path, value in flatten(message)
        if isinstance(value, (int, float)) and not path.endswith('.length')}
    assert {
        path: struct.unpack_from(f'<{slot.code}', data, slot.offset)[0]
        for path, slot in slots.items()} == values


@given(message=messages(DiagnosticArray), cut=st.integers(1, 400))
@settings(deadline=None)
def test_bytes_cut_short_are_refused(message, cut):
    data = encode(message)
    with pytest.raises(CdrError, match='DiagnosticArray'):
        decode(data[:max(len(data) - cut, 0)], DiagnosticArray)


@given(data=st.binary(max_size=200))
def test_arbitrary_bytes_decode_or_are_refused(data):
    """No length read from the bytes is trusted: nothing but CdrError may come out."""
    try:
        message = decode(b'\x00\x01\x00\x00' + data, JointState)
    except CdrError:
        return
    assert len(encode(message)) <= len(data) + 4


def test_length_beyond_the_bytes_is_refused():
    """2^32 - 1 names would be 4 GB of empty strings."""
    data = encode(JointState())
    names = 4 + 8 + 4 + 1 + 3
    with pytest.raises(CdrError, match='4294967295 elements of string do not fit'):
        decode(data[:names] + b'\xff\xff\xff\xff' + data[names + 4:], JointState)


def test_big_endian_is_refused_by_name():
    with pytest.raises(CdrError, match=r"Clock: encapsulation '0000', must be '0001'"):
        decode(b'\x00\x00\x00\x00' + bytes(8), Clock)


def test_text_that_is_not_utf8_is_refused():
    message = JointState(name=['abcd'])
    with pytest.raises(CdrError, match='JointState: a string is not UTF-8'):
        decode(encode(message).replace(b'abcd', b'ab\xff\xff'), JointState)


def test_type_that_is_not_installed_is_named():
    with pytest.raises(CdrError, match='no_msgs/msg/Thing: no such message type is installed'):
        message_class('no_msgs/msg/Thing')


def test_fields_are_flattened_in_wire_order():
    message = WrenchStamped()
    message.wrench.force.y = 2.0
    assert list(flatten(message)) == [
        ('header.stamp.sec', 0), ('header.stamp.nanosec', 0), ('header.frame_id', ''),
        ('wrench.force.x', 0.0), ('wrench.force.y', 2.0), ('wrench.force.z', 0.0),
        ('wrench.torque.x', 0.0), ('wrench.torque.y', 0.0), ('wrench.torque.z', 0.0)]


def test_known_bytes_of_a_pressure():
    """Written out by hand: encapsulation, stamp, 'ab' and its padding, two doubles."""
    message = FluidPressure(fluid_pressure=1.0)
    message.header.stamp.sec, message.header.stamp.nanosec = 1, 2
    message.header.frame_id = 'ab'
    assert encode(message) == bytes.fromhex(
        '00010000' '01000000' '02000000' '03000000' '616200' '00' '000000000000f03f'
        '0000000000000000')


def test_single_byte_needs_no_padding():
    assert encode(UInt8(data=7)) == bytes.fromhex('0001000007')
