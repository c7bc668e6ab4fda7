"""
The data sheet of one leg, in data-sheet units, and the SI records its kernels read.

Packaged legs are YAML files in isa_ros/config/data/legs, ``section: {key: {value, source}}``;
a source begins with paper, derived, public model or assumed. Frames and signs as in
scripts/generate_leg.py.
"""

from isa_ros.core.constants import STANDARD_GRAVITY
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.record import record, rows_of
from isa_ros.surroundings.bodies.leg.dynamics import LEG_BODY
from isa_ros.surroundings.bodies.leg.motion import LEG
from isa_ros.surroundings.ground import Ground, ground_record
from isa_ros.surroundings.linkage_sheet import Joint, linkage_record, OneJointLinkage
import numpy as np

JOINTS = ('haa', 'hfe', 'kfe')


@frozen(kw_only=True)
class LegSlider(Parameters):
    """The vertical slider that carries the leg."""

    mass_kg: float = parameter('part of the slider that falls with the leg', 'kg', gt=0.0, le=1e3)


@frozen(kw_only=True)
class LegLink(Parameters):
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


@frozen(kw_only=True)
class RigidBodies(Parameters):
    """The rigid bodies of one leg."""

    mass_scale: float = parameter(
        'factor on the masses and inertias of the three links', '1', ge=0.1, le=10.0)
    hip_drop_m: float = parameter(
        'HFE axis below the HAA axis of a hanging leg', 'm', absent=0.0, ge=-2.0, le=2.0)
    slider: LegSlider
    hip: LegLink
    thigh: LegLink
    calf: LegLink


@frozen(kw_only=True)
class LegSheet(Parameters):
    """The data sheet of one leg on its rig."""

    body: RigidBodies
    haa: OneJointLinkage
    hfe: OneJointLinkage
    kfe: OneJointLinkage
    ground: Ground

    @property
    def joints(self) -> dict[str, Joint]:
        """Return the joints by name, in the order of `JOINTS`."""
        return {name: getattr(self, name) for name in JOINTS}


def body_record(body: RigidBodies) -> np.ndarray:
    """Return the `LEG_BODY` record of a leg with its mass scale applied, shape (1,)."""
    links = {}
    for name in ('hip', 'thigh', 'calf'):
        link: LegLink = getattr(body, name)
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
