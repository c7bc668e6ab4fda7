"""The drives of the bodies of a run over the ranges of their joints, and links in a plane."""

from collections.abc import Iterator
import math

from isa_ros.config.robots.drives import Linkage
from isa_ros.config.robots.geometry import motion_of, point, poses
from isa_ros.config.robots.reach import Reach, reach_of, swept
from isa_ros.config.robots.urdf_numbers import Pose
from isa_ros.config.runs.body_config import BodyConfig
from isa_ros.config.runs.leg_config import LegConfig
from isa_ros.config.runs.robot_config import RobotConfig
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.text.parameter_sets import kind_of
from isa_ros.config.text.sections import Place
from isa_ros.core.elementary import cos, sin
from isa_ros.core.frozen import frozen
from isa_ros.core.units import MILLI
from isa_ros.surroundings.bodies.robot.sheet import Points
from isa_ros.surroundings.linkage import (
    actuator_coordinate, DIRECT, FOUR_BAR, motion, rod_eye)
from isa_ros.surroundings.linkage_sheet import Joint, linkage_record
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
PARENT, CHILD, ROD = 'parent', 'child', 'rod'


@frozen(eq=False)
class PlaneLine:
    """A link or a cylinder, as points in the plane of the linkage."""

    part: str
    """`PARENT`, `CHILD` or `ROD`, the cylinder."""
    points: Floats
    """m, (n, 2)."""


@frozen(eq=False)
class DrawnDrive:
    """A drive of a body, with equal ones of it."""

    names: tuple[str, ...]
    kind: str
    reach: Reach
    start: float
    """Of the joint, rad or m."""
    position: float
    """Of the actuator at the start, m or rad."""
    stroke: float
    is_rotary: bool
    poses: tuple[tuple[PlaneLine, ...], ...]
    """At the lower end of the range, at the start, and at the upper end."""

    @property
    def scale(self) -> float:
        """Return what a position of the actuator is divided by, in the unit of data sheets."""
        return math.radians(1.0) if self.is_rotary else MILLI

    @property
    def unit(self) -> str:
        """Return that unit."""
        return 'deg' if self.is_rotary else 'mm'


def drives_of_run(run: RunConfig) -> list[DrawnDrive]:
    """Return the drives of all bodies that move one joint each, equal ones together."""
    found: dict[object, DrawnDrive] = {}
    for body in run.bodies:
        for key, drive in _drives(run, body):
            if key in found:
                other = found[key]
                drive = DrawnDrive(
                    (*other.names, *drive.names), other.kind, other.reach, other.start,
                    other.position, other.stroke, other.is_rotary, other.poses)
            found[key] = drive
    return list(found.values())


def _drives(run: RunConfig, body: BodyConfig) -> Iterator[tuple[object, DrawnDrive]]:
    """Yield each drive of a body with what makes it equal to others."""
    if isinstance(body, LegConfig):
        for joint, actuator in body.joints:
            sheet: Joint = getattr(body.sheet, joint)
            yield _one_joint(
                run, f'{body.prefix}{joint}', actuator, sheet, body.start.angle(joint))
    elif isinstance(body, RobotConfig):
        for own, drive in zip(body.drives, body.sheet.drives):
            reach = reach_of(body.sheet, drive, own, body.coordinates, Place(own.name))
            if reach is None:
                continue
            link = body.sheet.driven(drive)[0]
            start = body.coordinates[link - 1]
            name = f'{body.prefix}{own.name}'
            if isinstance(own.linkage, Joint):
                yield _one_joint(run, name, own.actuator, own.linkage, start)
                continue
            assert isinstance(drive.linkage, Points)
            moved = run.actuator(own.actuator).sheet
            ends = (reach.coordinates[0], start, reach.coordinates[-1])
            yield name, DrawnDrive(
                (name,), 'cylinder', reach, start, motion_of(
                    body.sheet, drive, body.coordinates)[0], moved.plant.drive.stroke,
                moved.is_rotary, tuple(
                    _in_plane(body, drive.linkage, link, float(q)) for q in ends))


def _one_joint(
        run: RunConfig, name: str, actuator: str, sheet: Joint,
        start: float) -> tuple[object, DrawnDrive]:
    """Return the drive of a linkage of one joint."""
    own, row = run.actuator(actuator).sheet, linkage_record(sheet)
    reach = swept(name, True, math.radians(sheet.low_deg), math.radians(sheet.high_deg),
                  lambda angles: motion(angles, row))
    ends = (reach.coordinates[0], start, reach.coordinates[-1])
    stroke = own.plant.drive.stroke
    return (sheet, start, stroke), DrawnDrive(
        (name,), kind_of(sheet, Linkage), reach, start, float(actuator_coordinate(start, row)[0]),
        stroke, own.is_rotary, tuple(linkage_lines(float(q), row) for q in ends))


def linkage_lines(q: float, row: np.record) -> tuple[PlaneLine, ...]:
    """Return the lines of a linkage of one joint, which is at (0, 0); axes as in L3 to L5."""
    theta = row.sense * q + row.offset
    c, s = cos(float(theta)), sin(float(theta))
    if row.kind == DIRECT:
        return (PlaneLine(CHILD, np.array([[0.0, 0.0], [c, s]])),)
    if row.kind == FOUR_BAR:
        a, b, pin = [row.ak_x, row.ak_y], [row.bk * c, row.bk * s], [row.c_x, row.c_y]
        eye = list(rod_eye(q, row))
        return (PlaneLine(PARENT, np.array([a, [0.0, 0.0], pin])),
                PlaneLine(CHILD, np.array([[0.0, 0.0], b])),
                PlaneLine(CHILD, np.array([a, eye, b])),
                PlaneLine(ROD, np.array([pin, eye])))
    a, b = [row.a, 0.0], [row.b * c, row.b * s]
    return (PlaneLine(PARENT, np.array([[0.0, 0.0], a])),
            PlaneLine(CHILD, np.array([[0.0, 0.0], b])),
            PlaneLine(ROD, np.array([a, b])))


def _in_plane(body: RobotConfig, own: Points, link: int, q: float) -> tuple[PlaneLine, ...]:
    """Return the lines of a cylinder across the axis of the joint that it moves."""
    sheet = body.sheet
    joints = list(body.coordinates)
    joints[link - 1] = q
    at = poses(sheet.links, joints, Pose(np.zeros(3), np.eye(3)))
    base, rod = point(at[own.link_a], own.point_a), point(at[own.link_b], own.point_b)
    is_parent = link not in sheet.path(own.link_a)      # whether the base stays
    joint, fixed = sheet.links[link].joint, at[sheet.links[link].parent]
    axes = fixed.rotation @ np.array(joint.rotation)
    centre = point(fixed, joint.place)
    across = _plane(axes, joint.kind == 'revolute')
    first, second, middle = ((place - centre) @ across for place in (base, rod, at[link].place))
    return (PlaneLine(PARENT if is_parent else CHILD, np.array([middle, first])),
            PlaneLine(CHILD if is_parent else PARENT, np.array([middle, second])),
            PlaneLine(ROD, np.array([first, second])))


def _plane(axes: Floats, turns: bool) -> Floats:
    """Return two directions of the plane to draw, the columns of (3, 2)."""
    if not turns:       # along the axis, and across it
        return axes[:, [0, 2]]
    up = np.array([0.0, 0.0, 1.0])
    normal = axes[:, 2]
    second = up - (up @ normal) * normal
    length = float(np.linalg.norm(second))
    if length < 1e-6:   # a vertical axis: seen from above
        return axes[:, :2]
    second /= length
    first = np.cross(second, normal)
    if first[np.argmax(np.abs(first))] < 0.0:   # forward, or left, is to the right
        first = -first
    return np.column_stack([first, second])
