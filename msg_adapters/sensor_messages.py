"""Messages of single sensors: pressure, temperature, load cell, inertial unit."""

from collections.abc import Mapping, Sequence

from geometry_msgs.msg import WrenchStamped
from msg_adapters.cdr_reader import decode
from msg_adapters.template import Fields, Prepared, STAMP
import numpy as np
from sensor_msgs.msg import FluidPressure, Imu, Temperature

PRESSURE_TYPE = 'sensor_msgs/msg/FluidPressure'
TEMPERATURE_TYPE = 'sensor_msgs/msg/Temperature'
WRENCH_TYPE = 'geometry_msgs/msg/WrenchStamped'
IMU_TYPE = 'sensor_msgs/msg/Imu'
UNKNOWN = -1.0
"""First number of a covariance of an `Imu`, as the type demands: there is no such estimate."""


def fluid_pressure(frame_id: str, column: int) -> tuple[FluidPressure, Fields]:
    """Return a pressure (Pa absolute; the simulation is gauge), value number ``column``."""
    message = FluidPressure()
    message.header.frame_id = frame_id
    return message, {**STAMP, 'fluid_pressure': column}


def pressure_in(data: bytes) -> float:
    """Return the pressure of a message, Pa absolute; raises `CdrError`."""
    return float(decode(data, FluidPressure).fluid_pressure)


def temperature(frame_id: str, column: int) -> tuple[Temperature, Fields]:
    """Return a reading in celsius, value number ``column``; its variance, 0, means unknown."""
    message = Temperature()
    message.header.frame_id = frame_id
    return message, {**STAMP, 'temperature': column}


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


def imu(frame_id: str, sigmas: Sequence[float], columns: Sequence[int]) -> Prepared:
    """
    Return the reading of an inertial unit in its frame.

    ``columns`` are those of the specific force (m/s2; at rest it points up) and of the angular
    velocity (rad/s), (6,); ``sigmas`` the standard deviation of either's noise, 0: not known.
    """
    message = Imu()
    message.header.frame_id = frame_id
    message.orientation_covariance[0] = UNKNOWN
    for covariance, sigma in zip(
            (message.linear_acceleration_covariance, message.angular_velocity_covariance), sigmas):
        covariance[:] = (sigma * sigma * np.eye(3)).reshape(-1)
    fields = dict(STAMP)
    for vector, first in (('linear_acceleration', 0), ('angular_velocity', 3)):
        fields |= {f'{vector}.{axis}': columns[first + k] for k, axis in enumerate('xyz')}
    return message, fields
