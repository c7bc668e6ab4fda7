"""
Gain scheduling: a factor over the stroke, and one on demands that retract.

The factor over the stroke is a table at equal distances with straight lines between.
"""

from dataclasses import fields
import math

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import Parameters, tunable
import numpy as np

POINTS = 21


@frozen(kw_only=True)
class Constant(Parameters):
    """The same gain everywhere."""


@frozen(kw_only=True)
class OilStiffness(Parameters):
    """Gains divided by the stiffness in the force loop, relative to its smallest value."""


@frozen(kw_only=True)
class ThreePoints(Parameters):
    """Straight lines between three factors."""

    retracted: float = tunable('factor at the retracted end', '1', ge=0.0, le=100.0)
    middle: float = tunable('factor at mid stroke', '1', ge=0.0, le=100.0)
    extended: float = tunable('factor at the extended end', '1', ge=0.0, le=100.0)


@frozen(kw_only=True)
class FivePoints(Parameters):
    """Straight lines between five factors, as `isa tune` finds them."""

    retracted: float = tunable('factor at the retracted end', '1', ge=0.0, le=100.0)
    first_quarter: float = tunable('factor at a quarter of the stroke', '1', ge=0.0, le=100.0)
    middle: float = tunable('factor at mid stroke', '1', ge=0.0, le=100.0)
    last_quarter: float = tunable(
        'factor at three quarters of the stroke', '1', ge=0.0, le=100.0)
    extended: float = tunable('factor at the extended end', '1', ge=0.0, le=100.0)


Schedule = Constant | OilStiffness | ThreePoints | FivePoints


def schedule_table(sheet: Schedule, stiffness: np.ndarray) -> np.ndarray:
    """
    Return the factor at `POINTS` equal distances, shape (POINTS,)  (R6).

    ``stiffness``, of the same shape, is the stiffness in the force loop: the gain of the
    loop's plant is proportional to it.
    """
    table: np.ndarray = np.ones(POINTS)
    if isinstance(sheet, OilStiffness):
        table = stiffness.min() / stiffness
    elif isinstance(sheet, (ThreePoints, FivePoints)):
        factors = [getattr(sheet, f.name) for f in fields(sheet)]
        table = np.interp(
            np.linspace(0.0, 1.0, POINTS), np.linspace(0.0, 1.0, len(factors)), factors)
    return table


@kernel
def scheduled(position, stroke, table):
    """Return the factor at ``position`` in [0, ``stroke``]; table shape (POINTS,)  (R6)."""
    place = max(0.0, min(1.0, position / stroke)) * (POINTS - 1)
    left = min(int(math.floor(place)), POINTS - 2)
    return table[left] + (place - left) * (table[left + 1] - table[left])
