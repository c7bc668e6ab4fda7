"""The dynamics of a tree against Pinocchio, on random states of random trees."""

from isa_ros.core.kernel import kernel
from isa_ros.core.saved_state import TIME_BYTES
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY
from isa_ros.surroundings.bodies.robot import motion
from isa_ros.surroundings.bodies.robot.motion import scratch_size, state_names
from isa_ros.surroundings.bodies.robot.records import (
    contact_records, drive_records, link_records, RobotRecords, speed_records)
from isa_ros.surroundings.bodies.robot.robot import Robot
from isa_ros.surroundings.bodies.robot.sheet import RobotSheet, RobotStart
from isa_ros.surroundings.bodies.robot.tree import solve
import numpy as np
import pytest
from tests.surroundings.bodies.robot.made import random_tree

pin = pytest.importorskip('pinocchio')
EXACT = 1e-12   # of the largest acceleration: about a hundred roundings of sums that cancel


@kernel
def accelerations(y, force, is_held, records, out):
    """Fill q'' of a state under generalised forces, and solve M x = force."""
    tree = motion.tree_of(records, len(y))
    motion.move(y, tree.forces, is_held, tree)
    for k in range(len(force)):
        out[1, k] = force[k]
    motion.let_go(tree.speeds, is_held, out[1])
    solve(tree.speeds, tree.mass, out[1])
    for k in range(len(force)):
        out[0, k] = tree.acceleration[k] + out[1, k]


def evaluated(sheet: RobotSheet, start: RobotStart, y: np.ndarray, force: np.ndarray,
              is_held: bool = False) -> np.ndarray:
    """Return (q'', M^-1 force), (2, d)."""
    speeds, drives = speed_records(sheet, start), drive_records(sheet)
    out = np.zeros((2, len(speeds)))
    accelerations(y, force, is_held, RobotRecords(
        link_records(sheet), speeds, *drives, contact_records(sheet),
        np.zeros(scratch_size(len(speeds), len(drives[0]), len(y)))), out)
    return out


def pinocchio(sheet: RobotSheet) -> 'pin.Model':
    """Return the tree as Pinocchio has it, its joints in the same order."""
    model, places = pin.Model(), {}
    for k, link in enumerate(sheet.links):
        xx, yy, zz, xy, xz, yz = link.inertia
        inertia = pin.Inertia(link.mass, np.array(link.com), np.array(
            [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
        frame = pin.SE3(np.array(link.joint.rotation), np.array(link.joint.place))
        if link.joint.kind == 'fixed':
            places[k] = 0, frame
            continue
        joint, above = (0, pin.SE3.Identity()) if k == 0 else places[link.parent]
        own = model.addJoint(joint, {
            'free': pin.JointModelFreeFlyer, 'revolute': pin.JointModelRZ,
            'prismatic': pin.JointModelPZ}[link.joint.kind](),
            pin.SE3.Identity() if k == 0 else above * frame, link.joint.name)
        model.appendBodyToJoint(own, inertia, pin.SE3.Identity())
        places[k] = own, pin.SE3.Identity()
    model.gravity.linear = np.array([0.0, 0.0, -9.80665])
    return model


def expected(model: 'pin.Model', y: np.ndarray, force: np.ndarray, is_free: bool) -> np.ndarray:
    """Return q'' of Pinocchio's articulated-body algorithm, that of O in world axes."""
    n = model.nv
    if not is_free:
        return np.array(pin.aba(model, model.createData(), y[:n], y[n:2 * n], force))
    q, v = y[:n + 1].copy(), y[n + 1:2 * n + 1].copy()
    q[3:7] = y[[4, 5, 6, 3]]
    r = pin.Quaternion(q[6], *q[3:6]).matrix()
    back = np.kron(np.eye(2), r.T)
    turning = v[3:6].copy()
    own = force.copy()
    v[:6], own[:6] = back @ v[:6], back @ own[:6]
    a = np.array(pin.aba(model, model.createData(), q, v, own))
    a[:6] = back.T @ a[:6]
    a[:3] += np.cross(turning, y[n + 1:n + 4])
    return a


@pytest.mark.parametrize('is_free', (True, False))
def test_accelerations_are_those_of_pinocchio(is_free: bool) -> None:
    """Sixty trees of 1 to 14 joints, turning and sliding, branched at random; three states."""
    rng = np.random.default_rng(19)
    for _ in range(60):
        sheet = random_tree(rng, is_free, int(rng.integers(1, 15)))
        model, n = pinocchio(sheet), len(sheet.joints)
        for _ in range(3):
            y = rng.normal(size=len(state_names(sheet)))
            if is_free:
                y[3:7] /= np.sqrt(np.square(y[3:7]).sum())
            force = rng.normal(size=n + 6 * is_free) * 50.0
            got = evaluated(sheet, RobotStart(joints=(0.0,) * n), y, force)[0]
            wanted = expected(model, y, force, is_free)
            assert np.abs(got - wanted).max() <= EXACT * np.abs(wanted).max()


def test_what_is_held_stays_and_carries_nothing_over() -> None:
    """A held root: the tree on a fixed root at the same place; the root does not accelerate."""
    rng = np.random.default_rng(3)
    sheet = random_tree(rng, True, 7)
    y = rng.normal(size=len(state_names(sheet)))
    y[3:7] = 1.0, 0.0, 0.0, 0.0
    y[14:20] = 0.0
    force = np.r_[np.zeros(6), rng.normal(size=7)]
    got = evaluated(sheet, RobotStart(joints=(0.0,) * 7), y, force, is_held=True)[0]
    model = pinocchio(sheet)
    data = model.createData()
    q = np.r_[y[:3], 0.0, 0.0, 0.0, 1.0, y[7:14]]
    m = pin.crba(model, data, q)
    m = np.triu(m) + np.triu(m, 1).T
    bias = pin.nonLinearEffects(model, data, q, np.r_[np.zeros(6), y[20:27]])
    wanted = np.linalg.solve(m[6:, 6:], force[6:] - bias[6:])
    assert np.all(got[:6] == 0.0)
    np.testing.assert_allclose(got[6:], wanted, rtol=0.0, atol=1e-11 * np.abs(wanted).max())


def test_a_robot_in_the_air_keeps_its_energy_and_its_momentum() -> None:
    """0.3 s of tumbling without actuators: only Runge and Kutta's fourth order is lost."""
    rng = np.random.default_rng(5)
    sheet = random_tree(rng, True, 5)
    robot = Robot(sheet, RobotStart(joints=(0.0,) * 5, position=(0.0, 0.0, 50.0)), 1_000_000)
    robot.release()
    at = TIME_BYTES + 8 * 12    # behind place, quaternion and joints: the speeds
    snapshot = bytearray(robot.snapshot())
    snapshot[at:at + 8 * 11] = rng.normal(size=11).tobytes()
    robot.restore(bytes(snapshot))
    energies = []
    for _ in range(300):
        robot.ports(np.zeros(0, LOAD_PORT))
        robot.advance(np.zeros(0, LOAD_REPLY))
        own = robot.sample[0]
        energies.append((own['kinetic_energy'], own['potential_energy']))
    total = np.array(energies).sum(axis=1)
    assert np.ptp(np.array(energies)[:, 0]) > 100.0
    assert np.ptp(total) < 1e-9 * np.abs(total).max()
