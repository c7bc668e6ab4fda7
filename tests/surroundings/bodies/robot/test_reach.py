"""What actuators do to a tree: levers by differences, shared joints, dead centres."""

from dataclasses import replace
import math

from isa_ros.core.kernel import kernel
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY
from isa_ros.errors import ConfigError
from isa_ros.surroundings.bodies.robot import motion
from isa_ros.surroundings.bodies.robot.motion import scratch_size, state_names
from isa_ros.surroundings.bodies.robot.records import (
    contact_records, drive_records, link_records, RobotRecords, speed_records)
from isa_ros.surroundings.bodies.robot.robot import Robot
from isa_ros.surroundings.bodies.robot.sheet import (
    Points, RobotContact, RobotDrive, RobotJoint, RobotLink, RobotSheet, RobotStart)
from isa_ros.surroundings.ground import Ground
import numpy as np
import pytest
from tests.surroundings.bodies.robot.made import random_tree

MS = 1_000_000
STEP = 1e-5     # of the differences


@kernel
def seen(y, records):
    """Fill the scratch at a state."""
    motion.look(y, motion.tree_of(records, len(y)))


def looked(sheet: RobotSheet, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the `DRIVE` and `LEVER` rows at a state."""
    speeds = speed_records(sheet, RobotStart(joints=()))
    drives, levers = drive_records(sheet)
    seen(y, RobotRecords(
        link_records(sheet), speeds, drives, levers, contact_records(sheet),
        np.zeros(scratch_size(len(speeds), len(drives), len(y)))))
    return drives, levers


def tree_with_cylinders(is_free: bool) -> RobotSheet:
    """Return a tree whose cylinders reach from branch to branch and along one branch."""
    sheet = random_tree(np.random.default_rng(11), is_free, 9)
    apart = next((a, b) for a in range(1, 10) for b in range(a, 10)
                 if a not in sheet.path(b) and len(sheet.path(a)) + len(sheet.path(b)) > 3)
    deep = max(range(10), key=lambda link: len(sheet.path(link)))
    ends = [apart, apart[::-1], (0, deep), (deep, 0)]
    return replace(sheet, drives=tuple(RobotDrive(actuator=f'd{k}', linkage=Points(
        link_a=a, point_a=(0.3, -0.2, 0.1 * k), link_b=b, point_b=(-0.1, 0.4, 0.2),
        retracted_length=0.25)) for k, (a, b) in enumerate(ends)))


@pytest.mark.parametrize('is_free', (True, False))
def test_levers_and_curvature_are_those_of_the_length(is_free: bool) -> None:
    """
    By central differences: dx/dq of each joint between, x' along the motion, and J' q'.

    A root that turns and moves changes no length; joints that both links share do not either.
    """
    sheet = tree_with_cylinders(is_free)
    rng, n = np.random.default_rng(2), len(sheet.joints)
    y = rng.normal(size=len(state_names(sheet)))
    v = n
    if is_free:
        y[3:7] /= math.sqrt(np.square(y[3:7]).sum())
        v += 7
    drives, levers = looked(sheet, y)
    place, at = drives['position'].copy(), v - n
    assert np.all(place > -0.25) and {-1.0, 1.0} == set(levers['sense'])
    jacobian = np.zeros((len(drives), n))
    for j, drive in enumerate(drives):
        for e in range(drive['first'], drive['end']):
            jacobian[j, levers['speed'][e] - (6 if is_free else 0)] += levers['lever'][e]
    rates = y[v + (6 if is_free else 0):][:n].copy()
    speed, bend = drives['velocity'].copy(), drives['curvature'].copy()

    def moved(dq: np.ndarray) -> np.ndarray:
        other = y.copy()
        other[at:at + n] += dq
        return looked(sheet, other)[0]['position'].copy()
    for k in range(n):
        one = STEP * np.eye(n)[k]
        slope = (moved(one) - moved(-one)) / (2.0 * STEP)
        assert slope == pytest.approx(jacobian[:, k], abs=1e-8)
    ahead, behind = moved(STEP * rates), moved(-STEP * rates)
    assert speed == pytest.approx((ahead - behind) / (2.0 * STEP), abs=1e-7)
    assert speed == pytest.approx(jacobian @ rates, abs=1e-11)
    assert bend == pytest.approx((ahead - 2.0 * place + behind) / STEP ** 2, abs=1e-4)


def boom(n_cylinders: int, height: float = 0.4) -> RobotSheet:
    """Return a boom of 60 kg on a pin, level, on cylinders from below, all between two points."""
    across = ((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0))
    return RobotSheet(links=(
        RobotLink(name='base', parent=-1, joint=RobotJoint(name='world', kind='fixed'), mass=0.0),
        RobotLink(name='boom', parent=0, mass=60.0, com=(0.75, 0.0, 0.0), joint=RobotJoint(
            name='pin', kind='revolute', place=(0.0, 0.0, 1.0), rotation=across),
            inertia=(0.1, 11.0, 11.0, 0.0, 0.0, 0.0))),
        drives=tuple(RobotDrive(actuator=f'boom_{k}', linkage=Points(
            link_a=0, point_a=(0.2, 0.0, 1.0 - height), link_b=1, point_b=(0.5, 0.0, 0.0),
            retracted_length=0.3)) for k in range(n_cylinders)))


def test_cylinders_on_one_joint_share_its_load() -> None:
    """Gravity: m g x_c = F times the distance of the pin from the cylinder's line, 0.4 m."""
    whole = 60.0 * 9.80665 * 0.75 / 0.4
    alone = Robot(boom(1), RobotStart(joints=(0.0,)), MS)
    both = Robot(boom(2), RobotStart(joints=(0.0,)), MS)
    assert alone.actuator_forces == pytest.approx([whole], rel=1e-12, abs=0.0)
    assert both.actuator_forces == pytest.approx([0.5 * whole] * 2, rel=1e-9, abs=0.0)
    assert alone.sample['pin_torque'][0] == pytest.approx(
        60.0 * 9.80665 * 0.75, rel=1e-12, abs=0.0)
    assert alone.sample['boom_0_lever'][0] == pytest.approx(0.4, rel=1e-12, abs=0.0)


def test_a_cylinder_at_its_dead_centre_is_refused_at_the_start() -> None:
    with pytest.raises(ConfigError, match=r'boom_0: moves nothing at the start, 1/m = .* must be'):
        Robot(boom(1, height=0.0), RobotStart(joints=(0.0,)), MS)


def test_a_cylinder_that_passes_its_dead_centre_has_a_port_of_numbers() -> None:
    """The boom swings through the line of its cylinder: 1/m falls to 0, the port stays finite."""
    robot = Robot(boom(1), RobotStart(joints=(0.0,)), MS)
    ports, replies = np.zeros(1, LOAD_PORT), np.zeros(1, LOAD_REPLY)
    inverse_masses = []
    for _ in range(900):
        robot.ports(ports)
        assert all(np.isfinite(ports[name][0]) for name in LOAD_PORT.names)
        inverse_masses.append(float(ports['inverse_mass'][0]))
        robot.advance(replies)
    assert min(inverse_masses) < 1e-5 < 1e-3 < max(inverse_masses)


def test_the_response_of_hard_ground_is_cut_to_what_a_tick_resolves() -> None:
    """The boom's tip 0.1 m deep in steel: k and d are at their bounds."""
    hard = Ground(stiffness=1e9, damping=1.0, friction=0.7, tangential_stiffness=1e5,
                  tangential_damping=15.0)
    sheet = replace(boom(1), contacts=(
        RobotContact(name='tip', link=1, point=(1.5, -1.1, 0.0), ground=hard),))
    robot, ports = Robot(sheet, RobotStart(joints=(0.0,)), MS), np.zeros(1, LOAD_PORT)
    assert robot.sample['tip_position'][0] == pytest.approx([1.5, 0.0, -0.1], abs=1e-12)
    robot.ports(ports)
    assert ports['stiffness'][0] == pytest.approx(math.pi ** 2 * 1e6, rel=1e-12, abs=0.0)
    assert ports['damping'][0] == 1e3


def test_a_pressed_contact_answers_no_cylinder_at_its_dead_centre() -> None:
    """There 1/m is 0 to its rounding: so are the stiffness and damping that it would move."""
    q = math.atan2(-0.4, 0.2)       # both pins and the joint in one line
    tip = (0.5 * math.cos(q) - 1.1 * math.sin(q), -0.5 * math.sin(q) - 1.1 * math.cos(q), 0.0)
    ground = Ground(stiffness=1e7, damping=1.0, friction=0.7, tangential_stiffness=1e5,
                    tangential_damping=15.0)
    robot = Robot(replace(boom(1), contacts=(
        RobotContact(name='tip', link=1, point=tip, ground=ground),)),
        RobotStart(joints=(0.0,)), MS)
    ports = np.zeros(1, LOAD_PORT)
    for angle, moves in ((q + 0.05, True), (q, False)):
        robot._state[0] = angle
        robot.ports(ports)
        assert robot._arrays.contacts['force'][0, 2] > 1e3      # the tip presses
        assert (ports['inverse_mass'][0] > 1e-12) == moves
        assert (ports['stiffness'][0] != 0.0) == moves == (ports['damping'][0] != 0.0)
