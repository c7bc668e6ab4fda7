"""
Setpoints of the joints of a body, converted to those of the actuators that move them.

With x(q) and the lever r = dx/dq of a joint's linkage (L2): an equilibrium q at speed q' is x(q)
at r(q) q'; a torque T is the force T / r, and a joint's stiffness and damping are those of its
actuator times r^2, all three with the lever r at the joint's present angle. Neglected: F dr/dq,
by which a joint is stiffer or softer under load.
"""

from collections.abc import Mapping
import math
from typing import NamedTuple

from isa_ros.core.signals import GAINS_OF_COMMAND
from isa_ros.errors import SetpointError
from isa_ros.surroundings.linkage import actuator_coordinate
import numpy as np


class DrivenJoint(NamedTuple):
    """A joint that one actuator moves."""

    actuator: str
    linkage: np.record
    """`LINKAGE`."""
    low: float
    """Lower end of its range, rad."""
    high: float
    angle: str
    """Field of the body's sample that has its angle, and the place in it."""
    place: int


JointSpace = Mapping[str, DrivenJoint]
"""The joints of a body, by their names in the URDF."""


def to_actuator(name: str, joint: DrivenJoint, sample: np.void, command: np.void) -> None:
    """
    Convert a `COMMAND` row from joint ``name`` (rad, Nm) to its actuator, in place.

    ``sample`` is that of the body. A position of NaN, which is not given, stays NaN.

    Raises
    ------
    SetpointError
        The angle is outside the joint's range.

    """
    angle = float(command['position'])
    if not math.isnan(angle):
        if not joint.low <= angle <= joint.high:
            raise SetpointError(
                f'{name}: setpoint position = {angle:g} rad, must be {joint.low:g} to '
                f'{joint.high:g} rad, the range of the joint')
        command['position'], lever, _ = actuator_coordinate(angle, joint.linkage)
        command['velocity'] *= lever
    _, lever, _ = actuator_coordinate(float(sample[joint.angle][joint.place]), joint.linkage)
    command['effort'] /= lever
    for gain in GAINS_OF_COMMAND:
        command[gain] /= lever * lever
