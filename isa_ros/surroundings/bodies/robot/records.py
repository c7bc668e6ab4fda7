"""
The records of a robot in kernels: each has the constants of its sheet, and scratch of an instant.

All is in SI, along world axes and about O, the origin of a free root or that of the world. What
an instant leaves in the scratch belongs to the last state that was evaluated; states are rows of
floats of their own (`isa_ros.surroundings.bodies.robot.state`).
"""

from collections.abc import Sequence
from typing import NamedTuple

from isa_ros.core.record import rows_of
from isa_ros.surroundings.bodies.robot.sheet import (
    JointLinkage, Matrix, RobotDrive, RobotSheet, RobotStart, RobotUnit)
from isa_ros.surroundings.ground import GROUND, ground_record
from isa_ros.surroundings.linkage import LINKAGE
import numpy as np

ROOT_SPEEDS = 6     # of a free root: velocity, angular velocity

LINK = np.dtype([
    ('parent', '<i8'), ('is_sliding', '<i8'),
    ('place', '<f8', (3,)), ('rotation', '<f8', (9,)),  # of the joint's frame in the parent
    ('mass', '<f8'), ('com', '<f8', (3,)),
    ('inertia', '<f8', (6,)),           # at the centre of mass: xx yy zz xy xz yz
    # From outside, changed during a run:
    ('is_pushed', '<i8'),
    ('push_force', '<f8', (3,)),        # at its frame's origin
    ('push_moment', '<f8', (3,)),
    # Of an instant:
    ('axes', '<f8', (9,)),              # rotation from link axes
    ('origin', '<f8', (3,)),            # of its frame, from O
    ('velocity', '<f8', (3,)),          # of the link's point at O
    ('turning', '<f8', (3,)),           # angular velocity
    ('acceleration', '<f8', (3,)),      # without q'', gravity's reaction with it (L25)
    ('turning_rate', '<f8', (3,)),
    # Of it and, once summed up, of all links that it carries, about O (L26):
    ('sum_mass', '<f8'),
    ('sum_first', '<f8', (3,)),         # m c
    ('sum_second', '<f8', (6,)),        # moment of inertia
    ('sum_force', '<f8', (3,)),         # bias force
    ('sum_moment', '<f8', (3,)),        # its moment
])
SPEED = np.dtype([
    ('parent', '<i8'),                  # speed of the next joint towards the root, -1: none
    ('is_held', '<i8'),                 # until the release
    ('linear', '<f8', (3,)),            # motion of the links behind it by a unit of this speed:
    ('angular', '<f8', (3,)),           # velocity at O, angular velocity
])
DRIVE = np.dtype([
    ('is_between', '<i8'),              # 1: two points, 0: the linkage of one joint
    ('first', '<i8'), ('end', '<i8'),   # its rows of LEVER
    ('linkage', LINKAGE),
    ('link_a', '<i8'), ('point_a', '<f8', (3,)),
    ('link_b', '<i8'), ('point_b', '<f8', (3,)),
    ('retracted_length', '<f8'),
    ('moving_mass', '<f8'),             # of its piston or rotor, kg | kg m2; of a `MovingPart`
    ('inverse_mass', '<f8'),            # of its load, in the ports of this tick
    # Of an instant:
    ('position', '<f8'), ('velocity', '<f8'),
    ('curvature', '<f8'),               # J' q', what x'' has without q''
])
LEVER = np.dtype([
    ('speed', '<i8'),                   # place of its joint's speed
    ('sense', '<f8'),                   # +1: carries point_b, -1: carries point_a
    ('lever', '<f8'),                   # of an instant: dx/dq
])
CONTACT = np.dtype([
    ('link', '<i8'), ('point', '<f8', (3,)), ('ground', GROUND), ('is_foot', '<i8'),
    ('rotation', '<f8', (9,)),          # of its frame in the link
    ('arm', '<f8', (3,)),               # from the frame's origin, axes of the frame
    # Of an instant:
    ('position', '<f8', (3,)),          # from O
    ('velocity', '<f8', (3,)),
    ('force', '<f8', (3,)),             # from the ground
    ('shear_rate', '<f8', (2,)),
])
UNIT = np.dtype([
    ('link', '<i8'), ('place', '<f8', (3,)), ('rotation', '<f8', (9,)),
    ('sigma', '<f8', (6,)), ('bias', '<f8', (6,)),      # m/s2, rad/s
    ('key', '<u8'),                                     # of its noise
])


class RobotRecords(NamedTuple):
    """The records of a robot, and its scratch."""

    links: np.ndarray
    speeds: np.ndarray
    drives: np.ndarray
    levers: np.ndarray
    contacts: np.ndarray
    scratch: np.ndarray
    """Floats."""


def _nine(rotation: Matrix) -> list[float]:
    return [value for row in rotation for value in row]


def link_records(sheet: RobotSheet) -> np.ndarray:
    """Return the `LINK` rows of a sheet."""
    rows = rows_of(len(sheet.links), LINK)
    for row, link in zip(rows, sheet.links):
        row['parent'], row['is_sliding'] = link.parent, link.joint.kind == 'prismatic'
        if link.joint.kind != 'free':
            row['place'] = link.joint.place
        row['rotation'] = _nine(link.joint.rotation)
        row['mass'], row['com'], row['inertia'] = link.mass, link.com, link.inertia
    return rows


def speed_records(sheet: RobotSheet, start: RobotStart) -> np.ndarray:
    """Return the `SPEED` rows: those of a free root, then one per joint."""
    first = ROOT_SPEEDS if sheet.is_free else 0
    rows = rows_of(first + len(sheet.joints), SPEED)
    for k in range(first):
        rows[k]['parent'], rows[k]['is_held'] = k - 1, start.is_root_held
        rows[k]['linear' if k < 3 else 'angular'][k % 3] = 1.0
    for k, link in enumerate(sheet.links[1:]):
        rows[first + k]['parent'] = first + link.parent - 1
        rows[first + k]['is_held'] = link.joint.name in start.held_joints
    return rows


def drive_records(sheet: RobotSheet) -> tuple[np.ndarray, np.ndarray]:
    """Return the `DRIVE` rows of a sheet, and the `LEVER` rows that they refer to."""
    drives = rows_of(len(sheet.drives), DRIVE)
    levers = [(drive, link) for drive in sheet.drives for link in sheet.driven(drive)]
    rows = rows_of(len(levers), LEVER)
    first = ROOT_SPEEDS if sheet.is_free else 0
    for row, (drive, link) in zip(rows, levers):
        row['speed'], row['sense'] = first + link - 1, _sense(sheet, drive, link)
    end = 0
    for row, drive in zip(drives, sheet.drives):
        row['first'], row['end'] = end, end + len(sheet.driven(drive))
        end = row['end']
        own = drive.linkage
        if isinstance(own, JointLinkage):
            row['linkage'] = own.linkage
        else:
            row['is_between'] = 1
            for name in ('link_a', 'point_a', 'link_b', 'point_b', 'retracted_length'):
                row[name] = getattr(own, name)
    return drives, rows


def _sense(sheet: RobotSheet, drive: RobotDrive, link: int) -> float:
    own = drive.linkage
    if isinstance(own, JointLinkage):
        return 1.0
    return 1.0 if link in sheet.path(own.link_b) else -1.0


def contact_records(sheet: RobotSheet) -> np.ndarray:
    """Return the `CONTACT` rows of a sheet."""
    rows = rows_of(len(sheet.contacts), CONTACT)
    for row, contact in zip(rows, sheet.contacts):
        row['link'], row['point'] = contact.link, contact.point
        row['ground'], row['is_foot'] = ground_record(contact.ground), contact.is_foot
        frame = sheet.frame_of(contact)
        row['rotation'] = _nine(frame.rotation)
        row['arm'] = np.array(frame.rotation).T @ np.subtract(contact.point, frame.place)
    return rows


def unit_records(units: Sequence[RobotUnit]) -> np.ndarray:
    """Return the `UNIT` rows of inertial units."""
    rows = rows_of(len(units), UNIT)
    for row, unit in zip(rows, units):
        row['link'], row['place'], row['rotation'] = unit.link, unit.place, _nine(unit.rotation)
        row['sigma'] = 3 * [unit.accelerometer_sigma] + 3 * [unit.gyro_sigma]
        row['bias'] = 3 * [unit.accelerometer_bias] + 3 * [unit.gyro_bias]
        row['key'] = unit.key
    return rows
