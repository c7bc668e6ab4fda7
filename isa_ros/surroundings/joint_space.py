"""
Setpoints of the joints of a body, converted to those of the actuators that move them.

With x(q) and the lever r = dx/dq of a joint's linkage (L2): an equilibrium q at speed q' is x(q)
at r(q) q'; a torque T is the force T / r, and a joint's stiffness and damping are those of its
actuator times r^2, all three with the lever r at the joint's present angle. Neglected: F dr/dq,
by which a joint is stiffer or softer under load.
"""

from collections.abc import Callable, Mapping
import math
from typing import NamedTuple

from isa_ros.core.signals import GAINS_OF_COMMAND
from isa_ros.errors import SetpointError
from isa_ros.surroundings.linkage import actuator_coordinate
import numpy as np


class DrivenJoint(NamedTuple):
    """A joint that one actuator moves, which moves no other."""

    actuator: str
    linkage: np.record | Callable[[float], tuple[float, float]]
    """`LINKAGE`, or what returns x and the lever at an angle."""
    low: float
    """Lower end of its range, rad | m."""
    high: float
    angle: str
    """Field of the body's sample that has its angle, and the place in it; None: all of it."""
    place: int | None = None
    unit: str = 'rad'

    def at(self, angle: float) -> tuple[float, float]:
        """Return the actuator's coordinate and the lever dx/dq at an angle  (L2)."""
        if callable(self.linkage):
            return self.linkage(angle)
        x, lever, _ = actuator_coordinate(angle, self.linkage)
        return x, lever

    def measured(self, sample: np.void) -> float:
        """Return its angle in a sample of the body."""
        found = sample[self.angle]
        return float(found if self.place is None else found[self.place])


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
                f'{name}: setpoint position = {angle:g} {joint.unit}, must be {joint.low:g} to '
                f'{joint.high:g} {joint.unit}, the range of the joint')
        command['position'], lever = joint.at(angle)
        command['velocity'] *= lever
    _, lever = joint.at(joint.measured(sample))
    command['effort'] /= lever
    for gain in GAINS_OF_COMMAND:
        command[gain] /= lever * lever
