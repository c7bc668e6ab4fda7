"""
Messages of a body as data: the columns of its sample that are published, and their topics.

`isa_ros.run.body_messages` makes them, and reads them again from a bag; nothing else needs to know
of a body's topics. A column is one number of the sample: ``height``, or ``position[0]``.
"""

from collections.abc import Sequence
from typing import NamedTuple

JOINT_STATES = 'joint_states'
"""Topic of the joints of a body, after its prefix."""


class JointStates(NamedTuple):
    """Position (rad | m), speed and effort (Nm | N) of joints: sensor_msgs/JointState."""

    topic: str
    names: Sequence[str]
    """Of the joints, as in the URDF."""
    position: Sequence[str]
    """Columns in the order of the names."""
    velocity: Sequence[str]
    effort: Sequence[str]
    """Shorter if the last joints have no drive: their effort is 0."""
    period_ns: int = 0
    """0: at every tick."""


class Force(NamedTuple):
    """A force, N, and its moment, Nm, in the axes of a frame: geometry_msgs/WrenchStamped."""

    topic: str
    force: Sequence[str]
    """Columns of x, y and z."""
    moment: Sequence[str] = ()
    """Columns of its moment about the origin of the frame; empty: it acts there."""
    period_ns: int = 0
    frame: str = ''
    """'': the world."""


class Inertial(NamedTuple):
    """Reading of an inertial unit in its own frame: sensor_msgs/Imu."""

    topic: str
    frame: str
    sigmas: tuple[float, float]
    """Standard deviation of specific force (m/s2) and angular velocity (rad/s), 0: not known."""
    force: Sequence[str]
    """Columns of the specific force, m/s2; at rest it points up."""
    turning: Sequence[str]
    """Columns of the angular velocity, rad/s."""
    period_ns: int = 0


class Odometry(NamedTuple):
    """Pose of a frame in the world, its velocities in its own axes: nav_msgs/Odometry."""

    topic: str
    frame: str
    """The frame that moves, ``child_frame_id``."""
    position: Sequence[str]
    """Columns of x, y and z, m."""
    orientation: Sequence[str]
    """Columns of the quaternion, w, x, y, z."""
    velocity: Sequence[str]
    """Columns, m/s."""
    turning: Sequence[str]
    """Columns, rad/s."""
    period_ns: int = 0


BodyMessage = JointStates | Force | Inertial | Odometry


def columns(field: str, n: int = 3) -> list[str]:
    """Return the columns of a field of ``n`` numbers."""
    return [f'{field}[{k}]' for k in range(n)]
