"""sensor_msgs/Imu: specific force and angular velocity in the frame of a link."""

from collections.abc import Sequence

from msg_adapters.template import Prepared, STAMP
import numpy as np
from sensor_msgs.msg import Imu

TYPE = 'sensor_msgs/msg/Imu'
UNKNOWN = -1.0
"""First number of a covariance, as the type demands: there is no such estimate."""


def imu(link: str, sigmas: Sequence[float], columns: Sequence[int]) -> Prepared:
    """
    Return the reading of an inertial unit on a link.

    ``columns`` are those of the specific force (m/s2; at rest it points up) and of the angular
    velocity (rad/s), (6,); ``sigmas`` the standard deviation of either's noise, 0: not known.
    """
    message = Imu()
    message.header.frame_id = link
    message.orientation_covariance[0] = UNKNOWN
    for covariance, sigma in zip(
            (message.linear_acceleration_covariance, message.angular_velocity_covariance), sigmas):
        covariance[:] = (sigma * sigma * np.eye(3)).reshape(-1)
    fields = dict(STAMP)
    for vector, first in (('linear_acceleration', 0), ('angular_velocity', 3)):
        fields |= {f'{vector}.{axis}': columns[first + k] for k, axis in enumerate('xyz')}
    return message, fields
