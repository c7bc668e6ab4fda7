"""The tree against the leg in closed form: two derivations of the same equations."""

from functools import cache
import math

from isa_ros.core.noise import noise_key
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY, START
from isa_ros.core.timebase import FORCE_WINDOWS
from isa_ros.surroundings.bodies.leg.inertial import Imu
from isa_ros.surroundings.bodies.leg.leg import InertialUnit, Leg, LegPose
from isa_ros.surroundings.bodies.robot.robot import Robot
from isa_ros.surroundings.bodies.robot.sheet import RobotStart, RobotUnit, UPRIGHT
import numpy as np
from tests.legs import leg_sheet
from tests.surroundings.bodies.robot.made import leg_as_tree

TICK_NS = 500_000   # its windows are 0.1 ms, the longest step of the leg: both integrate alike
TICKS = 300         # a fall of 2 cm, the impact, and standing on the springs
RELEASE = 20
SHEET = leg_sheet()
POSE = LegPose(haa=math.radians(13.0), hfe=math.radians(48.0), kfe=math.radians(-95.0),
               foot_height=0.02)
PORT = ('x0', 'v0', 'a0', 'inverse_mass', 'a_bias', 'jerk', 'stiffness', 'damping')


@cache
def drop() -> tuple[Leg, Robot, np.ndarray, np.ndarray, list[np.void], list[np.void]]:
    """
    Return both after the drop, their ports (ticks, 3), and their samples.

    The forces are continuous and grow evenly within a tick: there L16 of the leg and L32 of the
    tree, whose actuators have no moving mass, are the same line.
    """
    key = noise_key(0, 'calf/imu')
    imu = Imu(link='calf', rate_hz=1000.0, x_mm=100.0, y_mm=-20.0, z_mm=30.0, gyro_bias=0.1,
              gyro_sigma=0.01, accelerometer_bias=-0.2, accelerometer_sigma=0.3)
    leg = Leg(SHEET, POSE, TICK_NS, release_ns=RELEASE * TICK_NS,
              units=[InertialUnit('calf', imu, 2 * TICK_NS, key)])
    robot = Robot(leg_as_tree(SHEET), RobotStart(
        joints=(float(leg.sample[0]['height']), *POSE.joints), held_joints=('slider',)),
        TICK_NS, release_ns=RELEASE * TICK_NS, units=[RobotUnit(
            'calf', 4, (0.1, -0.02, 0.03), UPRIGHT, 0.3, -0.2, 0.01, 0.1, 2 * TICK_NS, key)])
    start, hold = np.array(leg.actuator_positions), np.array(leg.actuator_forces)
    ports, samples = np.zeros((2, TICKS, 3), LOAD_PORT), ([], [])
    replies, middles = np.zeros(3, LOAD_REPLY), (np.arange(FORCE_WINDOWS) + 0.5) / FORCE_WINDOWS
    replies['force'] = hold
    for tick in range(TICKS):
        leg.ports(ports[0, tick])
        robot.ports(ports[1, tick])
        own = ports[0, tick]
        force = (hold + (300.0, 1e5, 1e5) * (start - own['x0'])
                 - np.array((20.0, 4e3, 4e3)) * own['v0'])
        before = replies['force'].copy()
        replies['mean_forces'] = before[:, None] + np.outer(force - before, middles)
        replies['force'] = force
        for body, kept in zip((leg, robot), samples):
            body.advance(replies)
            kept.append(body.sample[0].copy())
    return leg, robot, *ports, *samples


def test_they_start_alike() -> None:
    """Coordinates and holding forces, of h = r F in the leg and of x'' = 0 in the tree."""
    leg, robot = (np.zeros(3, START) for _ in range(2))
    Leg(SHEET, POSE, TICK_NS).starts(leg)
    Robot(leg_as_tree(SHEET), RobotStart(joints=(1.0, *POSE.joints), held_joints=('slider',)),
          TICK_NS).starts(robot)
    np.testing.assert_allclose(robot['position'], leg['position'], rtol=1e-14)
    np.testing.assert_allclose(robot['force'], leg['force'], rtol=1e-11)


def test_they_fall_and_land_alike() -> None:
    """Rounding errors of 1e-16 grow on the stiff ground, by less than 1e6."""
    _, _, _, _, of_leg, of_tree = drop()
    assert max(own['foot_force'][2] for own in of_leg) > 150.0
    for field, of_robot in (('position', 'position'), ('velocity', 'velocity'),
                            ('torque', 'torque')):
        leg = np.array([own[field] for own in of_leg])
        tree = np.array([[own[f'{joint}_{of_robot}'] for joint in ('haa', 'hfe', 'kfe')]
                         for own in of_tree])
        np.testing.assert_allclose(tree, leg, rtol=0.0, atol=1e-10 * np.abs(leg).max())
    for leg_field, field in (('foot_force', 'foot_force'), ('foot_position', 'foot_position'),
                             ('height', 'slider_position'),
                             ('height_velocity', 'slider_velocity'),
                             ('calf_specific_force',) * 2, ('calf_angular_velocity',) * 2):
        leg = np.array([own[leg_field] for own in of_leg])
        tree = np.array([own[field] for own in of_tree])
        np.testing.assert_allclose(tree, leg, rtol=0.0, atol=1e-10 * np.abs(leg).max())


def test_their_ports_are_alike() -> None:
    """
    Motion, inertia and look-ahead to rounding; k and d but for what is not of the ground.

    The leg's are differences of all its accelerations, so that those of gravity and of the speeds
    are in them: up to 1 % of the largest k, and a sixth of the small d at HAA. a_bias and jerk
    make up for it, so that both ports end the tick at the same place.
    """
    _, _, leg, tree, _, _ = drop()
    for name in PORT[:4]:
        own = np.abs(leg[name]).max(axis=0)
        assert np.all(np.abs(tree[name] - leg[name]).max(axis=0) <= 1e-9 * own), name
    for name, most in (('a_bias', 1e-4), ('jerk', 1e-3), ('stiffness', 0.01), ('damping', 0.2)):
        own = np.abs(leg[name]).max(axis=0)
        assert np.all(np.abs(tree[name] - leg[name]).max(axis=0) <= most * own), name
