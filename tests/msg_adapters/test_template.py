"""Prepared messages: patching equals encoding the message anew."""

from hypothesis import given, settings, strategies as st
from msg_adapters.cdr import CdrError, encode
from msg_adapters.cdr_reader import decode
from msg_adapters.template import (
    NANOSEC, SEC, STAMP, stamp, START_NANOSEC, START_SEC, START_STAMP, Template, time_word)
import pytest
from sensor_msgs.msg import FluidPressure, Image, JointState, RegionOfInterest
from tests.messages import fill, packed

numbers = st.floats()
names = st.lists(st.text('abcdefgh/_', min_size=1, max_size=9), max_size=4)


def joints(entries, frame, values, t_ns):
    """Return a JointState whose three arrays take the values one after another."""
    n = len(entries)
    message = JointState(
        name=entries, position=values[:n], velocity=values[n:2 * n], effort=values[2 * n:])
    message.header.frame_id = frame
    message.header.stamp.sec, message.header.stamp.nanosec = stamp(t_ns)
    return message


@given(entries=names, frame=st.text('xyz', max_size=5), t_ns=st.integers(0, 2**31 * 10**9 - 1),
       drawn=st.data())
@settings(deadline=None)
def test_packing_equals_encoding(entries, frame, t_ns, drawn):
    """Every alignment of names and arrays, every float: the same bytes."""
    n = 3 * len(entries)
    values = drawn.draw(st.lists(numbers, min_size=n, max_size=n))
    paths = [f'{array}[{k}]' for array in ('position', 'velocity', 'effort')
             for k in range(len(entries))]
    fields = {**STAMP, **{path: k for k, path in enumerate(paths)}}
    message = joints(entries, frame, [0.0] * n, 0), fields
    assert packed([message], values, t_ns) == [encode(joints(entries, frame, values, t_ns))]


def test_messages_of_one_template_share_their_values():
    first, second = FluidPressure(variance=3.0), JointState(name=['a'], position=[9.0])
    third = JointState(name=['b'], position=[9.0])
    data = packed(
        [(first, {**STAMP, 'fluid_pressure': 0}), (second, STAMP),
         (third, {**START_STAMP, 'position[0]': 0})], [5.0], 1_000_000_002, 3_000_000_004)
    for message, seconds in (first, 1), (second, 1), (third, 3):
        message.header.stamp.sec, message.header.stamp.nanosec = seconds, seconds + 1
    first.fluid_pressure = third.position[0] = 5.0
    assert data == [encode(first), encode(second), encode(third)]


def test_a_message_that_was_taken_stays_when_the_template_is_filled_again():
    template = Template([(FluidPressure(), {'fluid_pressure': 0})])
    fill(template, [1.0], 0)
    first = template.message(0)
    fill(template, [2.0], 0)
    assert decode(first, FluidPressure).fluid_pressure == 1.0
    assert decode(template.message(0), FluidPressure).fluid_pressure == 2.0


def test_unknown_field_is_refused_naming_those_there_are():
    with pytest.raises(CdrError, match=r"no number 'presure'; it has header.stamp.sec, .*, "
                                       'fluid_pressure, variance'):
        Template([(FluidPressure(), {'presure': 0})])


@pytest.mark.parametrize('message, fields', [
    (Image(), {'height': 0}),             # an integer where a double is filled in
    (JointState(), {'header.stamp.sec': 0}),
    (Image(), {'height': SEC}),           # not an int32
    (RegionOfInterest(), {'x_offset': NANOSEC}),  # no second half of a time
    (Image(), {'height': START_SEC}),
    (RegionOfInterest(), {'x_offset': START_NANOSEC}),
])
def test_a_field_that_is_no_double_is_refused(message, fields):
    with pytest.raises(CdrError, match='neither a double nor a time'):
        Template([(message, fields)])


def test_time_is_split_without_a_float():
    """2^53 ns is 104 days: beyond it a double would lose nanoseconds."""
    assert stamp(2**53 + 1) == (9007199, 254740993)


def test_a_time_word_is_the_stamp_as_it_stands_in_a_message():
    """Little endian: seconds first, nanoseconds behind them."""
    assert time_word(7_000_000_008).to_bytes(8, 'little') == (
        (7).to_bytes(4, 'little') + (8).to_bytes(4, 'little'))
