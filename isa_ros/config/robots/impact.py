"""The mass that a robot puts behind a force of the ground, for a check before a run."""

from collections.abc import Sequence
import math

from isa_ros.config.robots.geometry import point, poses
from isa_ros.config.robots.urdf_numbers import Floats, Pose
from isa_ros.surroundings.bodies.robot.sheet import RobotContact, RobotSheet
import numpy as np


def contact_masses(sheet: RobotSheet, joints: Sequence[float], root: Pose) -> list[float]:
    """
    Return 1/(J M^-1 J^T) of each contact, upwards, in a pose, in kg; infinite: it cannot move.

    J are the rows of the speeds of the root, if it is free, and of the joints; the actuators do
    not push. ``joints`` in rad or m, (n,).
    """
    at = poses(sheet.links, joints, root)
    mass = np.zeros((len(at) + 5,) * 2)
    for k, link in enumerate(sheet.links):
        moving, turning = _jacobians(sheet, at, k, point(at[k], link.com))
        xx, yy, zz, xy, xz, yz = link.inertia
        inertia = at[k].rotation @ np.array(
            [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ at[k].rotation.T
        mass += link.mass * moving.T @ moving + turning.T @ inertia @ turning
    own = slice(0 if sheet.is_free else 6, None)
    return [_mass_behind(mass[own, own], _upwards(sheet, at, contact)[own])
            for contact in sheet.contacts]


def _upwards(sheet: RobotSheet, at: list[Pose], contact: RobotContact) -> Floats:
    moving, _ = _jacobians(sheet, at, contact.link, point(at[contact.link], contact.point))
    row: Floats = moving[2]
    return row


def _mass_behind(mass: Floats, row: Floats) -> float:
    if not row.any():
        return math.inf
    return 1.0 / float(row @ np.linalg.solve(mass, row))


def _jacobians(
        sheet: RobotSheet, at: list[Pose], link: int, place: Floats) -> tuple[Floats, Floats]:
    """Return those of a point's velocity and of its link's angular velocity, (3, 6 + n) each."""
    moving, turning = np.zeros((2, 3, len(at) + 5))
    x, y, z = place - at[0].place
    moving[:, :3] = turning[:, 3:6] = np.eye(3)
    moving[:, 3:6] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
    for k in sheet.path(link):
        axis = at[k].rotation[:, 2]
        if sheet.links[k].joint.kind == 'prismatic':
            moving[:, k + 5] = axis
        else:
            moving[:, k + 5] = np.cross(axis, place - at[k].place)
            turning[:, k + 5] = axis
    return moving, turning
