"""Poses as geometry_msgs/TransformStamped."""

from collections.abc import Sequence

from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry


def transform_of(odometry: Odometry) -> TransformStamped:
    """Return the transform of a pose: same frames, stamp and numbers."""
    found = TransformStamped(header=odometry.header, child_frame_id=odometry.child_frame_id)
    pose = odometry.pose.pose
    place = found.transform.translation
    place.x, place.y, place.z = pose.position.x, pose.position.y, pose.position.z
    found.transform.rotation = pose.orientation
    return found


def fixed_transform(
        frame_id: str, child_frame_id: str, place: Sequence[float],
        quaternion: Sequence[float]) -> TransformStamped:
    """Return the transform of a frame that stays at a place, m, turned by w, x, y, z."""
    found = TransformStamped(child_frame_id=child_frame_id)
    found.header.frame_id = frame_id
    translation, rotation = found.transform.translation, found.transform.rotation
    translation.x, translation.y, translation.z = map(float, place)
    rotation.w, rotation.x, rotation.y, rotation.z = map(float, quaternion)
    return found
