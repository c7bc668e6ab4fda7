"""
The sheet of a robot: a tree of rigid links, its actuators and the points that touch the ground.

Links are in depth-first order, each parent before its children; link 0 is the root. The joint of
a link leads from its parent to it, so that links and joints share one index. All values are SI,
lengths in metres along the axes that each field names. Vectors and matrices are tuples, so that
sheets compare and hash; numpy arrays are accepted where they are made (`vector`, `matrix`).

The frame of a joint has its place and rotation in the axes of the parent link at coordinate 0.
A turning joint turns the link about the z axis of that frame, a sliding joint moves it along z.
The columns of a rotation are the axes of the inner frame in those of the outer one.
"""

from collections.abc import Sequence
from dataclasses import field
import math
from typing import Literal, NamedTuple

from isa_ros.core.frozen import frozen
from isa_ros.core.parameter import fault, Parameters
from isa_ros.surroundings.ground import Ground
from isa_ros.surroundings.inertial_unit import UnitErrors
import numpy as np

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]
"""Of a rotation, row by row."""
JointKind = Literal['free', 'fixed', 'revolute', 'prismatic']

ORIGIN: Vector = (0.0, 0.0, 0.0)
UPRIGHT: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def vector(values: Sequence[float]) -> Vector:
    """Return three numbers as a `Vector`."""
    x, y, z = map(float, values)
    return x, y, z


def matrix(rows: Sequence[Sequence[float]]) -> Matrix:
    """Return three rows of three numbers as a `Matrix`."""
    first, second, third = map(vector, rows)
    return first, second, third


@frozen(kw_only=True)
class RobotJoint:
    """The joint between a link and its parent; that of link 0 is its joint to the world."""

    name: str
    kind: JointKind
    """Link 0: free or fixed; every other link: revolute or prismatic."""
    place: Vector = ORIGIN
    """Of the joint's frame, m, parent's axes; for a fixed root in the world, unused if free."""
    rotation: Matrix = UPRIGHT
    low: float = -math.inf
    """Lower end of its range, rad or m; the robot has no stop there but its actuators'."""
    high: float = math.inf


@frozen(kw_only=True)
class RobotLink:
    """A rigid link. Its frame is that of its joint, turned or moved by the coordinate."""

    name: str
    parent: int
    """Index of a link before it; -1 of link 0."""
    joint: RobotJoint
    mass: float
    """kg; 0 where other links carry all of it."""
    com: Vector = ORIGIN
    """Centre of mass, m, link axes."""
    inertia: tuple[float, float, float, float, float, float] = (0.0,) * 6
    """xx, yy, zz, xy, xz, yz about the centre of mass, kg m2, link axes; xy = -integral x y dm."""


@frozen(kw_only=True)
class RobotFrame:
    """A frame with a name that is fixed to a link: of a URDF's link, or of a sensor."""

    name: str
    link: int
    place: Vector = ORIGIN
    """m, link axes."""
    rotation: Matrix = UPRIGHT


class MovingPart(NamedTuple):
    """Piston or rotor of an actuator, behind its load cell or torque sensor."""

    mass: float = 0.0
    """kg | kg m2."""
    cell_stiffness: float = math.inf
    """Of the cell, N/m | Nm/rad."""


@frozen(kw_only=True, eq=False)
class JointLinkage:
    """A linkage that drives one joint: direct, slider-crank or four-bar (L3, L4, L5)."""

    link: int
    """Whose joint it drives."""
    linkage: np.record
    """`isa_ros.surroundings.linkage.LINKAGE`."""


@frozen(kw_only=True)
class Points:
    """A cylinder between two points of two links; its lever acts on every joint between (L23)."""

    link_a: int
    point_a: Vector
    """m, axes of link_a."""
    link_b: int
    point_b: Vector
    retracted_length: float
    """Distance of the points where the piston is at 0, m."""


@frozen(kw_only=True)
class RobotDrive:
    """An actuator of the robot; a force > 0 pushes it out, joint torque = lever * force."""

    actuator: str
    """Its name in the tables of the robot."""
    linkage: JointLinkage | Points


@frozen(kw_only=True)
class RobotContact:
    """A point of a link that may touch the ground, the plane z = 0."""

    name: str
    link: int
    point: Vector
    """m, link axes."""
    ground: Ground
    frame: str = ''
    """The frame, fixed to the link, in whose axes a foot's force is published; '': its own."""
    is_foot: bool = True
    """Feet carry the robot; trunk corners and knees are reported where they touch."""
    ends_run: bool = False
    """Whether the run ends where it touches."""


@frozen(kw_only=True)
class RobotSheet:
    """A robot. Drives are in the order of its rows; sample and state in that of these tuples."""

    links: tuple[RobotLink, ...]
    drives: tuple[RobotDrive, ...] = ()
    contacts: tuple[RobotContact, ...] = ()
    frames: tuple[RobotFrame, ...] = ()

    @property
    def is_free(self) -> bool:
        """Return whether the root moves: six coordinates of speed come before the joints'."""
        return self.links[0].joint.kind == 'free'

    @property
    def joints(self) -> tuple[RobotJoint, ...]:
        """Return the joints with a coordinate, (n,): those of the links after the root."""
        return tuple(link.joint for link in self.links[1:])

    @property
    def mass(self) -> float:
        """Return the mass of all links, kg."""
        total = 0.0
        for link in self.links:
            total += link.mass
        return total

    def frame_of(self, contact: RobotContact) -> RobotFrame:
        """Return the frame of a contact: the named one, or one at its point, axes of the link."""
        if not contact.frame:
            return RobotFrame(name=contact.name, link=contact.link, place=contact.point)
        return next(own for own in self.frames if own.name == contact.frame)

    def link(self, name: str) -> int:
        """Return the index of a link by its name; raises `ValueError` if there is none."""
        return [link.name for link in self.links].index(name)

    def path(self, link: int) -> list[int]:
        """Return the links from ``link`` up to a child of the root, the root left out."""
        found = []
        while link > 0:
            found.append(link)
            link = self.links[link].parent
        return found

    def driven(self, drive: RobotDrive) -> list[int]:
        """Return the links whose joints a drive acts on, ascending."""
        own = drive.linkage
        if isinstance(own, JointLinkage):
            return [own.link]
        return sorted(set(self.path(own.link_a)) ^ set(self.path(own.link_b)))


@frozen(kw_only=True)
class RobotStart:
    """The robot at rest at t = 0; what is held there is let go at the release."""

    joints: tuple[float, ...]
    """Coordinates, rad or m, (n,)."""
    position: Vector = ORIGIN
    """Of the root's origin in the world, m; unused if it is fixed."""
    quaternion: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    """w, x, y, z of the root's frame in the world, of length 1; unused if it is fixed."""
    is_root_held: bool = True
    """Whether a free root is held until the release."""
    held_joints: tuple[str, ...] = field(default=())
    """Joints without a drive that are held until the release."""


@frozen(kw_only=True)
class Push(Parameters):
    """What pushes a robot's root from outside, at its origin along the world's axes."""

    push_x: float = fault('force from outside on the root, forwards', 'N', ge=-1e5, le=1e5)
    push_y: float = fault('force from outside on the root, to the left', 'N', ge=-1e5, le=1e5)
    push_z: float = fault('force from outside on the root, upwards', 'N', ge=-1e5, le=1e5)
    push_roll: float = fault('moment from outside on the root about x', 'Nm', ge=-1e5, le=1e5)
    push_pitch: float = fault('moment from outside on the root about y', 'Nm', ge=-1e5, le=1e5)
    push_yaw: float = fault('moment from outside on the root about z', 'Nm', ge=-1e5, le=1e5)


class RobotUnit(NamedTuple):
    """An inertial measurement unit of a robot; readings as in the leg."""

    name: str
    link: int
    place: Vector
    """m, link axes."""
    rotation: Matrix
    """Its axes in those of the link: readings are along its own axes."""
    accelerometer_sigma: float
    """White noise of a reading, m/s2."""
    accelerometer_bias: float
    gyro_sigma: float
    """rad/s."""
    gyro_bias: float
    period_ns: int
    """Of its readings, a multiple of the tick."""
    key: int
    """Of its noise (`isa_ros.core.noise.noise_key`)."""
    errors: UnitErrors | None = None
    """As they are at the start; None: it cannot fail."""
