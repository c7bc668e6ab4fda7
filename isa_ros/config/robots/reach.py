"""What a drive of a robot does over the range of its joint, and what it cannot do."""

from collections.abc import Callable
import math

from isa_ros.config.robots.drives import CylinderBetweenLinks, DriveConfig
from isa_ros.config.robots.geometry import motion_of
from isa_ros.config.text.sections import Place
from isa_ros.core.frozen import frozen
from isa_ros.core.units import MILLI
from isa_ros.errors import ConfigError
from isa_ros.surroundings.bodies.robot.sheet import JointLinkage, RobotDrive, RobotSheet
from isa_ros.surroundings.linkage import motion
from isa_ros.surroundings.linkage_sheet import (
    CHECKED_ANGLES, is_short, Joint, LEVER_RULE, SHORTEST_LEVER)
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@frozen(eq=False)
class Reach:
    """A drive over the range of the one joint that it moves."""

    joint: str
    turns: bool
    """Whether the joint turns: coordinates in rad, else in m."""
    coordinates: Floats
    """Of the joint, ascending, (n,)."""
    positions: Floats
    """Of the actuator, m or rad, (n,)."""
    levers: Floats
    """Change of the position with the coordinate, (n,)."""

    @property
    def scale(self) -> float:
        """Return what a coordinate is divided by, in the units of a run file."""
        return math.radians(1.0) if self.turns else MILLI

    @property
    def unit(self) -> str:
        """Return the unit of a joint in a run file."""
        return 'deg' if self.turns else 'mm'


def swept(
        joint: str, turns: bool, low: float, high: float,
        at: Callable[[Floats], Floats]) -> Reach:
    """Return a drive over a range; ``at`` gives positions and levers at coordinates, (2, n)."""
    coordinates = np.linspace(low, high, CHECKED_ANGLES)
    return Reach(joint, turns, coordinates, *at(coordinates))


def reach_of(
        sheet: RobotSheet, drive: RobotDrive, own: DriveConfig, joints: tuple[float, ...],
        place: Place) -> Reach | None:
    """
    Return a drive over the range of its joint, None if it moves several.

    Raises
    ------
    ConfigError
        The range is not limited, or wider than that of the URDF.

    """
    moved = sheet.driven(drive)
    if len(moved) != 1:
        return None
    joint = sheet.links[moved[0]].joint
    turns = joint.kind == 'revolute'
    scale = math.radians(1.0) if turns else MILLI
    low, high = joint.low, joint.high
    if isinstance(own.linkage, Joint):
        low, high = (math.radians(end) for end in (own.linkage.low_deg, own.linkage.high_deg))
    elif own.joint_range is not None:
        low, high = (scale * end for end in own.joint_range)
        if low < joint.low - 1e-9 or high > joint.high + 1e-9:
            raise ConfigError(
                f'{place / "range"} = {own.joint_range[0]:g} to {own.joint_range[1]:g}, must be '
                f'within the {joint.low / scale:g} to {joint.high / scale:g} '
                f'{"deg" if turns else "mm"} of the joint {joint.name} in the URDF')
    if not math.isfinite(high - low):
        raise ConfigError(place.has(
            f'lacks range, which it needs: the joint {joint.name} of the URDF is continuous'))

    def at(coordinates: Floats) -> Floats:
        if isinstance(drive.linkage, JointLinkage):
            return motion(coordinates, drive.linkage.linkage)
        found, pose = np.zeros((2, len(coordinates))), list(joints)
        for k, q in enumerate(coordinates.tolist()):
            pose[moved[0] - 1] = q
            found[0, k], (found[1, k],) = motion_of(sheet, drive, pose)
        return found
    return swept(joint.name, turns, low, high, at)


def refuse_lever(
        sheet: RobotSheet, drive: RobotDrive, own: DriveConfig, joints: tuple[float, ...],
        place: Place) -> None:
    """
    Refuse a cylinder that passes its dead centre; the linkages of one joint check themselves.

    Raises
    ------
    ConfigError
        Its lever changes its sign in the range of the joint, or is too short for a port.

    """
    if not isinstance(own.linkage, CylinderBetweenLinks):
        return
    reach = reach_of(sheet, drive, own, joints, place)
    if reach is None:
        _, levers = motion_of(sheet, drive, joints)
        if max(map(abs, levers)) < SHORTEST_LEVER:
            names = [sheet.links[link].joint.name for link in sheet.driven(drive)]
            raise ConfigError(
                f'{place} moves nothing at the start: its levers on {", ".join(names)} are < '
                f'{1e3 * SHORTEST_LEVER:g} mm')
        return
    for q, lever in zip(reach.coordinates, reach.levers):
        if is_short(float(lever), float(reach.levers[0])):
            raise ConfigError(
                f'{place}: its lever is {1e3 * lever:.2f} mm at {reach.joint} = '
                f'{q / reach.scale:.2f} {reach.unit}, a dead centre or close to it; from '
                f'{reach.coordinates[0] / reach.scale:g} to '
                f'{reach.coordinates[-1] / reach.scale:g} {reach.unit} it must {LEVER_RULE}')


def refuse_stroke(reach: Reach, stroke: float, is_rotary: bool, where: str) -> None:
    """
    Refuse an actuator whose stroke (m or rad) does not cover the range of its joint.

    Raises
    ------
    ConfigError
        It is too short, or its retracted length does not fit.

    """
    inside = (reach.positions >= -1e-9) & (reach.positions <= stroke + 1e-9)
    if inside.all():
        return
    scale, unit = (math.radians(1.0), 'deg') if is_rotary else (MILLI, 'mm')
    least, most = float(reach.positions.min()), float(reach.positions.max())
    low, high = (reach.coordinates[end] / reach.scale for end in (0, -1))
    covered = reach.coordinates[inside] / reach.scale
    remedy = 'with it no part of the range is reached' if not inside.any() else (
        f'it reaches {covered[0]:.1f} to {covered[-1]:.1f} {reach.unit}')
    raise ConfigError(
        f'{where}: the range of {reach.joint}, {low:g} to {high:g} {reach.unit}, takes it from '
        f'{least / scale:.4g} to {most / scale:.4g} {unit}, must be within its stroke, 0 to '
        f'{stroke / scale:.4g} {unit}; {remedy}')
