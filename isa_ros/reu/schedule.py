"""
Gain scheduling: a factor over the stroke, and one on demands that retract.

The factor over the stroke is a table at equal distances with straight lines between.
"""

from dataclasses import dataclass
import math

from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter, Parameters, tunable
import numpy as np

POINTS = 21


@dataclass(frozen=True, kw_only=True)
class Constant(Parameters):
    """The same gain everywhere."""


@dataclass(frozen=True, kw_only=True)
class OilStiffness(Parameters):
    """Gains divided by the stiffness in the force loop: stiffer oil, smaller gains."""

    reference_stiffness: float = parameter(
        'at which the gains are as stated; 0: the smallest of this actuator', 'N/m | Nm/rad',
        ge=0.0, le=1e12)


@dataclass(frozen=True, kw_only=True)
class ThreePoints(Parameters):
    """Straight lines between three factors."""

    retracted: float = tunable('factor at the retracted end', '1', ge=0.0, le=100.0)
    middle: float = tunable('factor at mid stroke', '1', ge=0.0, le=100.0)
    extended: float = tunable('factor at the extended end', '1', ge=0.0, le=100.0)


Schedule = Constant | OilStiffness | ThreePoints


def schedule_table(sheet: Schedule, stiffness: np.ndarray) -> np.ndarray:
    """
    Return the factor at `POINTS` equal distances, shape (POINTS,)  (R6).

    ``stiffness``, of the same shape, is the stiffness in the force loop: the gain of the
    loop's plant is proportional to it.
    """
    if isinstance(sheet, OilStiffness):
        table: np.ndarray = (sheet.reference_stiffness or stiffness.min()) / stiffness
        return table
    if isinstance(sheet, ThreePoints):
        return np.interp(np.linspace(0.0, 1.0, POINTS), [0.0, 0.5, 1.0],
                         [sheet.retracted, sheet.middle, sheet.extended])
    return np.ones(POINTS)


@kernel
def scheduled(position, stroke, table):
    """Return the factor at ``position`` in [0, ``stroke``]; table shape (POINTS,)  (R6)."""
    place = max(0.0, min(1.0, position / stroke)) * (POINTS - 1)
    left = min(int(math.floor(place)), POINTS - 2)
    return table[left] + (place - left) * (table[left + 1] - table[left])
