"""nav_msgs/Odometry: pose of a frame, and its velocities in its own axes."""

from nav_msgs.msg import Odometry

TYPE = 'nav_msgs/msg/Odometry'


def odometry(frame_id: str, child_frame_id: str) -> Odometry:
    """Return the message of a frame at rest in another one; covariances of 0: it is exact."""
    message = Odometry(child_frame_id=child_frame_id)
    message.header.frame_id = frame_id
    return message
