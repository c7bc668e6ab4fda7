"""geometry_msgs/WrenchStamped: load cells, torque sensors and ground contact."""

from collections.abc import Mapping

from geometry_msgs.msg import WrenchStamped
from msg_adapters.template import Fields, STAMP

TYPE = 'geometry_msgs/msg/WrenchStamped'


def wrench(frame_id: str) -> WrenchStamped:
    """Return a zero wrench in a frame."""
    message = WrenchStamped()
    message.header.frame_id = frame_id
    return message


def load_cell(
        name: str, is_rotary: bool, columns: Mapping[str, int]) -> tuple[WrenchStamped, Fields]:
    """Return force.x along the rod (N), or torque.z about the shaft (Nm); > 0 pushes out."""
    component = 'wrench.torque.z' if is_rotary else 'wrench.force.x'
    return wrench(f'{name}_load_cell'), {**STAMP, component: columns['force']}
