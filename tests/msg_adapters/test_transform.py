"""Poses as transforms."""

from geometry_msgs.msg import TransformStamped
from msg_adapters.odometry import odometry
from msg_adapters.transform import fixed_transform, transform_of


def numbers(found: TransformStamped) -> list[float]:
    """Return place and quaternion, x, y, z and x, y, z, w."""
    place, turn = found.transform.translation, found.transform.rotation
    return [place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w]


def test_the_transform_of_a_pose_has_its_frames_stamp_and_numbers():
    message = odometry('world', 'r2/trunk')
    message.header.stamp.sec, message.header.stamp.nanosec = 17, 23
    pose = message.pose.pose
    pose.position.x, pose.position.y, pose.position.z = 1.5, -2.5, 0.75
    pose.orientation.x, pose.orientation.y = 0.1, 0.7
    pose.orientation.z, pose.orientation.w = -0.1, 0.69
    message.twist.twist.linear.x = 9.0
    found = transform_of(message)
    assert (found.header.frame_id, found.child_frame_id) == ('world', 'r2/trunk')
    assert (found.header.stamp.sec, found.header.stamp.nanosec) == (17, 23)
    assert numbers(found) == [1.5, -2.5, 0.75, 0.1, 0.7, -0.1, 0.69]


def test_a_fixed_transform_takes_the_quaternion_with_w_first():
    found = fixed_transform('world', 'pillar', (3, 4.0, 5.0), (0.6, 0.1, 0.2, 0.3))
    assert (found.header.frame_id, found.child_frame_id) == ('world', 'pillar')
    assert (found.header.stamp.sec, found.header.stamp.nanosec) == (0, 0)
    assert numbers(found) == [3.0, 4.0, 5.0, 0.1, 0.2, 0.3, 0.6]
