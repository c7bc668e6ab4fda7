"""sensor_msgs/FluidPressure: absolute pressures; all pressures of the simulation are gauge."""

from msg_adapters.template import Fields, STAMP
from sensor_msgs.msg import FluidPressure

TYPE = 'sensor_msgs/msg/FluidPressure'


def fluid_pressure(frame_id: str, column: int) -> tuple[FluidPressure, Fields]:
    """Return a pressure message whose value (Pa absolute) is value number ``column``."""
    message = FluidPressure()
    message.header.frame_id = frame_id
    return message, {**STAMP, 'fluid_pressure': column}
