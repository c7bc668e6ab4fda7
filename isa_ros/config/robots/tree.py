"""
The tree of a robot made of a URDF: fixed joints merged, the axis of every other joint turned to z.

A link of the tree has the frame of its joint with the axis as z (the other two by the shortest
turn). Every link of the URDF keeps its own axes as a frame of the link that it is part of.
"""

from collections.abc import Iterator
from typing import NamedTuple

from isa_ros.config.paths import drawings, find_drawing
from isa_ros.config.robots.urdf import load_urdf, Urdf, UrdfJoint
from isa_ros.config.robots.urdf_numbers import Floats, Pose
from isa_ros.config.text.sections import Place
from isa_ros.errors import ConfigError
from isa_ros.surroundings.bodies.robot.sheet import (
    JointKind, Matrix, matrix, RobotFrame, RobotJoint, RobotLink, Vector, vector)
import numpy as np

ROOT_JOINT = 'root'
_KINDS: dict[str, JointKind] = {
    'revolute': 'revolute', 'continuous': 'revolute', 'prismatic': 'prismatic'}


class RobotTree(NamedTuple):
    """Links of a robot in depth-first order, and the frames of the links of its URDF."""

    links: tuple[RobotLink, ...]
    frames: tuple[RobotFrame, ...]


class _Part(NamedTuple):
    """A link of the URDF as part of a link of the tree."""

    name: str
    pose: Pose
    """In the axes of the link of the tree."""


def tree_of_file(name: str, is_free: bool, place: Place) -> RobotTree:
    """Return the tree of a URDF beside the run file at a place, or of a shipped one."""
    path = place.folder / name
    where = f'{place / "urdf"} = {name}'
    try:
        if not path.is_file():
            path = find_drawing(f'urdf/{name}')
    except ConfigError as error:
        raise ConfigError(f'{where}: there is no such file in the folder of the run file; '
                          f'shipped: {", ".join(drawings("urdf"))}') from error
    return tree_of(load_urdf(path), is_free, path.name)


def tree_of(urdf: Urdf, is_free: bool, where: str) -> RobotTree:
    """
    Return the tree of a URDF; messages begin with ``where``.

    A floating joint may only lead from the root, a link without inertia, to the robot; the robot
    is then its child.

    Raises
    ------
    ConfigError
        A floating joint is elsewhere or contradicts ``is_free``, or a link that moves has no
        inertia.

    """
    below: dict[str, list[UrdfJoint]] = {name: [] for name in urdf.links}
    for joint in urdf.joints:
        below[joint.parent].append(joint)
    root = _body_of(urdf, below, is_free, where)
    links: list[RobotLink] = []
    frames: list[RobotFrame] = []

    def add(name: str, parent: int, joint: RobotJoint, turn: Floats) -> None:
        own = len(links)
        parts = list(_parts(name, Pose(np.zeros(3), turn.T), below, urdf, where))
        mass, com, inertia = _together(urdf, parts)
        if (own or is_free) and not mass > 0.0:
            raise ConfigError(
                f'{where}: link {name} has no inertia, must have <inertial> with a mass > 0 kg: '
                f'{joint.name if own else "a free root"} moves it')
        links.append(RobotLink(
            name=name, parent=parent, joint=joint, mass=mass, com=_vector(com),
            inertia=(*_vector(np.diag(inertia)),
                     *_vector(inertia[(0, 0, 1), (1, 2, 2)]))))
        frames.extend(RobotFrame(name=part.name, link=own, place=_vector(part.pose.place),
                                 rotation=_matrix(part.pose.rotation)) for part in parts)
        for part in parts:
            for onward in below[part.name]:
                if onward.kind == 'fixed':
                    continue
                z_turn = z_along(onward.axis)
                origin = composed(part.pose, onward.origin)
                add(onward.child, own, RobotJoint(
                    name=onward.name, kind=_KINDS[onward.kind], place=_vector(origin.place),
                    rotation=_matrix(origin.rotation @ z_turn), low=onward.low,
                    high=onward.high), z_turn)
    add(root, -1, RobotJoint(name=ROOT_JOINT, kind='free' if is_free else 'fixed'), np.eye(3))
    return RobotTree(tuple(links), tuple(frames))


def _body_of(
        urdf: Urdf, below: dict[str, list[UrdfJoint]], is_free: bool, where: str) -> str:
    """Return the link that is the root of the robot, behind a floating joint if there is one."""
    floating = [joint for joint in urdf.joints if joint.kind == 'floating']
    if not floating:
        return urdf.root
    joint = floating[0]
    if (len(floating) > 1 or joint.parent != urdf.root or len(below[urdf.root]) > 1
            or urdf.links[urdf.root].mass > 0.0):
        raise ConfigError(
            f'{where}: joint {joint.name} is floating, must be the only joint of the root '
            f'{urdf.root}, which must have no inertia')
    if not is_free:
        raise ConfigError(
            f'{where}: joint {joint.name} is floating, must be fixed for a robot with root: fixed')
    return joint.child


def _parts(
        name: str, pose: Pose, below: dict[str, list[UrdfJoint]], urdf: Urdf,
        where: str) -> Iterator[_Part]:
    """Yield a link and all that is fixed to it."""
    yield _Part(name, pose)
    for joint in below[name]:
        if joint.kind == 'fixed':
            yield from _parts(joint.child, composed(pose, joint.origin), below, urdf, where)


def composed(outer: Pose, inner: Pose) -> Pose:
    """Return a pose that is given in the axes of ``outer``, in those that outer is given in."""
    return Pose(outer.place + outer.rotation @ inner.place, outer.rotation @ inner.rotation)


def z_along(axis: Floats) -> Floats:
    """Return the rotation whose z is ``axis``, by the shortest turn: I + [v] + [v]^2/(1 + c)."""
    x, y, z = map(float, axis)
    if z == 1.0:
        return np.eye(3)
    if z < 0.0:     # first half a turn about x, which is exact, then a short one
        return np.diag([1.0, -1.0, -1.0]) @ z_along(np.array([x, -y, -z]))
    cross = np.array([[0.0, 0.0, x], [0.0, 0.0, y], [-x, -y, 0.0]])     # of v = e_z x axis
    rotation: Floats = np.eye(3) + cross + cross @ cross / (1.0 + z)
    return rotation


def _together(urdf: Urdf, parts: list[_Part]) -> tuple[float, Floats, Floats]:
    """Return mass, centre of mass and inertia about it of links that are fixed together."""
    each = [(urdf.links[part.name], part.pose) for part in parts]
    places = [pose.place + pose.rotation @ link.com for link, pose in each]
    mass, moment = 0.0, np.zeros(3)
    for (link, _), place in zip(each, places):
        mass += link.mass
        moment += link.mass * place
    if mass == 0.0:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    com, inertia = moment / mass, np.zeros((3, 3))
    for (link, pose), place in zip(each, places):
        off = place - com
        inertia += pose.rotation @ link.inertia @ pose.rotation.T + link.mass * (
            (off @ off) * np.eye(3) - np.outer(off, off))
    return mass, com, inertia


def _vector(values: Floats) -> Vector:
    """Return a vector of the sheet; no zero is negative in it."""
    return vector((values + 0.0).tolist())


def _matrix(values: Floats) -> Matrix:
    return matrix((values + 0.0).tolist())
