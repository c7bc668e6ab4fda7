"""
The legs of a robot for its controller: places, speeds and Jacobians of the feet, and weights.

All vectors are in world axes and from the origin of the root. Links without a speed of their own,
so the torques of gravity are those of the weights alone: centrifugal and inertial forces of the
legs are left to the feedback.
"""

from collections.abc import Sequence
from typing import NamedTuple

from isa_ros.core.bound import Bound
from isa_ros.core.constants import STANDARD_GRAVITY
from isa_ros.core.elementary import cos, sin
from isa_ros.core.kernel import kernel
from isa_ros.errors import ConfigError
from isa_ros.surroundings.bodies.robot.sheet import RobotContact, RobotSheet
import numpy as np
from numpy.typing import NDArray

LEGS, JOINTS = 4, 3
"""Legs of the robot, and joints of a leg, each turning."""


@kernel
def place_links(root, angles, parents, rotations, places, frames, origins):
    """Fill the rotations, (n, 3, 3), and origins, (n, 3), of all links; ``root`` is (3, 3)."""
    for a in range(3):
        origins[0, a] = 0.0
        for b in range(3):
            frames[0, a, b] = root[a, b]
    for i in range(1, len(parents)):
        p = parents[i]
        c, s = cos(angles[i - 1]), sin(angles[i - 1])
        for a in range(3):
            x = y = z = 0.0
            origins[i, a] = origins[p, a]
            for b in range(3):
                origins[i, a] += frames[p, a, b] * places[i, b]
                x += frames[p, a, b] * rotations[i, b, 0]
                y += frames[p, a, b] * rotations[i, b, 1]
                z += frames[p, a, b] * rotations[i, b, 2]
            frames[i, a, 0], frames[i, a, 1], frames[i, a, 2] = c * x + s * y, c * y - s * x, z


@kernel
def weigh_links(parents, masses, coms, frames, origins, com, holding):
    """
    Fill the centre of mass, (3,), and the torques that hold the links against gravity, (n - 1,).

    tau_j = g sum m_i (z_j x (c_i - o_j))_z over the links i that joint j carries.
    """
    total = 0.0
    for a in range(3):
        com[a] = 0.0
    for j in range(len(holding)):
        holding[j] = 0.0
    for i in range(len(parents)):
        x = y = z = 0.0
        for b in range(3):
            x += frames[i, 0, b] * coms[i, b]
            y += frames[i, 1, b] * coms[i, b]
            z += frames[i, 2, b] * coms[i, b]
        x += origins[i, 0]
        y += origins[i, 1]
        z += origins[i, 2]
        total += masses[i]
        com[0] += masses[i] * x
        com[1] += masses[i] * y
        com[2] += masses[i] * z
        j = i
        while j > 0:
            holding[j - 1] += STANDARD_GRAVITY * masses[i] * (
                frames[j, 0, 2] * (y - origins[j, 1]) - frames[j, 1, 2] * (x - origins[j, 0]))
            j = parents[j]
    for a in range(3):
        com[a] /= total


@kernel
def place_feet(speeds, turning, paths, points, frames, origins, feet, velocities, jacobians):
    """
    Fill the places and speeds of the feet from the root's origin, (f, 3), and d place / d joint.

    ``turning`` is the angular velocity of the root, ``paths`` the links of each leg, (f, 3).
    """
    for k in range(len(feet)):
        link = paths[k, JOINTS - 1]
        for a in range(3):
            feet[k, a] = origins[link, a]
            for b in range(3):
                feet[k, a] += frames[link, a, b] * points[k, b]
        for a in range(3):
            b, c = (a + 1) % 3, (a + 2) % 3
            velocities[k, a] = turning[b] * feet[k, c] - turning[c] * feet[k, b]
            for m in range(JOINTS):
                i = paths[k, m]
                jacobians[k, a, m] = (
                    frames[i, b, 2] * (feet[k, c] - origins[i, c])
                    - frames[i, c, 2] * (feet[k, b] - origins[i, b]))
                velocities[k, a] += jacobians[k, a, m] * speeds[i - 1]


class LegsTree(NamedTuple):
    """Of n links and f legs: joint i - 1 moves link i, `paths_of`, feet in their last links."""

    parents: np.ndarray
    rotations: np.ndarray
    places: np.ndarray
    masses: np.ndarray
    coms: np.ndarray
    paths: np.ndarray
    points: np.ndarray


class RobotMotion(NamedTuple):
    """Rotation of the root, (3, 3), its angular velocity, (3,), and all joints, (n - 1,)."""

    root: np.ndarray
    turning: np.ndarray
    angles: np.ndarray
    speeds: np.ndarray


class Updated(NamedTuple):
    """What `Legs.update` fills; meaning as there."""

    frames: np.ndarray
    origins: np.ndarray
    com: np.ndarray
    holding: np.ndarray
    feet: np.ndarray
    velocities: np.ndarray
    jacobians: np.ndarray


class Updating(NamedTuple):
    """Memory of `update_legs`."""

    motion: RobotMotion
    tree: LegsTree
    out: Updated


@kernel
def update_legs(own):
    """Fill all of ``own.out``; return 0."""
    motion, tree, out = own.motion, own.tree, own.out
    place_links(motion.root, motion.angles, tree.parents, tree.rotations, tree.places, out.frames,
                out.origins)
    weigh_links(tree.parents, tree.masses, tree.coms, out.frames, out.origins, out.com,
                out.holding)
    place_feet(motion.speeds, motion.turning, tree.paths, tree.points, out.frames, out.origins,
               out.feet, out.velocities, out.jacobians)
    return 0


def paths_of(sheet: RobotSheet) -> NDArray[np.int64]:
    """
    Return the links of each leg of a robot from the trunk to the foot, (f, 3).

    Raises
    ------
    ConfigError
        It has another number of feet, or a leg another number of joints, or one that slides.

    """
    feet = _feet(sheet)
    if len(feet) != LEGS:
        raise ConfigError(f'number of feet = {len(feet)}, must be {LEGS}')
    paths = [sheet.path(foot.link)[::-1] for foot in feet]
    for foot, path in zip(feet, paths):
        kinds = [sheet.links[i].joint.kind for i in path]
        if kinds != ['revolute'] * JOINTS:
            raise ConfigError(
                f'{foot.name}: its leg has {len(path)} joints ({", ".join(kinds)}), must have '
                f'{JOINTS} that turn')
    return np.array(paths, np.int64)


def _feet(sheet: RobotSheet) -> Sequence[RobotContact]:
    return [own for own in sheet.contacts if own.is_foot]


class Legs:
    """
    The legs of a robot, one to each of its feet, of three turning joints each.

    Raises
    ------
    ConfigError
        As `paths_of`.

    """

    def __init__(self, sheet: RobotSheet) -> None:
        links = sheet.links
        self.feet_of = _feet(sheet)
        """The feet, (f,)."""
        self.paths = paths_of(sheet)
        """Links of each leg from the trunk to the foot, (f, 3); joint i - 1 moves link i."""
        n, f = len(links), len(self.paths)
        self.mass = sheet.mass
        tree = LegsTree(
            np.array([link.parent for link in links], np.int64),
            np.array([link.joint.rotation for link in links]),
            np.array([link.joint.place for link in links]),
            np.array([link.mass for link in links]), np.array([link.com for link in links]),
            self.paths, np.array([foot.point for foot in self.feet_of]))
        self.com, self.holding = np.zeros(3), np.zeros(n - 1)
        self.feet, self.velocities = np.zeros((f, 3)), np.zeros((f, 3))
        self.jacobians = np.zeros((f, 3, JOINTS))
        self._frames, self.origins = np.zeros((n, 3, 3)), np.zeros((n, 3))
        self._motion = RobotMotion(np.zeros((3, 3)), np.zeros(3), np.zeros(n - 1), np.zeros(n - 1))
        self._update = Bound(update_legs, Updating(self._motion, tree, Updated(
            self._frames, self.origins, self.com, self.holding, self.feet, self.velocities,
            self.jacobians)))

    def update(self, root: np.ndarray, turning: np.ndarray, angles: np.ndarray,
               speeds: np.ndarray) -> None:
        """
        Take the root's rotation, (3, 3), and angular velocity, (3,), and all joints, (n - 1,).

        Then ``feet`` and ``velocities`` (less that of the root's origin), ``jacobians``,
        ``origins`` of the links, (n, 3), ``com`` and ``holding`` are those of now, until the next
        call.
        """
        for own, given in zip(self._motion, (root, turning, angles, speeds)):
            own[:] = given
        self._update.run()

    def torques(self, forces: np.ndarray) -> np.ndarray:
        """Return J^T f of forces on the feet, N, (f, 3): of each leg's joints, (3 f,), Nm."""
        found: np.ndarray = np.einsum('fam,fa->fm', self.jacobians, forces).ravel()
        return found

    def inertia(self, sheet: RobotSheet) -> np.ndarray:
        """Return the inertia about the centre of mass after an `update`, kg m2, (3, 3)."""
        total = np.zeros((3, 3))
        for link, frame, origin in zip(sheet.links, self._frames, self.origins):
            xx, yy, zz, xy, xz, yz = link.inertia
            own = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
            arm = origin + frame @ np.array(link.com) - self.com
            total += frame @ own @ frame.T + link.mass * (
                np.dot(arm, arm) * np.eye(3) - np.outer(arm, arm))
        return total
