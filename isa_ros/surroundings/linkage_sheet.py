"""
The data sheets of the linkages that drive one joint, in data-sheet units, and their SI record.

Each holds the range of its joint, over which the linkage must be regular: it closes, and its lever
keeps its sign and is not too short for a port to divide by it.
"""

import math

from isa_ros.core.elementary import cos, sin
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.record import rows_of
from isa_ros.core.units import MILLI
from isa_ros.errors import ParameterError
from isa_ros.surroundings import linkage as kernels
import numpy as np

SHORTEST_LEVER = 2e-3  # m (or 1 of a rotary actuator): ports divide by it
LEVER_RULE = (f'keep its sign and be >= {1e3 * SHORTEST_LEVER:g} mm over the range: the mass and '
              'the stiffness that an actuator moves there grow with its inverse square')
CHECKED_ANGLES = 257  # samples of a joint's range in which a linkage must be regular


@frozen(kw_only=True)
class Joint(Parameters):
    """The range of a joint, and sign and offset of its angle in its linkage."""

    low_deg: float = parameter("lower end of the joint's range", 'deg', ge=-360.0, le=360.0)
    high_deg: float = parameter("upper end of the joint's range", 'deg', ge=-360.0, le=360.0)
    sense: float = parameter('+1 or -1: sign of the angle in the linkage', '1', ge=-1.0, le=1.0)
    offset_deg: float = parameter('added to sense * angle', 'deg', ge=-720.0, le=720.0)

    def __post_init__(self) -> None:
        """Refuse an empty range and a sense that is neither +1 nor -1."""
        super().__post_init__()
        where = type(self).__name__
        if not self.low_deg < self.high_deg:
            raise ParameterError(
                f'{where}.low_deg = {self.low_deg:g} deg, must be < high_deg = '
                f'{self.high_deg:g} deg')
        if abs(self.sense) != 1.0:
            raise ParameterError(f'{where}.sense = {self.sense:g}, must be 1 or -1')
        row = linkage_record(self)
        angles = np.linspace(self.low_deg, self.high_deg, CHECKED_ANGLES)
        levers = kernels.levers([math.radians(angle) for angle in angles], row)
        for angle, lever in zip(angles, levers):
            if not math.isfinite(lever):
                raise ParameterError(
                    f'{where} cannot be assembled at joint angle {angle:.2f} deg, must close from '
                    f'{self.low_deg:g} to {self.high_deg:g} deg')
            if is_short(lever, levers[0]):
                raise ParameterError(
                    f'{where}: lever = {1e3 * lever:.2f} mm at joint angle {angle:.2f} deg, must '
                    f'{LEVER_RULE}')


@frozen(kw_only=True)
class Direct(Joint):
    """A rotary actuator on the joint itself."""


@frozen(kw_only=True)
class SliderCrank(Joint):
    """A cylinder between two pins at fixed distances from the joint."""

    a_mm: float = parameter('joint to the pin on the parent link', 'mm', gt=0.0, le=2e3)
    b_mm: float = parameter('joint to the pin on the child link', 'mm', gt=0.0, le=2e3)
    retracted_length_mm: float = parameter('pin to pin at piston 0', 'mm', gt=0.0, le=2e3)


@frozen(kw_only=True)
class FourBar(Joint):
    """The knee K: links A-R (thigh) and B-R (shank) meet the cylinder C-R at the rod eye R."""

    ak_mm: float = parameter('K to pin A on the thigh', 'mm', gt=0.0, le=1e3)
    akh_deg: float = parameter("A off the thigh's axis", 'deg', ge=-180.0, le=180.0)
    bk_mm: float = parameter('K to pin B on the shank', 'mm', gt=0.0, le=1e3)
    ar_mm: float = parameter('link A-R', 'mm', gt=0.0, le=1e3)
    br_mm: float = parameter('link B-R', 'mm', gt=0.0, le=1e3)
    jk_mm: float = parameter("K to the cylinder's pin C along the thigh", 'mm', gt=0.0, le=2e3)
    cj_mm: float = parameter("C off the thigh's axis", 'mm', ge=-1e3, le=1e3)
    retracted_length_mm: float = parameter('pin to pin at piston 0', 'mm', gt=0.0, le=2e3)


def is_short(lever: float, first: float) -> bool:
    """Return whether a lever is below the bound, or has not the sign of the ``first`` one."""
    return lever * first <= 0.0 or abs(lever) < SHORTEST_LEVER


OneJointLinkage = Direct | SliderCrank | FourBar


def linkage_record(joint: OneJointLinkage | Joint) -> np.record:
    """Return the `LINKAGE` record of a joint's sheet, SI."""
    row: np.record = rows_of(1, kernels.LINKAGE)[0]
    row['sense'] = joint.sense
    row['offset'] = math.radians(joint.offset_deg)
    if isinstance(joint, SliderCrank):
        row['kind'] = kernels.SLIDER_CRANK
        row['a'], row['b'] = joint.a_mm * MILLI, joint.b_mm * MILLI
        row['retracted_length'] = joint.retracted_length_mm * MILLI
    elif isinstance(joint, FourBar):
        akh = math.radians(joint.akh_deg)
        row['kind'] = kernels.FOUR_BAR
        row['ak_x'] = joint.ak_mm * MILLI * cos(akh)
        row['ak_y'] = -joint.ak_mm * MILLI * sin(akh)
        row['c_x'], row['c_y'] = joint.jk_mm * MILLI, joint.cj_mm * MILLI
        row['retracted_length'] = joint.retracted_length_mm * MILLI
        for name in ('bk', 'ar', 'br'):
            row[name] = getattr(joint, f'{name}_mm') * MILLI
    return row
