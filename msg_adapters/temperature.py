"""sensor_msgs/Temperature: the oil in an actuator."""

from collections.abc import Mapping

from msg_adapters.template import Fields, STAMP
from sensor_msgs.msg import Temperature

TYPE = 'sensor_msgs/msg/Temperature'


def of_oil(name: str, columns: Mapping[str, int]) -> tuple[Temperature, Fields]:
    """Return the message of the oil's temperature (celsius); its variance, 0, means unknown."""
    message = Temperature()
    message.header.frame_id = name
    return message, {**STAMP, 'temperature': columns['temperature']}
