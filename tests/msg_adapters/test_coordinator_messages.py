"""What the coordinator publishes."""

from geometry_msgs.msg import WrenchStamped
from hypothesis import given, settings, strategies as st
from msg_adapters import clock, coordinator_messages, event, fluid_pressure
from msg_adapters.cdr import encode
from msg_adapters.cdr_reader import decode
from msg_adapters.template import stamp
import numpy as np
import pytest
from rcl_interfaces.msg import Log
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import FluidPressure, Imu, JointState
from tests.messages import packed

T_NS = 7_000_000_008
TIMES = st.integers(0, 2**31 * 10**9 - 1)
JOINTS = ('haa', 'hfe', 'kfe')
LEG = {f'{field}[{k}]': 3 * place + k for place, field in enumerate(
    ('position', 'velocity', 'torque', 'foot_force')) for k in range(3)} | {
        'height': 12, 'height_velocity': 13}


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


def leg_messages() -> list[bytes]:
    """Return joints and contact of a leg whose values count from 1."""
    messages = coordinator_messages.leg(JOINTS, {}, LEG)
    assert list(messages) == [
        ('/joint_states', 'sensor_msgs/msg/JointState'),
        ('/coordinator/ground_contact', 'geometry_msgs/msg/WrenchStamped')]
    return packed(list(messages.values()), np.arange(1.0, 15.0).tolist(), T_NS)


def test_leg_joints_come_in_fixed_order_and_the_slider_last():
    """It has no drive: effort 0."""
    message = decode(leg_messages()[0], JointState)
    assert message.name == ['haa_joint', 'hfe_joint', 'kfe_joint', 'slider_joint']
    assert list(message.position) == [1.0, 2.0, 3.0, 13.0]
    assert list(message.velocity) == [4.0, 5.0, 6.0, 14.0]
    assert list(message.effort) == [7.0, 8.0, 9.0, 0.0]
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (7, 8)
    assert message.header.frame_id == 'world'


def test_ground_contact_is_a_force_in_the_world():
    message = decode(leg_messages()[1], WrenchStamped)
    force, torque = message.wrench.force, message.wrench.torque
    assert (force.x, force.y, force.z) == (10.0, 11.0, 12.0)
    assert (torque.x, torque.y, torque.z) == (0.0, 0.0, 0.0)
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (7, 8)
    assert message.header.frame_id == 'world'


def test_a_pressure_is_stamped_and_has_the_frame_of_its_source():
    """As prepared for a supply; the packer makes it absolute."""
    data, = packed([fluid_pressure.fluid_pressure('supply', 1)], [3.0, 20.7e6], T_NS)
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


def test_an_inertial_unit_has_the_frame_of_its_link_and_says_its_noise():
    """The type: no orientation is -1, an unknown covariance 0."""
    units = {'trunk': coordinator_messages.Unit(
        'slider_link', (0.02, 0.0), ('trunk_specific_force', 'trunk_angular_velocity'))}
    columns = LEG | {f'{field}[{k}]': 14 + 3 * place + k for place, field in enumerate(
        units['trunk'].fields) for k in range(3)}
    messages = coordinator_messages.leg(JOINTS, units, columns)
    assert list(messages)[2:] == [('/trunk/imu', 'sensor_msgs/msg/Imu')]
    message = decode(packed(
        list(messages.values()), np.arange(1.0, 21.0).tolist(), T_NS)[2], Imu)
    force, turning = message.linear_acceleration, message.angular_velocity
    assert (force.x, force.y, force.z) == (15.0, 16.0, 17.0)
    assert (turning.x, turning.y, turning.z) == (18.0, 19.0, 20.0)
    assert message.header.frame_id == 'slider_link'
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (7, 8)
    assert message.orientation_covariance[0] == -1.0
    assert list(message.linear_acceleration_covariance) == pytest.approx(
        [4e-4, 0.0, 0.0, 0.0, 4e-4, 0.0, 0.0, 0.0, 4e-4], abs=1e-18)
    assert list(message.angular_velocity_covariance) == [0.0] * 9
