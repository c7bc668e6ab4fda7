"""
Write urdf/hyq_quadruped.urdf and urdf/hyq_real_quadruped.urdf.

    python scripts/write_quadrupeds.py

Masses, centres, inertias, places, axes and ranges are facts of two published descriptions:
github.com/iit-DLSLab/hyq-description (urdfs/common.xacro, urdfs/leg, commit f95d651) and
github.com/siddharthdeore/hyqreal_mujoco (robot_description/hyqreal_body.urdf, commit ad09aff).
Names and the shapes that are drawn and collide are our own. Assumed: sizes of the trunks' boxes,
radii of the rods, and the place of the inertial unit, at the origin of the trunk.

Thigh and calf have x along the link, y backward, z left in all legs, so that an angle means the
same left and right. A leg of the right side has the hip of the left one, mirrored: the published
HyQ-REAL mirrors its thighs but not its hips, 3.6 mm off the axis of HAA, which is taken for an
oversight. HyQ's hind legs are its front legs turned by 180 deg about the vertical, so that their
angles have the opposite sign; HyQ-REAL's four knees point the same way.
"""

from collections.abc import Iterator, Sequence
import math
from pathlib import Path
from typing import NamedTuple

URDF = Path(__file__).resolve().parents[1] / 'urdf'
HALF = 0.5 * math.pi
SPEED = 12.0            # rad/s, of every joint of both
MIRRORED = (1.0, 1.0, -1.0)     # z of the hip
TURNED = (1.0, -1.0, -1.0)      # by 180 deg about the link
SAME = (1.0, 1.0, 1.0)
Numbers = Sequence[float]


class RigidBody(NamedTuple):
    """Mass (kg), centre (m) and inertia xx yy zz xy xz yz about it (kg m2), link axes."""

    mass: float
    com: Numbers
    inertia: Numbers

    def seen(self, signs: Numbers) -> 'RigidBody':
        """Return it in axes of other signs."""
        x, y, z = signs
        xx, yy, zz, xy, xz, yz = self.inertia
        return RigidBody(self.mass, [sign * own for sign, own in zip(signs, self.com)],
                         (xx, yy, zz, x * y * xy, x * z * xz, y * z * yz))


class Quadruped(NamedTuple):
    """A quadruped."""

    title: str
    source: str
    trunk: RigidBody
    box: Numbers
    """Edges of the trunk's box, m."""
    hip: RigidBody
    thigh: RigidBody
    calf: RigidBody
    haa: Numbers
    """Place of the left front HAA on the trunk, m; the others are mirrored."""
    hfe: Numbers
    """Place of HFE on the hip, m."""
    lengths: Numbers
    """Of thigh and calf, m."""
    ranges: Sequence[Numbers]
    """Of HAA, HFE and KFE of a front leg, deg."""
    efforts: Numbers
    """Nm."""
    has_turned_hind_legs: bool


HYQ_REAL = Quadruped(
    'hyq_real_quadruped', 'hyqreal_mujoco, robot_description/hyqreal_body.urdf',
    trunk=RigidBody(59.0, (-0.015, -0.00186, -0.03465),
                    (1.498728, 9.492381, 9.012359, -0.007369, -0.189135, 0.000185)),
    box=(1.1, 0.35, 0.25),
    hip=RigidBody(4.973275, (-0.010027, -0.010608, 0.003644),
                  (0.011231, 0.015768, 0.016863, -0.000592, 0.000225, 0.000224)),
    thigh=RigidBody(5.877927, (0.107987, -0.011459, -0.002121),
                    (0.016432, 0.075737, 0.079267, 0.001863, 0.003897, -0.00024)),
    calf=RigidBody(1.291954, (0.149302, -0.003801, -0.000624),
                   (0.001088, 0.029215, 0.029772, -0.000572, 0.000118, 0.00046)),
    haa=(0.4435, 0.139, 0.0), hfe=(0.0, -0.117, 0.0), lengths=(0.36, 0.38),
    ranges=((-42.0, 23.0), (15.0, 125.0), (-158.71, -38.38)), efforts=(173.0, 208.0, 249.0),
    has_turned_hind_legs=False)
HYQ = Quadruped(
    'hyq_quadruped', 'hyq-description, urdfs/common.xacro and urdfs/leg/leg.urdf.xacro',
    trunk=RigidBody(58.96, (0.01, 0.0, 0.00358),
                    (1.5725937, 8.5015928, 9.1954911, 0.028375, -0.203139, -0.004462)),
    box=(0.9, 0.35, 0.25),
    hip=RigidBody(2.93, (0.04263, 0.0, 0.16931),
                  (0.05071, 0.05486, 0.00571, -0.00004, -0.00159, -0.00005)),
    thigh=RigidBody(2.638, (0.15074, -0.02625, 0.0),
                    (0.00368, 0.02719, 0.02811, -0.00302, 0.0001, 0.00002)),
    calf=RigidBody(0.881, (0.1254, 0.00004, -0.0001),
                   (0.00047, 0.01256, 0.01233, 0.00006, -0.00001, 0.0)),
    haa=(0.3735, 0.207, 0.0), hfe=(0.08, 0.0, 0.0), lengths=(0.35, 0.341),
    ranges=((-70.0, 25.0), (-50.0, 70.0), (-140.0, -20.0)), efforts=(150.0, 150.0, 150.0),
    has_turned_hind_legs=True)


def urdf_of(own: Quadruped) -> str:
    """Return the text of a machine."""
    lines = ['<?xml version="1.0"?>', f'<!-- Written by scripts/write_quadrupeds.py, from the '
             f'published {own.source}. -->', f'<robot name="{own.title}">',
             *_link('trunk', own.trunk, f'<box size="{_text(own.box)}"/>', (0.0,) * 3, (0.0,) * 3),
             *_joint('trunk_imu_mount', 'fixed', 'trunk', 'trunk_imu', (0.0,) * 3, (0.0,) * 3),
             '  <link name="trunk_imu"/>']
    for leg in ('lf', 'rf', 'lh', 'rh'):
        lines += _leg(own, leg)
    return '\n'.join([*lines, '</robot>', ''])


def _leg(own: Quadruped, leg: str) -> Iterator[str]:
    is_left, is_front = leg[0] == 'l', leg[1] == 'f'
    is_turned = own.has_turned_hind_legs and not is_front
    x, y, z = own.haa
    if own.has_turned_hind_legs:
        hip = own.hip.seen(SAME if is_left == is_front else TURNED)
        thigh, calf = (body.seen(SAME if is_front else TURNED) for body in (own.thigh, own.calf))
    else:
        hip, thigh, calf = (body.seen(SAME if is_left else MIRRORED)
                            for body in (own.hip, own.thigh, own.calf))
    haa_turn = (math.pi, HALF, 0.0) if is_left else (0.0, HALF, 0.0)
    hfe_turn = (HALF if is_left else -HALF, 0.0, 0.0)
    ranges = [own.ranges[0], *(
        (-high, -low) if is_turned else (low, high) for low, high in own.ranges[1:])]
    places = [(x if is_front else -x, y if is_left else -y, z), own.hfe,
              (own.lengths[0], 0.0, 0.0)]
    names = ['trunk', f'{leg}_hip', f'{leg}_thigh', f'{leg}_calf']
    across = math.hypot(*own.hfe)
    shapes = [
        (f'<cylinder radius="0.045" length="{across:g}"/>', [0.5 * one for one in own.hfe],
         (HALF, 0.0, 0.0) if own.hfe[1] else (0.0, HALF, 0.0)),
        *((f'<cylinder radius="{radius:g}" length="{length:g}"/>', (0.5 * length, 0.0, 0.0),
           (0.0, HALF, 0.0)) for radius, length in zip((0.04, 0.02), own.lengths))]
    for k, joint in enumerate(('haa', 'hfe', 'kfe')):
        turn = (haa_turn, hfe_turn, (0.0,) * 3)[k]
        yield from _joint(f'{leg}_{joint}', 'revolute', names[k], names[k + 1], places[k], turn,
                          [math.radians(end) for end in ranges[k]], own.efforts[k])
        yield from _link(names[k + 1], (hip, thigh, calf)[k], *shapes[k])
    yield from _joint(f'{leg}_foot_mount', 'fixed', names[3], f'{leg}_foot',
                      (own.lengths[1], 0.0, 0.0), (HALF, 0.0, -HALF))
    yield f'  <link name="{leg}_foot">'
    yield from _shapes('<sphere radius="0.02"/>', (0.0,) * 3, (0.0,) * 3)
    yield '  </link>'


def _link(name: str, body: RigidBody, shape: str, place: Numbers, turn: Numbers) -> Iterator[str]:
    xx, yy, zz, xy, xz, yz = (_text([one]) for one in body.inertia)
    yield f'  <link name="{name}">'
    yield '    <inertial>'
    yield f'      <origin xyz="{_text(body.com)}"/>'
    yield f'      <mass value="{body.mass:.9g}"/>'
    yield (f'      <inertia ixx="{xx}" ixy="{xy}" ixz="{xz}" iyy="{yy}" iyz="{yz}" '
           f'izz="{zz}"/>')
    yield '    </inertial>'
    yield from _shapes(shape, place, turn)
    yield '  </link>'


def _shapes(shape: str, place: Numbers, turn: Numbers) -> Iterator[str]:
    for what in ('visual', 'collision'):
        yield (f'    <{what}><origin xyz="{_text(place)}" rpy="{_text(turn)}"/>'
               f'<geometry>{shape}</geometry></{what}>')


def _joint(name: str, kind: str, parent: str, child: str, place: Numbers, turn: Numbers,
           ends: Numbers = (), effort: float = 0.0) -> Iterator[str]:
    yield f'  <joint name="{name}" type="{kind}">'
    yield f'    <parent link="{parent}"/><child link="{child}"/>'
    yield f'    <origin xyz="{_text(place)}" rpy="{_text(turn)}"/>'
    if ends:
        yield '    <axis xyz="0 0 1"/>'
        yield (f'    <limit lower="{ends[0]!r}" upper="{ends[1]!r}" effort="{effort:g}" '
               f'velocity="{SPEED:g}"/>')
    yield '  </joint>'


def _text(values: Numbers) -> str:
    """Return numbers with every digit, none of them a negative zero."""
    return ' '.join(f'{value + 0.0!r}' for value in values)


def texts() -> Iterator[tuple[Path, str]]:
    """Yield the files with their content."""
    for machine in (HYQ_REAL, HYQ):
        yield URDF / f'{machine.title}.urdf', urdf_of(machine)


if __name__ == '__main__':
    for path, text in texts():
        path.write_text(text, encoding='utf-8')
