"""
The data sheet of one leg, in data-sheet units, and the SI records its kernels read.

Packaged legs are YAML files in isa_ros/config/data/legs, ``section: {key: {value, source}}``;
a source begins with paper, derived, public model or assumed. Frames and signs as in
scripts/generate_leg.py.
"""

from dataclasses import dataclass
import math

from isa_ros.core.constants import STANDARD_GRAVITY
from isa_ros.core.elementary import cos, sin
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.record import record, rows_of
from isa_ros.errors import ParameterError
from isa_ros.surroundings import linkage as kernels
from isa_ros.surroundings.bodies.leg.dynamics import LEG_BODY
from isa_ros.surroundings.bodies.leg.motion import LEG
from isa_ros.surroundings.ground import Ground, ground_record
import numpy as np

JOINTS = ('haa', 'hfe', 'kfe')
MILLI = 1e-3
SHORTEST_LEVER = 2e-3  # m (or 1 of a rotary actuator): ports divide by it
CHECKED_ANGLES = 257  # samples of a joint's range in which a linkage must be regular


@dataclass(frozen=True, kw_only=True)
class Slider(Parameters):
    """The vertical slider that carries the leg."""

    mass_kg: float = parameter('part of the slider that falls with the leg', 'kg', gt=0.0, le=1e3)


@dataclass(frozen=True, kw_only=True)
class Link(Parameters):
    """One rigid link with principal axes along those of its own frame."""

    length_m: float = parameter('to the next joint or to the foot', 'm', ge=0.0, le=2.0)
    mass_kg: float = parameter('mass, before the mass scale', 'kg', gt=0.0, le=100.0)
    com_x_m: float = parameter('centre of mass', 'm', ge=-2.0, le=2.0)
    com_y_m: float = parameter('centre of mass', 'm', ge=-2.0, le=2.0)
    com_z_m: float = parameter('centre of mass', 'm', ge=-2.0, le=2.0)
    inertia_xx: float = parameter(
        'at the centre of mass, before the scale', 'kg m2', gt=0.0, le=100.0)
    inertia_yy: float = parameter(
        'at the centre of mass, before the scale', 'kg m2', gt=0.0, le=100.0)
    inertia_zz: float = parameter(
        'at the centre of mass, before the scale', 'kg m2', gt=0.0, le=100.0)


@dataclass(frozen=True, kw_only=True)
class RigidBodies(Parameters):
    """The rigid bodies of one leg."""

    mass_scale: float = parameter(
        'factor on the masses and inertias of the three links', '1', ge=0.1, le=10.0)
    hip_drop_m: float = parameter(
        'HFE axis below the HAA axis of a hanging leg', 'm', absent=0.0, ge=-2.0, le=2.0)
    slider: Slider
    hip: Link
    thigh: Link
    calf: Link


@dataclass(frozen=True, kw_only=True)
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
        levers = [kernels.actuator_coordinate(math.radians(angle), row)[1] for angle in angles]
        for angle, lever in zip(angles, levers):
            if not math.isfinite(lever):
                raise ParameterError(
                    f'{where} cannot be assembled at joint angle {angle:.2f} deg, must close from '
                    f'{self.low_deg:g} to {self.high_deg:g} deg')
            if lever * levers[0] < SHORTEST_LEVER * SHORTEST_LEVER:
                raise ParameterError(
                    f'{where}: lever = {1e3 * lever:.2f} mm at joint angle {angle:.2f} deg, must '
                    f'keep its sign and be >= {1e3 * SHORTEST_LEVER:g} mm over the whole range')


@dataclass(frozen=True, kw_only=True)
class Direct(Joint):
    """A rotary actuator on the joint itself."""


@dataclass(frozen=True, kw_only=True)
class SliderCrank(Joint):
    """A cylinder between two pins at fixed distances from the joint."""

    a_mm: float = parameter('joint to the pin on the parent link', 'mm', gt=0.0, le=2e3)
    b_mm: float = parameter('joint to the pin on the child link', 'mm', gt=0.0, le=2e3)
    retracted_length_mm: float = parameter('pin to pin at piston 0', 'mm', gt=0.0, le=2e3)


@dataclass(frozen=True, kw_only=True)
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


@dataclass(frozen=True, kw_only=True)
class LegSheet(Parameters):
    """The data sheet of one leg on its rig."""

    body: RigidBodies
    haa: Direct | SliderCrank | FourBar
    hfe: Direct | SliderCrank | FourBar
    kfe: Direct | SliderCrank | FourBar
    ground: Ground

    @property
    def joints(self) -> dict[str, Joint]:
        """Return the joints by name, in the order of `JOINTS`."""
        return {name: getattr(self, name) for name in JOINTS}


def linkage_record(joint: Direct | SliderCrank | FourBar | Joint) -> np.record:
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


def body_record(body: RigidBodies) -> np.ndarray:
    """Return the `LEG_BODY` record of a leg with its mass scale applied, shape (1,)."""
    links = {}
    for name in ('hip', 'thigh', 'calf'):
        link: Link = getattr(body, name)
        links[f'l_{name}'] = link.length_m
        links[f'm_{name}'] = body.mass_scale * link.mass_kg
        for axis in 'xyz':
            links[f'c_{name}_{axis}'] = getattr(link, f'com_{axis}_m')
            links[f'i_{name}_{axis}{axis}'] = (
                body.mass_scale * getattr(link, f'inertia_{axis}{axis}'))
    rows = rows_of(1, LEG_BODY)
    rows[0] = record(
        LEG_BODY, m_slider=body.slider.mass_kg, gravity=STANDARD_GRAVITY, d_hip=body.hip_drop_m,
        **links)
    return rows


def leg_record(sheet: LegSheet) -> np.ndarray:
    """Return the `LEG` record of a sheet, shape (1,)."""
    rows = rows_of(1, LEG)
    rows[0] = record(
        LEG, body=body_record(sheet.body)[0], ground=ground_record(sheet.ground),
        **{name: linkage_record(getattr(sheet, name)) for name in JOINTS})
    return rows
