"""
URDF of a leg of a run, with the frames of its actuators, load cells and inertial units.

Lengths, masses, ranges and actuators are those of the run. Frames and signs are explained in
scripts/generate_leg.py: hip x down, y right, z backward; thigh and calf x along the link, y
backward, z left. The position of the slider is the height of the HAA axis above the ground.

A load cell's force.x is along the rod, from the cylinder to its eye, its torque.z about the
shaft. The direction of a rod is that in the middle of the joint's range, where the sheet of a leg
has the places of its pins: of a four-bar. A slider-crank has their distances only, so that its
cylinder and load cell are at the joint, in the axes of the link. Bodies are plain rods.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
import math
from typing import NamedTuple

from isa_ros.actuator.ratings import ratings_of
from isa_ros.actuator.setpoint_range import setpoint_bounds
from isa_ros.actuator.sheet import ActuatorSheet
from isa_ros.core.elementary import atan2
from isa_ros.core.units import MILLI
from isa_ros.plant.plant import plant_record
from isa_ros.surroundings.bodies.leg.inertial import Imu
from isa_ros.surroundings.bodies.leg.messages import imu_frame, joint_name, SLIDER
from isa_ros.surroundings.bodies.leg.sheet import JOINTS, LegLink, LegSheet
from isa_ros.surroundings.linkage import levers, rod_eye
from isa_ros.surroundings.linkage_sheet import Direct, FourBar, Joint, linkage_record
import numpy as np

WORLD = 'world'
SPEED = 20.0            # rad/s: limit of a joint, assumed
SLIDER_SPEED = 10.0     # m/s, assumed
TRAVEL = 2.0            # m: limit of the slider, assumed
RADIUS = {'hip': 0.05, 'thigh': 0.03, 'calf': 0.018}    # m, of the rods, assumed
SLIDER_BOX = 0.1        # m, its edge, assumed
SLIDER_INERTIA = 0.01   # kg m2, assumed; it does not turn
_LEVER_ANGLES = 257     # of a joint's range, for the largest lever

Vector = Sequence[float]
_ZERO = (0.0, 0.0, 0.0)
_HALF = 0.5 * math.pi
_FROM_BASE = (math.pi, _HALF, 0.0)      # roll, pitch, yaw: base to hip at zero angle
_FROM_HIP = (_HALF, 0.0, 0.0)           # hip to thigh at zero angle
_ALONG_X = (0.0, _HALF, 0.0)            # from the axis of a drawn cylinder, z
_ALONG_Y = (_HALF, 0.0, 0.0)


class DescribedLeg(NamedTuple):
    """What is described of a leg."""

    model: str
    prefix: str
    """Of its frames."""
    sheet: LegSheet
    joints: Sequence[tuple[str, str]]
    """Each with its actuator."""
    imus: Sequence[tuple[str, Imu]]
    """Names and sheets of its inertial units."""


def urdf_of(
        leg: DescribedLeg, sheets: Mapping[str, ActuatorSheet],
        control: Iterable[str] = ()) -> str:
    """
    Return the URDF of a leg of a run; ``sheets`` are those of its actuators by name.

    Links are the frames of its messages: with the name of the leg and a slash in front, but for
    `WORLD` and the frames of actuators, whose names differ in a run. Joints have the names of
    its joint states. ``control`` is a tag of ros2_control.
    """
    return '\n'.join(['<?xml version="1.0"?>', f'<robot name="{leg.model}_leg">',
                      f'  <link name="{WORLD}"/>', *_bodies(leg, sheets), *_mounts(leg),
                      *_units(leg), *control, '</robot>', ''])


def _bodies(leg: DescribedLeg, sheets: Mapping[str, ActuatorSheet]) -> Iterator[str]:
    """Yield slider, links and joints."""
    body, own = leg.sheet.body, leg.prefix
    places = _places(leg)
    edge = ' '.join([f'{SLIDER_BOX:g}'] * 3)
    yield from _joint(joint_name(SLIDER), 'prismatic', WORLD, f'{own}slider_link',
                      limit=(0.0, TRAVEL, 0.0, SLIDER_SPEED))
    yield from _link(f'{own}slider_link', body.slider.mass_kg, _ZERO, (SLIDER_INERTIA,) * 3,
                     f'<box size="{edge}"/>', _ZERO, _ZERO)
    names = ['slider_link', 'hip', 'thigh', 'calf']
    for joint, parent, child in zip(JOINTS, names, names[1:]):
        sheet: Joint = getattr(leg.sheet, joint)
        link: LegLink = getattr(body, child)
        low, high = math.radians(sheet.low_deg), math.radians(sheet.high_deg)
        yield from _joint(
            joint_name(joint), 'revolute', f'{own}{parent}', f'{own}{child}', *places[joint],
            limit=(low, high, _torque(sheet, sheets[dict(leg.joints)[joint]]), SPEED))
        end = (body.hip_drop_m, -body.hip.length_m, 0.0) if child == 'hip' else (
            link.length_m, 0.0, 0.0)
        length = math.hypot(*end)
        along = _ALONG_Y if abs(end[1]) > abs(end[0]) else _ALONG_X
        shape = f'<cylinder radius="{RADIUS[child]:g}" length="{length:.9g}"/>'
        yield from _link(
            f'{own}{child}', body.mass_scale * link.mass_kg,
            (link.com_x_m, link.com_y_m, link.com_z_m),
            [body.mass_scale * getattr(link, f'inertia_{axis}{axis}') for axis in 'xyz'],
            shape if length else '', [0.5 * x for x in end], along)
    yield from _fixed('foot_joint', f'{own}calf', f'{own}foot', (body.calf.length_m, 0.0, 0.0))


def _places(leg: DescribedLeg) -> dict[str, tuple[Vector, Vector]]:
    """Return place and turn of each joint on its parent."""
    body = leg.sheet.body
    return {'haa': (_ZERO, _FROM_BASE),
            'hfe': ((body.hip_drop_m, -body.hip.length_m, 0.0), _FROM_HIP),
            'kfe': ((body.thigh.length_m, 0.0, 0.0), _ZERO)}


def _mounts(leg: DescribedLeg) -> Iterator[str]:
    """Yield the frames of the actuators and of their load cells."""
    parents = {'haa': 'slider_link', 'hfe': 'hip', 'kfe': 'thigh'}
    for joint, actuator in leg.joints:
        place, turn = _places(leg)[joint]
        sheet: Joint = getattr(leg.sheet, joint)
        if isinstance(sheet, FourBar):
            place, turn = _cylinder(sheet, place)
        elif not isinstance(sheet, Direct):
            turn = _ZERO
        yield from _fixed(
            f'{actuator}_mount', f'{leg.prefix}{parents[joint]}', actuator, place, turn)
        yield from _fixed(f'{actuator}_load_cell_mount', actuator, f'{actuator}_load_cell')


def _cylinder(sheet: FourBar, knee: Vector) -> tuple[Vector, Vector]:
    """Return place of a four-bar's cylinder on the thigh, and the turn of x along its rod."""
    linkage = linkage_record(sheet)
    eye_x, eye_y = rod_eye(math.radians(0.5 * (sheet.low_deg + sheet.high_deg)), linkage)
    pin_x, pin_y = float(linkage['c_x']), float(linkage['c_y'])
    # The axes of the four-bar: towards the hip, -x of the thigh, and to the side of the flexion.
    angle = atan2(-sheet.sense * (eye_y - pin_y), -(eye_x - pin_x))
    return (knee[0] - pin_x, knee[1] - sheet.sense * pin_y, knee[2]), (0.0, 0.0, angle)


def _units(leg: DescribedLeg) -> Iterator[str]:
    """Yield the frames of the inertial units, at their places in the axes of their links."""
    for name, own in leg.imus:
        frame = imu_frame(leg.prefix, name)
        yield from _fixed(f'{name}_imu_mount', f'{leg.prefix}{own.link}', frame,
                          (own.x_mm * MILLI, own.y_mm * MILLI, own.z_mm * MILLI))


def _torque(sheet: Joint, actuator: ActuatorSheet) -> float:
    """Return the torque of the rated force at the longest lever of a joint, Nm."""
    linkage = linkage_record(sheet)
    angles = np.linspace(math.radians(sheet.low_deg), math.radians(sheet.high_deg), _LEVER_ANGLES)
    lever = max(map(abs, levers(angles, linkage)))
    rated = setpoint_bounds(actuator).get('effort')
    if rated is None:   # no impedance
        return float(lever * ratings_of(plant_record(actuator.plant)[0]).force_range)
    return float(lever * max(-rated.low, rated.high))


def _joint(name: str, kind: str, parent: str, child: str, place: Vector = _ZERO,
           turn: Vector = _ZERO, limit: Vector = ()) -> Iterator[str]:
    yield f'  <joint name="{name}" type="{kind}">'
    yield f'    <parent link="{parent}"/>'
    yield f'    <child link="{child}"/>'
    yield f'    {_origin(place, turn)}'
    if limit:
        low, high, effort, speed = limit
        yield '    <axis xyz="0 0 1"/>'
        yield (f'    <limit lower="{low:.9g}" upper="{high:.9g}" effort="{effort:.6g}" '
               f'velocity="{speed:g}"/>')
    yield '  </joint>'


def _fixed(name: str, parent: str, child: str, place: Vector = _ZERO,
           turn: Vector = _ZERO) -> Iterator[str]:
    yield from _joint(name, 'fixed', parent, child, place, turn)
    yield f'  <link name="{child}"/>'


def _link(name: str, mass: float, centre: Vector, inertia: Vector, shape: str, place: Vector,
          turn: Vector) -> Iterator[str]:
    """Yield a link with principal axes along its own; ``shape`` is drawn and collides."""
    xx, yy, zz = inertia
    yield f'  <link name="{name}">'
    yield '    <inertial>'
    yield f'      {_origin(centre, _ZERO)}'
    yield f'      <mass value="{mass:.9g}"/>'
    yield (f'      <inertia ixx="{xx:.9g}" ixy="0" ixz="0" iyy="{yy:.9g}" iyz="0" '
           f'izz="{zz:.9g}"/>')
    yield '    </inertial>'
    for what in ('visual', 'collision') if shape else ():
        yield f'    <{what}>'
        yield f'      {_origin(place, turn)}'
        yield f'      <geometry>{shape}</geometry>'
        yield f'    </{what}>'
    yield '  </link>'


def _origin(place: Vector, turn: Vector) -> str:
    return f'<origin xyz="{_numbers(place)}" rpy="{_numbers(turn)}"/>'


def _numbers(values: Vector) -> str:
    return ' '.join(f'{float(value) + 0.0!r}' for value in values)
