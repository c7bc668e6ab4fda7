"""A crane of cylinders between points (L23) against the model of docs/bodies.md in MuJoCo."""

from pathlib import Path
import re

import isa_ros
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY, START
from isa_ros.core.timebase import FORCE_WINDOWS
from isa_ros.surroundings.bodies.robot.robot import Robot
from isa_ros.surroundings.bodies.robot.sheet import (
    matrix, Points, RobotDrive, RobotJoint, RobotLink, RobotSheet, RobotStart, vector)
import numpy as np
import pytest

mujoco = pytest.importorskip('mujoco', reason='no wheel for this Python')
from isa_ros.mujoco import MujocoBody  # noqa: E402, I100

PAGE = (Path(__file__).parents[4] / 'docs' / 'bodies.md').read_text(encoding='utf-8')
MODEL = re.search(r'```xml\n(.*?)```', PAGE, re.DOTALL)[1]
POSE = 0.5, -1.0
TURN = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])   # z on MuJoCo's axis -y
STEP, STEP_NS = 1e-3, 1_000_000
TICKS = 300
NAMES = ('boom', 'jib')


def rotated(quaternion: np.ndarray) -> np.ndarray:
    r = np.zeros(9)
    mujoco.mju_quat2Mat(r, quaternion)
    return r.reshape(3, 3)


def crane(model: 'mujoco.MjModel', lengths: np.ndarray) -> RobotSheet:
    """Return the tree of a model whose joints turn about -y; ``lengths`` is that of x = 0."""
    links = [RobotLink(name='world', parent=-1, mass=0.0,
                       joint=RobotJoint(name='base', kind='fixed'))]
    for k in range(1, model.nbody):
        outer = TURN if model.body_parentid[k] else np.eye(3)
        own = rotated(model.body_iquat[k])
        i = TURN.T @ own @ np.diag(model.body_inertia[k]) @ own.T @ TURN
        links.append(RobotLink(
            name=f'link_{k}', parent=int(model.body_parentid[k]), mass=float(model.body_mass[k]),
            joint=RobotJoint(
                name=f'joint_{k}', kind='revolute',
                place=vector(outer.T @ model.body_pos[k]),
                rotation=matrix(outer.T @ rotated(model.body_quat[k]) @ TURN)),
            com=vector(TURN.T @ model.body_ipos[k]),
            inertia=(i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2])))

    def at(name: str) -> tuple[int, tuple[float, float, float]]:
        site = model.site(name).id
        body = int(model.site_bodyid[site])
        return body, vector((TURN if body else np.eye(3)).T @ model.site_pos[site])
    drives = []
    for name, length in zip(NAMES, lengths):
        (a, point_a), (b, point_b) = at(f'{name}_base'), at(f'{name}_rod')
        drives.append(RobotDrive(actuator=name, linkage=Points(
            link_a=a, point_a=point_a, link_b=b, point_b=point_b,
            retracted_length=float(length))))
    return RobotSheet(links=tuple(links), drives=tuple(drives))


@pytest.fixture(scope='module')
def both() -> tuple[isa_ros.MechanismBody, Robot]:
    """Return the crane in MuJoCo, RK4 at a fifth of the tick, and ours."""
    model = mujoco.MjModel.from_xml_string(MODEL)
    model.opt.gravity[:] = 0.0, 0.0, -9.80665
    data = mujoco.MjData(model)
    data.qpos[:] = POSE
    mujoco.mj_forward(model, data)
    at = isa_ros.Mounting(list(NAMES), np.arange(2), np.full(2, 0.05), [False] * 2, STEP, 0)
    ours = Robot(crane(model, data.ten_length - 0.05), RobotStart(joints=POSE), STEP_NS)
    return isa_ros.MechanismBody(MujocoBody(model, data, at), at), ours


def test_both_start_alike(both: tuple) -> None:
    """Places, and the forces that hold boom, jib and load."""
    rows = [np.zeros(2, START) for _ in both]
    for body, own in zip(both, rows):
        body.starts(own)
    assert rows[1]['position'] == pytest.approx(rows[0]['position'], rel=1e-12, abs=0.0)
    assert rows[1]['force'] == pytest.approx(rows[0]['force'], rel=1e-9, abs=0.0)


def test_both_swing_alike_under_the_same_forces(both: tuple) -> None:
    """
    0.3 s of Runge and Kutta at 0.2 ms: coordinates, speeds and ports, look-ahead included.

    Rounding differs, and a0: J' q' of the simulator is a difference over 1 us. a_bias and jerk
    divide what is left by H and H^2. The forces are continuous and grow evenly within a tick:
    there L16 of the one and L32 of the other, whose actuators have no moving mass, are one line.
    """
    replies = np.zeros(2, LOAD_REPLY)
    ports = np.zeros((2, TICKS, 2), LOAD_PORT)
    hold = both[1].actuator_forces
    for tick in range(TICKS):
        for body, own in zip(both, ports):
            body.ports(own[tick])
        begin, end = (hold * (1.0 + 0.5 * np.sin(np.array([8.0, -11.0]) * t))
                      for t in (tick * STEP, (tick + 1) * STEP))
        middles = (np.arange(FORCE_WINDOWS) + 0.5) / FORCE_WINDOWS
        replies['mean_forces'] = begin[:, np.newaxis] + np.outer(end - begin, middles)
        replies['force'] = end
        for body in both:
            body.advance(replies)
    assert np.ptp(ports['x0'][0], axis=0).min() > 0.01
    for name, most in (('x0', 1e-11), ('v0', 1e-10), ('a0', 1e-7), ('inverse_mass', 1e-9),
                       ('a_bias', 1e-7), ('jerk', 1e-5)):
        theirs, ours = ports[name]
        assert np.abs(ours - theirs).max() <= most * np.abs(theirs).max(), name
