"""What the coordinator publishes."""

from geometry_msgs.msg import WrenchStamped
from msg_adapters import event
from msg_adapters.cdr_reader import decode
from msg_adapters.coordinator_messages import ClockMessage, LegMessages, SupplyMessages
import numpy as np
from rcl_interfaces.msg import Log
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import FluidPressure, JointState

T_NS = 7_000_000_008


def test_clock_is_simulation_time():
    message = decode(ClockMessage().pack(T_NS), Clock)
    assert (message.clock.sec, message.clock.nanosec) == (7, 8)


def leg_messages() -> list[bytes]:
    """Return supply, joints and contact of a leg whose values count from 1."""
    return LegMessages(['haa', 'hfe', 'kfe']).pack(20.7e6, np.arange(1.0, 13.0), T_NS)


def test_leg_joints_come_in_fixed_order():
    message = decode(leg_messages()[1], JointState)
    assert message.name == ['haa', 'hfe', 'kfe']
    assert list(message.position) == [1.0, 2.0, 3.0]
    assert list(message.velocity) == [4.0, 5.0, 6.0]
    assert list(message.effort) == [7.0, 8.0, 9.0]
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (7, 8)
    assert message.header.frame_id == 'world'


def test_ground_contact_is_a_force_in_the_world():
    message = decode(leg_messages()[2], WrenchStamped)
    force, torque = message.wrench.force, message.wrench.torque
    assert (force.x, force.y, force.z) == (10.0, 11.0, 12.0)
    assert (torque.x, torque.y, torque.z) == (0.0, 0.0, 0.0)
    assert message.header.frame_id == 'world'


def test_supply_pressure_is_absolute():
    alone, = SupplyMessages().pack(20.7e6, T_NS)
    assert alone == leg_messages()[0]
    message = decode(alone, FluidPressure)
    assert message.fluid_pressure == 20.7e6 + 101325.0
    assert message.header.frame_id == 'supply'


def test_an_event_says_what_was_done_and_when():
    data = event.pack(T_NS, 'step 3')
    message = decode(data, Log)
    assert (message.stamp.sec, message.stamp.nanosec) == (7, 8)
    assert (message.name, message.level) == ('coordinator', Log.INFO)
    assert event.text(data) == 'step 3'
