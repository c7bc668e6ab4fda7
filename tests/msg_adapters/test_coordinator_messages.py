"""What the coordinator publishes."""

from hypothesis import given, settings, strategies as st
from msg_adapters import clock, event
from msg_adapters.cdr import encode
from msg_adapters.cdr_reader import decode
from msg_adapters.sensor_messages import fluid_pressure
from msg_adapters.template import stamp
from rcl_interfaces.msg import Log
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import FluidPressure
from tests.messages import packed

T_NS = 7_000_000_008
TIMES = st.integers(0, 2**31 * 10**9 - 1)


def test_clock_is_simulation_time():
    message = decode(clock.pack(T_NS), Clock)
    assert (message.clock.sec, message.clock.nanosec) == (7, 8)


@given(t_ns=TIMES)
@settings(deadline=None)
def test_the_packed_clock_is_the_encoded_one(t_ns):
    """By hand, prepared, and by the encoder: the same bytes."""
    seconds, nanoseconds = stamp(t_ns)
    message = Clock()
    message.clock.sec, message.clock.nanosec = seconds, nanoseconds
    assert clock.pack(t_ns) == encode(message)
    assert packed([clock.clock()], [], t_ns) == [encode(message)]


def test_a_pressure_is_stamped_and_has_the_frame_of_its_source():
    """As prepared for a supply; the packer makes it absolute."""
    data, = packed([fluid_pressure('supply', 1)], [3.0, 20.7e6], T_NS)
    message = decode(data, FluidPressure)
    assert message.fluid_pressure == 20.7e6
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (7, 8)
    assert message.header.frame_id == 'supply'


def test_an_event_says_what_was_done_and_when():
    data = event.pack(T_NS, 'step 3')
    message = decode(data, Log)
    assert (message.stamp.sec, message.stamp.nanosec) == (7, 8)
    assert (message.name, message.level) == ('coordinator', Log.INFO)
    assert event.text(data) == 'step 3'
