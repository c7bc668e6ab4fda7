"""Robots for tests: the leg as a tree, and trees drawn at random."""

from dataclasses import replace
import math

from isa_ros.surroundings.bodies.leg.sheet import JOINTS, LegSheet, linkage_record
from isa_ros.surroundings.bodies.robot.sheet import (
    JointLinkage, Matrix, ORIGIN, RobotContact, RobotDrive, RobotJoint, RobotLink, RobotSheet,
    vector)
import numpy as np

HIP: Matrix = ((0.0, 0.0, -1.0), (0.0, -1.0, 0.0), (-1.0, 0.0, 0.0))
THIGH: Matrix = ((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0))


def leg_as_tree(sheet: LegSheet) -> RobotSheet:
    """Return the rail, slider, hip, thigh and calf of a leg, frames as in its URDF."""
    own = sheet.body
    links = [
        RobotLink(name='rail', parent=-1, joint=RobotJoint(name='base', kind='fixed'), mass=0.0),
        RobotLink(name='slider', parent=0, joint=RobotJoint(name='slider', kind='prismatic'),
                  mass=own.slider.mass_kg)]
    places = {'haa': (ORIGIN, HIP), 'hfe': ((own.hip_drop_m, -own.hip.length_m, 0.0), THIGH),
              'kfe': ((own.thigh.length_m, 0.0, 0.0), RobotJoint(name='', kind='free').rotation)}
    for name, link in zip(JOINTS, ('hip', 'thigh', 'calf')):
        body, joint = getattr(own, link), getattr(sheet, name)
        place, rotation = places[name]
        s = own.mass_scale
        links.append(RobotLink(
            name=link, parent=len(links) - 1, mass=s * body.mass_kg,
            joint=RobotJoint(name=name, kind='revolute', place=place, rotation=rotation,
                             low=math.radians(joint.low_deg), high=math.radians(joint.high_deg)),
            com=(body.com_x_m, body.com_y_m, body.com_z_m),
            inertia=(s * body.inertia_xx, s * body.inertia_yy, s * body.inertia_zz,
                     0.0, 0.0, 0.0)))
    return RobotSheet(
        links=tuple(links),
        drives=tuple(RobotDrive(
            actuator=name, linkage=JointLinkage(
                link=2 + k, linkage=linkage_record(getattr(sheet, name))))
            for k, name in enumerate(JOINTS)),
        contacts=(RobotContact(name='foot', link=4, point=(own.calf.length_m, 0.0, 0.0),
                               ground=sheet.ground),))


def rotation(rng: np.random.Generator) -> Matrix:
    """Return a random rotation."""
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    q *= np.sign(np.linalg.det(q))
    x, y, z = (vector(row) for row in q)
    return x, y, z


def random_tree(rng: np.random.Generator, is_free: bool, n: int) -> RobotSheet:
    """Return a tree of n joints, turning or sliding, each on the last link or an earlier one."""
    def inertia() -> tuple[float, ...]:
        points = rng.normal(size=(4, 3)) * 0.1
        total = np.zeros((3, 3))
        for point in points:
            total += np.eye(3) * (point @ point) - np.outer(point, point)
        return (*total.diagonal(), total[0, 1], total[0, 2], total[1, 2])
    links = [RobotLink(
        name='root', parent=-1, mass=float(rng.uniform(1.0, 9.0)), com=vector(rng.normal(size=3)),
        joint=RobotJoint(name='base', kind='free' if is_free else 'fixed',
                         place=ORIGIN if is_free else vector(rng.normal(size=3)),
                         rotation=rotation(rng)), inertia=inertia())]
    branch = [0]
    for k in range(n):
        branch = branch[:int(rng.integers(1, len(branch) + 1))]
        links.append(RobotLink(
            name=f'link_{k}', parent=branch[-1], mass=float(rng.uniform(0.1, 5.0)),
            joint=RobotJoint(name=f'joint_{k}', place=vector(rng.normal(size=3)),
                             kind='revolute' if rng.random() < 0.7 else 'prismatic',
                             rotation=rotation(rng)),
            com=vector(0.3 * rng.normal(size=3)), inertia=inertia()))
        branch.append(k + 1)
    return RobotSheet(links=tuple(links))


def quadruped(sheet: LegSheet, ends_run: bool = False) -> RobotSheet:
    """Return a trunk of 60 kg on four legs of a sheet, all turned alike; four trunk corners."""
    one = leg_as_tree(sheet)
    links = [RobotLink(name='trunk', parent=-1, mass=60.0, inertia=(0.9, 6.3, 6.6, 0.0, 0.0, 0.0),
                       joint=RobotJoint(name='base', kind='free'))]
    drives, contacts = [], []
    for leg, x, y in (('lf', 0.44, 0.14), ('rf', 0.44, -0.14), ('lh', -0.44, 0.14),
                      ('rh', -0.44, -0.14)):
        at = len(links)
        for k, (link, drive) in enumerate(zip(one.links[2:], one.drives)):
            joint = replace(link.joint, name=f'{leg}_{link.joint.name}')
            links.append(replace(
                link, name=f'{leg}_{link.name}', parent=at + k - 1 if k else 0,
                joint=joint if k else replace(joint, place=(x, y, 0.0))))
            drives.append(RobotDrive(actuator=f'{leg}_{drive.actuator}_drive', linkage=replace(
                drive.linkage, link=at + k)))
        contacts += [replace(one.contacts[0], name=f'{leg}_foot', link=at + 2),
                     RobotContact(name=f'{leg}_corner', link=0, point=(1.2 * x, y, -0.12),
                                  ground=sheet.ground, is_foot=False, ends_run=ends_run)]
    return RobotSheet(links=tuple(links), drives=tuple(drives), contacts=tuple(contacts))
