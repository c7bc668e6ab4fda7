"""The pose of a robot at t = 0, in a run file."""

from collections.abc import Iterator, Mapping
import math
from typing import Any, NamedTuple

from isa_ros.config.robots.geometry import point, poses, quaternion
from isa_ros.config.robots.patterns import numbers_by_name
from isa_ros.config.robots.tree import RobotTree
from isa_ros.config.robots.urdf_numbers import Pose, turned
from isa_ros.config.text.key_tables import KeyTable
from isa_ros.config.text.keys import InText, Key, Leaf, ParameterSet, ValueKind
from isa_ros.config.text.sections import Place, section_at
from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import check, parameter, Parameters
from isa_ros.core.units import MILLI
from isa_ros.errors import ConfigError
from isa_ros.surroundings.bodies.robot.sheet import RobotContact, RobotStart, Vector, vector
import numpy as np


_ROUNDING = 1e-9    # m


@frozen(kw_only=True)
class RobotStartValues(Parameters):
    """Place and direction of the root at t = 0, and the time of its release."""

    x_mm: float = parameter("of the root's origin", 'mm', absent=0.0, ge=-1e7, le=1e7)
    y_mm: float = parameter("of the root's origin", 'mm', absent=0.0, ge=-1e7, le=1e7)
    height_mm: float = parameter(
        'of the lowest contact above the ground; of a fixed root, or a robot without contacts, of '
        "the root's origin", 'mm', absent=0.0, ge=-1e7, le=1e7)
    roll_deg: float = parameter('of the root', 'deg', absent=0.0, ge=-360.0, le=360.0)
    pitch_deg: float = parameter('of the root', 'deg', absent=0.0, ge=-360.0, le=360.0)
    yaw_deg: float = parameter('of the root', 'deg', absent=0.0, ge=-360.0, le=360.0)
    release_s: float = parameter(
        'a free root and joints without an actuator are held until then; 0: free', 's',
        absent=0.0, ge=0.0, le=1e6)


class RobotStartConfig(NamedTuple):
    """A pose of a robot."""

    root: RobotStartValues
    joints_deg: dict[str, float]
    """Of the joints that turn."""
    joints_mm: dict[str, float]
    """Of the joints that slide."""


class JointNumbers(ValueKind):
    """Numbers by joint, or by patterns of joints."""

    def __init__(self, unit: str) -> None:
        self.words, self.unit = 'numbers by joint or pattern', unit

    def read(self, tree: Any, place: Place) -> dict[str, float]:
        """Return the numbers; as `ValueKind.read`."""
        found: dict[str, float] = section_at(tree, place)   # type: ignore[assignment]
        for name, one in found.items():
            check(str(place / name), one, {'doc': 'of a joint', 'unit': self.unit, 'bounds': {}})
        return found

    def leaves(self, value: dict[str, float], key: str, row: Key) -> Iterator[Leaf]:
        """Yield each number."""
        for name, one in value.items():
            yield Leaf(f'{key}.{name}', one, row)


START = KeyTable((
    Key('joints_deg', JointNumbers('deg'),
        'joints that turn; others are at 0', {}, 'all 0', InText.ALWAYS),
    Key('joints_mm', JointNumbers('mm'),
        'joints that slide; others are at 0', {}, 'all 0', InText.ALWAYS)),
    rest=Key('root', ParameterSet(RobotStartValues), 'place of the root'))


def start_of(
        values: Mapping[str, Any], tree: RobotTree, before: RobotStartConfig | None,
        place: Place) -> RobotStartConfig:
    """
    Return the start of the values of `START`; joints that it leaves out are as ``before``.

    Raises
    ------
    ConfigError
        A joint is unknown, or outside its range.

    """
    found = []
    for key, kind, scale, unit, other in (
            ('joints_deg', 'revolute', math.radians(1.0), 'deg', 'joints_mm'),
            ('joints_mm', 'prismatic', MILLI, 'mm', 'joints_deg')):
        joints = {link.joint.name: link.joint for link in tree.links[1:]
                  if link.joint.kind == kind}
        others = {link.joint.name for link in tree.links[1:]} - set(joints)
        for name in values[key] or {}:
            if name in others:
                raise ConfigError(f'{place / key / name}: this joint belongs to {other}')
        own = dict.fromkeys(joints, 0.0)
        own.update((before.joints_deg if key == 'joints_deg' else before.joints_mm)
                   if before is not None else {})
        own.update(numbers_by_name(values[key] or {}, list(joints), place / key))
        for name, value in own.items():
            low, high = joints[name].low / scale, joints[name].high / scale
            if not low - 1e-9 <= value <= high + 1e-9:
                raise ConfigError(
                    f'{place / key / name} = {value:g} {unit}, must be within its range '
                    f'{low:g} to {high:g} {unit}')
        found.append({name: float(value) for name, value in own.items()})
    return RobotStartConfig(values['root'], *found)


def coordinates(start: RobotStartConfig, tree: RobotTree) -> tuple[float, ...]:
    """Return the coordinates of the joints, rad or m, (n,)."""
    return tuple(
        math.radians(start.joints_deg[link.joint.name]) if link.joint.kind == 'revolute'
        else MILLI * start.joints_mm[link.joint.name] for link in tree.links[1:])


def root_pose(
        start: RobotStartConfig, tree: RobotTree, contacts: tuple[RobotContact, ...]) -> Pose:
    """Return the pose of the root in the world."""
    own = start.root
    turn = turned(*(math.radians(angle) for angle in (
        own.roll_deg, own.pitch_deg, own.yaw_deg)))
    height = MILLI * own.height_mm
    if contacts and tree.links[0].joint.kind == 'free':
        at = poses(tree.links, coordinates(start, tree), Pose(np.zeros(3), turn))
        height -= min(point(at[own.link], own.point)[2] for own in contacts)
    return Pose(np.array([MILLI * own.x_mm, MILLI * own.y_mm, height]), turn)


def robot_start(
        start: RobotStartConfig, tree: RobotTree, contacts: tuple[RobotContact, ...],
        passive: tuple[str, ...]) -> RobotStart:
    """Return the start of the sheet, SI."""
    own = start.root
    at: Vector = vector(root_pose(start, tree, contacts).place.tolist())
    return RobotStart(
        joints=coordinates(start, tree), position=at, held_joints=passive,
        quaternion=quaternion(*(math.radians(angle) for angle in (
            own.roll_deg, own.pitch_deg, own.yaw_deg))))


def refuse_start(
        start: RobotStartConfig, tree: RobotTree, contacts: tuple[RobotContact, ...],
        place: Place) -> None:
    """Refuse a robot that starts in the ground."""
    root = root_pose(start, tree, contacts)
    at = poses(tree.links, coordinates(start, tree), root)
    for own in contacts:
        height = float(point(at[own.link], own.point)[2])
        if height < -_ROUNDING:
            raise ConfigError(
                f'{place}: the contact {own.name} is {-height / MILLI:.4g} mm below the ground, '
                'must be on it or above it')
