"""Places of links, points and pistons of a robot in a pose, for its checks before a run."""

from collections.abc import Sequence

from isa_ros.config.robots.tree import composed
from isa_ros.config.robots.urdf_numbers import Floats, Pose
from isa_ros.core.elementary import cos, sin
from isa_ros.surroundings.bodies.robot.sheet import (
    JointLinkage, Points, RobotDrive, RobotLink, RobotSheet)
from isa_ros.surroundings.linkage import actuator_coordinate
import numpy as np


def quaternion(roll: float, pitch: float, yaw: float) -> tuple[float, float, float, float]:
    """Return w, x, y, z of R_z(yaw) R_y(pitch) R_x(roll)."""
    (s_r, c_r), (s_p, c_p), (s_y, c_y) = (
        (sin(0.5 * angle), cos(0.5 * angle)) for angle in map(float, (roll, pitch, yaw)))
    return (c_r * c_p * c_y + s_r * s_p * s_y, s_r * c_p * c_y - c_r * s_p * s_y,
            c_r * s_p * c_y + s_r * c_p * s_y, c_r * c_p * s_y - s_r * s_p * c_y)


def poses(links: Sequence[RobotLink], joints: Sequence[float], root: Pose) -> list[Pose]:
    """Return each link in the world, with the root at ``root`` and joints at rad or m, (n,)."""
    found = [root]
    for link, q in zip(links[1:], joints):
        at = composed(found[link.parent],
                      Pose(np.array(link.joint.place), np.array(link.joint.rotation)))
        if link.joint.kind == 'prismatic':
            move = Pose(np.array([0.0, 0.0, q]), np.eye(3))
        else:
            s, c = sin(q), cos(q)
            move = Pose(np.zeros(3), np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))
        found.append(composed(at, move))
    return found


def point(pose: Pose, place: Sequence[float]) -> Floats:
    """Return a point of a link in the world, m, (3,)."""
    found: Floats = pose.place + pose.rotation @ np.array(place)
    return found


def motion_of(sheet: RobotSheet, drive: RobotDrive, joints: Sequence[float]) -> tuple[
        float, list[float]]:
    """
    Return the actuator's coordinate and its levers on the joints of `RobotSheet.driven`.

    Coordinates and levers as in `isa_ros.surroundings.linkage`; those of a cylinder between two
    points are the partial derivatives of their distance  (L23).
    """
    own = drive.linkage
    if isinstance(own, JointLinkage):
        x, lever, _ = actuator_coordinate(joints[own.link - 1], own.linkage)
        return float(x), [float(lever)]
    assert isinstance(own, Points)
    at = poses(sheet.links, joints, Pose(np.zeros(3), np.eye(3)))
    a, b = point(at[own.link_a], own.point_a), point(at[own.link_b], own.point_b)
    length = float(np.linalg.norm(b - a))
    along = (b - a) / length if length else np.zeros(3)
    levers = []
    on_a = set(sheet.path(own.link_a))
    for link in sheet.driven(drive):
        axis = at[link].rotation[:, 2]
        sign, moved = (-1.0, a) if link in on_a else (1.0, b)
        speed = axis if sheet.links[link].joint.kind == 'prismatic' else np.cross(
            axis, moved - at[link].place)
        levers.append(sign * float(along @ speed))
    return length - own.retracted_length, levers
