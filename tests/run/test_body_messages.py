"""Messages that a body declares, prepared and found again."""

from geometry_msgs.msg import WrenchStamped
from isa_ros.run.body_messages import by_field, prepared, type_of
from isa_ros.surroundings.bodies.leg.inertial import Imu as ImuSheet
from isa_ros.surroundings.bodies.leg.leg import InertialUnit
from isa_ros.surroundings.bodies.leg.messages import leg_messages
from isa_ros.surroundings.messages import BodyMessage
from msg_adapters.cdr_reader import decode
import numpy as np
import pytest
from sensor_msgs.msg import Imu, JointState
from tests.messages import packed

T_NS = 7_000_000_008
LEG = {f'{field}[{k}]': 3 * place + k for place, field in enumerate(
    ('position', 'velocity', 'torque', 'foot_force')) for k in range(3)} | {
        'height': 12, 'height_velocity': 13} | {f'foot_moment[{k}]': 14 + k for k in range(3)}
TRUNK = InertialUnit('trunk', ImuSheet(
    link='slider_link', rate_hz=200.0, x_mm=0.0, y_mm=0.0, z_mm=0.0, accelerometer_sigma=0.02,
    accelerometer_bias=0.0, gyro_sigma=0.0, gyro_bias=0.0), 5_000_000, key=0)


def messages_of_leg(*units: InertialUnit) -> tuple[BodyMessage, ...]:
    """Return the messages of a leg with some inertial units."""
    return leg_messages('', units)


def packed_leg() -> list[bytes]:
    """Return joints and contact of a leg whose values count from 1."""
    messages = messages_of_leg()
    assert [(own.topic, type_of(own)) for own in messages] == [
        ('/joint_states', 'sensor_msgs/msg/JointState'),
        ('/coordinator/ground_contact', 'geometry_msgs/msg/WrenchStamped')]
    return packed([prepared(own, LEG) for own in messages], np.arange(1.0, 18.0).tolist(), T_NS)


def test_leg_joints_come_in_fixed_order_and_the_slider_last():
    """It has no drive: effort 0."""
    message = decode(packed_leg()[0], JointState)
    assert message.name == ['haa_joint', 'hfe_joint', 'kfe_joint', 'slider_joint']
    assert list(message.position) == [1.0, 2.0, 3.0, 13.0]
    assert list(message.velocity) == [4.0, 5.0, 6.0, 14.0]
    assert list(message.effort) == [7.0, 8.0, 9.0, 0.0]
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (7, 8)
    assert message.header.frame_id == 'world'


def test_ground_contact_is_a_wrench_in_the_world():
    message = decode(packed_leg()[1], WrenchStamped)
    force, torque = message.wrench.force, message.wrench.torque
    assert (force.x, force.y, force.z) == (10.0, 11.0, 12.0)
    assert (torque.x, torque.y, torque.z) == (15.0, 16.0, 17.0)
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (7, 8)
    assert message.header.frame_id == 'world'


def test_an_inertial_unit_has_its_own_frame_and_says_its_noise():
    """The type: no orientation is -1, an unknown covariance 0."""
    unit = messages_of_leg(TRUNK)[2]
    assert (unit.topic, type_of(unit)) == ('/trunk/imu', 'sensor_msgs/msg/Imu')
    columns = {f'trunk_{field}[{k}]': 3 * place + k for place, field in enumerate(
        ('specific_force', 'angular_velocity')) for k in range(3)}
    message = decode(packed(
        [prepared(unit, columns)], np.arange(15.0, 21.0).tolist(), T_NS)[0], Imu)
    force, turning = message.linear_acceleration, message.angular_velocity
    assert (force.x, force.y, force.z) == (15.0, 16.0, 17.0)
    assert (turning.x, turning.y, turning.z) == (18.0, 19.0, 20.0)
    assert message.header.frame_id == 'trunk_imu'
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (7, 8)
    assert message.orientation_covariance[0] == -1.0
    assert list(message.linear_acceleration_covariance) == pytest.approx(
        [4e-4, 0.0, 0.0, 0.0, 4e-4, 0.0, 0.0, 0.0, 4e-4], abs=1e-18)
    assert list(message.angular_velocity_covariance) == [0.0] * 9


def test_a_further_leg_has_topics_and_links_under_its_name() -> None:
    assert [(own.topic, getattr(own, 'frame', '')) for own in leg_messages('left/', [TRUNK])] == [
        ('/left/joint_states', ''), ('/left/ground_contact', ''),
        ('/left/trunk/imu', 'left/trunk_imu')]


def test_a_reading_is_due_at_its_own_period() -> None:
    assert [own.period_ns for own in messages_of_leg(TRUNK)] == [0, 0, 5_000_000]


def test_fields_of_the_sample_are_found_in_their_messages() -> None:
    """The slider is the fourth joint; it has no effort."""
    joints, contact, unit = (dict(by_field(own)) for own in messages_of_leg(TRUNK))
    assert joints == {
        'position': ['position[0]', 'position[1]', 'position[2]'], 'height': ['position[3]'],
        'velocity': ['velocity[0]', 'velocity[1]', 'velocity[2]'],
        'height_velocity': ['velocity[3]'], 'torque': ['effort[0]', 'effort[1]', 'effort[2]']}
    assert contact == {'foot_force': [f'wrench.force.{axis}' for axis in 'xyz'],
                       'foot_moment': [f'wrench.torque.{axis}' for axis in 'xyz']}
    assert unit == {
        'trunk_specific_force': [f'linear_acceleration.{axis}' for axis in 'xyz'],
        'trunk_angular_velocity': [f'angular_velocity.{axis}' for axis in 'xyz']}
