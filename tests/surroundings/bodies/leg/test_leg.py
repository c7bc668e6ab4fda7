"""The leg as a load: statics, momentum, energy, ports, determinism, errors."""

import math
import os
from pathlib import Path
import subprocess
import sys

from isa_ros.core.record import rows_of
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY
from isa_ros.errors import ConfigError, SimulationDiverged
from isa_ros.surroundings.bodies.leg import motion as kernels
from isa_ros.surroundings.bodies.leg.leg import Leg, Pose
from isa_ros.surroundings.bodies.leg.sheet import JOINTS, leg_record, STANDARD_GRAVITY
from isa_ros.surroundings.linkage import actuator_coordinate
import numpy as np
import pytest
from tests.legs import leg_sheet

MS = 1_000_000
SHEET = leg_sheet()
POSE = Pose(haa=math.radians(13.0), hfe=math.radians(48.0), kfe=math.radians(-95.0),
            foot_height=0.1)
CONSTANTS = leg_record(SHEET)[0]
BODY = CONSTANTS.body


def hanging(step_ns=MS, pose=POSE):
    """Return the shipped leg."""
    return Leg(SHEET, pose, step_ns)


def constant(forces):
    """Return replies of actuators that push with constant forces."""
    replies = rows_of(3, LOAD_REPLY)
    replies['mean_forces'] = np.array(forces)[:, None]
    replies['force'] = forces
    return replies


def state(leg):
    """Return the leg's `LEG_STATE`."""
    return np.frombuffer(leg.snapshot(), kernels.LEG_STATE, 1, 8)[0]


def continuous(leg):
    """Return the leg's `ContinuousState`."""
    return kernels.continuous(state(leg))


def mass_matrix(y):
    """Return M at a state, shape (4, 4)."""
    terms = kernels.terms_of(y, CONSTANTS)
    names = ('z', 'haa', 'hfe', 'kfe')
    m = np.zeros((4, 4))
    for i, row in enumerate(names):
        for j, column in enumerate(names[i:], i):
            m[i, j] = m[j, i] = getattr(terms, f'm_{row}_{column}')
    return m


def speeds(y):
    """Return the speeds of a state's coordinates, (4,)."""
    return np.array((y.v_z, y.v_haa, y.v_hfe, y.v_kfe))


def energy(y):
    """Return kinetic plus potential energy, J."""
    v = speeds(y)
    return 0.5 * v @ mass_matrix(y) @ v + potential(y)


def potential(y):
    """Return m g times the height of the whole leg's centre of mass, J, from the frames."""
    b = BODY
    s1, c1 = math.sin(y.q_haa), math.cos(y.q_haa)
    s2, c2 = math.sin(y.q_hfe), math.cos(y.q_hfe)
    s3, c3 = math.sin(y.q_hfe + y.q_kfe), math.cos(y.q_hfe + y.q_kfe)

    def in_leg_plane(down, left):
        return -c1 * down - s1 * left

    hip = -b['c_hip_x'] * c1 + b['c_hip_y'] * s1
    thigh = in_leg_plane(b['c_thigh_x'] * c2 - b['c_thigh_y'] * s2,
                         b['l_hip'] + b['c_thigh_z'])
    calf = in_leg_plane(
        b['l_thigh'] * c2 + b['c_calf_x'] * c3 - b['c_calf_y'] * s3,
        b['l_hip'] + b['c_calf_z'])
    mass = b['m_slider'] + b['m_hip'] + b['m_thigh'] + b['m_calf']
    return STANDARD_GRAVITY * (
        mass * y.z + b['m_hip'] * hip + b['m_thigh'] * thigh + b['m_calf'] * calf)


def test_held_leg_hangs_still_under_its_static_forces():
    """L6 at rest: 0.1 s under `actuator_forces` moves the leg by roundings only (1e-13 rad)."""
    leg = hanging()
    replies = constant(leg.actuator_forces)
    before = continuous(leg)
    for _ in range(100):
        leg.advance(replies)
    assert np.abs(np.subtract(continuous(leg), before)).max() < 1e-11
    assert leg.sample[0]['foot_position'][2] == pytest.approx(0.1, abs=1e-12)


def test_released_leg_falls_freely_whatever_the_actuators_do():
    """
    Vertical momentum falls by m g t: actuator forces are internal.

    RK4 at 0.1 ms: its error, by the test of its order (below), is 1e-9 of the speeds.
    """
    leg = hanging()
    leg.release()
    total = BODY['m_slider'] + BODY['m_hip'] + BODY['m_thigh'] + BODY['m_calf']
    for _ in range(60):
        leg.advance(constant((3.0, 150.0, 80.0)))
    y = continuous(leg)
    momentum = (mass_matrix(y) @ speeds(y))[0]
    assert momentum == pytest.approx(-total * STANDARD_GRAVITY * 0.06, rel=1e-9)


def test_work_of_the_actuators_is_the_change_of_energy():
    """L2, L6-L8: F dx of three constant forces equals the change of T + V, off the ground."""
    leg = hanging()
    leg.release()
    forces = np.array((3.0, 150.0, 80.0))
    x, e = np.array(leg.actuator_positions), energy(continuous(leg))
    for _ in range(60):
        leg.advance(constant(forces))
    work = forces @ (np.array(leg.actuator_positions) - x)
    change = energy(continuous(leg)) - e
    # Kinetic and potential parts are of the order of 10 J, the error of RK4 1e-9 of them.
    assert change == pytest.approx(work, abs=1e-8)
    assert abs(work) > 0.1


def test_runge_kutta_is_of_fourth_order():
    """Halving the step divides the error by 16 (asymptotically), in the air."""
    leg = hanging()
    y0 = continuous(leg)._replace(v_haa=1.0, v_hfe=3.0, v_kfe=-6.0)

    def end(n):
        y = y0
        for _ in range(n):
            y = kernels.leg_step(y, 0.2 / n, (5.0, 150.0, 50.0), False, CONSTANTS)
        return np.array(y)

    exact = end(3200)
    errors = [np.abs(end(n) - exact).max() for n in (25, 50, 100)]
    for coarse, fine in zip(errors, errors[1:]):
        assert 13.0 < coarse / fine < 20.0


def test_standing_leg_rests_with_its_weight_on_the_ground():
    """N = m g at rest, friction within its cone, after 3 s of springs and dampers."""
    leg = hanging(pose=Pose(haa=POSE.haa, hfe=POSE.hfe, kfe=POSE.kfe, foot_height=0.01))
    leg.release()
    start = np.array(leg.actuator_positions)
    ports = np.zeros(3, LOAD_PORT)
    k, d = np.array((2e3, 3e5, 3e5)), np.array((60.0, 6e3, 6e3))
    for _ in range(3000):
        leg.ports(ports)
        leg.advance(constant(k * (start - ports['x0']) - d * ports['v0']))
    f_x, f_y, normal = leg.sample[0]['foot_force']
    total = BODY['m_slider'] + BODY['m_hip'] + BODY['m_thigh'] + BODY['m_calf']
    assert np.abs(leg.sample[0]['velocity']).max() < 1e-3
    # m z'' is left of the balance: accelerations are below the speeds times 100 1/s.
    assert normal == pytest.approx(total * STANDARD_GRAVITY, rel=0.01)
    assert math.hypot(f_x, f_y) < 0.7 * normal


def test_the_moment_of_the_ground_is_that_of_its_force_at_the_foot():
    """It acts beside the origin, so that the wrench in the world has p x F; in flight none."""
    leg = hanging()
    assert np.copysign(1.0, leg.sample[0]['foot_moment']).tolist() == [1.0, 1.0, 1.0]
    assert not leg.sample[0]['foot_moment'].any()
    sample = moving_leg().sample[0]
    force, place = sample['foot_force'], sample['foot_position']
    moment = np.cross(place, force)
    assert force[2] > 100.0 and np.abs(moment).min() > 0.01
    assert sample['foot_moment'] == pytest.approx(moment, abs=4e-16 * np.abs(force).max())


def moving_leg(step_ns=MS, release=True, ticks=160):
    """Return a leg that has hit the ground and moves on it."""
    leg = hanging(step_ns)
    if release:
        leg.release()
    start = np.array(leg.actuator_positions)
    hold = np.array(leg.actuator_forces)
    ports = np.zeros(3, LOAD_PORT)
    for _ in range(ticks):
        leg.ports(ports)
        leg.advance(constant(
            hold + (300.0, 1e5, 1e5) * (start - ports['x0']) - (20.0, 4e3, 4e3) * ports['v0']))
    return leg


@pytest.mark.parametrize('release', [True, False])
def test_effective_mass_is_that_of_the_mass_matrix(release):
    """L13: 1/m_eff = r^2 (M^-1)_jj; a held slider takes its row and column out of M."""
    leg = moving_leg(release=release)
    ports = np.zeros(3, LOAD_PORT)
    leg.ports(ports)
    y = continuous(leg)
    m = mass_matrix(y)
    if release:
        inverse = np.linalg.inv(m)[1:, 1:]
    else:
        inverse = np.linalg.inv(m[1:, 1:])
    for j, (name, angle) in enumerate(zip(JOINTS, kernels.joint_angles(y))):
        _, r, _ = actuator_coordinate(angle, CONSTANTS[name])
        # Condition of M below 1e4: 1e-16 * 1e4.
        assert ports['inverse_mass'][j] == pytest.approx(
            r * r * inverse[j, j], rel=1e-12, abs=0.0)


def test_ground_stiffness_is_seen_through_the_port():
    """
    L14, L15: under a constant extra force the leg moves according to k and d of the port.

    The response of x_j to one more newton, minus that without it, is integrated from the leg
    and from its linear copy over 0.5 ms; the difference is the curvature of the contact law.
    """
    leg = moving_leg()
    ports = np.zeros(3, LOAD_PORT)
    leg.ports(ports)
    y0, f = continuous(leg), state(leg)['force']
    n, t = 500, 5e-4
    for j in (1, 2):
        ends = []
        for extra in (0.0, 1.0):
            y = y0
            force = tuple(f[i] + (extra if i == j else 0.0) for i in range(3))
            for _ in range(n):
                y = kernels.leg_step(y, t / n, force, leg.is_held, CONSTANTS)
            ends.append(kernels.leg_motion(y, force, leg.is_held, CONSTANTS).position[j])
        p = ports[j]
        x = v = 0.0
        for _ in range(n):
            a = p['inverse_mass'] - p['stiffness'] * x - p['damping'] * v
            x += t / n * (v + 0.5 * t / n * a)
            v += t / n * a
        free = 0.5 * p['inverse_mass'] * t * t
        moved = ends[1] - ends[0]
        assert p['stiffness'] > 0.0
        assert abs(moved - x) < 0.2 * abs(moved - free)


def test_step_size_does_not_change_the_leg_under_constant_forces():
    """All macro steps are made of the same 0.1 ms: the same bytes at 0.5, 1 and 2 ms."""
    ends = []
    for step_ns in (MS // 2, MS, 2 * MS):
        leg = hanging(step_ns)
        leg.release()
        for _ in range(150 * MS // step_ns):
            leg.advance(constant((3.0, 300.0, 200.0)))
        ends.append(np.array(continuous(leg)).tobytes())
    assert ends[0] == ends[1] == ends[2]


def test_restored_leg_continues_byte_for_byte():
    """`state` holds everything that the next tick depends on."""
    leg, twin = moving_leg(), hanging()
    twin.restore(leg.snapshot())
    ports, twin_ports = np.zeros(3, LOAD_PORT), np.zeros(3, LOAD_PORT)
    for _ in range(20):
        leg.ports(ports)
        twin.ports(twin_ports)
        assert ports.tobytes() == twin_ports.tobytes()
        leg.advance(constant((1.0, 200.0, 100.0)))
        twin.advance(constant((1.0, 200.0, 100.0)))
    assert leg.snapshot() == twin.snapshot()
    assert leg.t_ns == twin.t_ns == 180 * MS


def test_rows_say_which_actuator_drives_which_joint():
    """A leg may use any rows of the run's arrays, and leaves the others and pressures alone."""
    ports, wide = np.zeros(3, LOAD_PORT), np.zeros(5, LOAD_PORT)
    wide['supply_pressure'] = 20.7e6
    leg = hanging()
    leg.ports(ports)
    scattered = Leg(SHEET, POSE, MS, rows=(4, 0, 2))
    scattered.ports(wide)
    assert (wide['x0'][[4, 0, 2]] == ports['x0']).all()
    assert (wide['x0'][[1, 3]] == 0.0).all()
    assert (wide['supply_pressure'] == 20.7e6).all()
    replies = np.zeros(5, LOAD_REPLY)
    replies[[4, 0, 2]] = constant((1.0, 200.0, 100.0))
    scattered.advance(replies)
    leg.advance(constant((1.0, 200.0, 100.0)))
    assert scattered.snapshot() == leg.snapshot()


def test_hold_takes_the_speed_of_the_slider():
    """A locked slider stops and does not move."""
    leg = moving_leg(ticks=60)
    leg.hold()
    height = continuous(leg).z
    leg.advance(constant((0.0, 0.0, 0.0)))
    assert leg.is_held
    assert continuous(leg).z == height
    assert leg.sample[0]['height_velocity'] == 0.0


def test_divergence_names_state_and_time():
    """A force that is not a number ends the run."""
    leg = hanging()
    leg.advance(constant((0.0, 0.0, 0.0)))
    with pytest.raises(SimulationDiverged, match=r'leg\.z = nan at t = 0\.002000 s'):
        leg.advance(constant((math.nan, 0.0, 0.0)))


@pytest.mark.parametrize(('pose', 'message'), [
    (Pose(haa=0.0, hfe=0.0, kfe=-1.5, foot_height=0.1), r'pose\.hfe = 0 deg, must be within 15'),
    (Pose(haa=1.0, hfe=0.8, kfe=-1.5, foot_height=0.1), r'pose\.haa = 57\.2958 deg, must be'),
    (Pose(haa=0.0, hfe=0.8, kfe=-1.5, foot_height=-0.01), r'foot_height = -0\.01 m, must be >= 0'),
    (Pose(haa=math.nan, hfe=0.8, kfe=-1.5, foot_height=0.1), r'pose\.haa = nan deg')])
def test_a_pose_the_leg_cannot_start_in_is_refused(pose, message):
    """The message has name, value, unit and bound."""
    with pytest.raises(ConfigError, match=message):
        hanging(pose=pose)


def test_a_macro_step_that_does_not_divide_is_refused():
    """A fifth of the macro step is a whole number of plant steps."""
    with pytest.raises(ConfigError, match='a fifth of step_ms'):
        hanging(step_ns=1_010_000)


PURE = """
import sys
import numpy as np
import tests.surroundings.bodies.leg.test_leg as t
from isa_ros.core.record import rows_of
from isa_ros.core.signals import LOAD_PORT
leg = t.hanging(pose=t.Pose(haa=0.2, hfe=0.8, kfe=-1.6, foot_height=0.002))
leg.release()
hold = np.array(leg.actuator_forces)
ports = rows_of(3, LOAD_PORT)
normal = 0.0
for k in range(40):
    leg.ports(ports)
    leg.advance(t.constant(hold + (0.1 * k, 3.0 * k, 2.0 * k)))
    normal = max(normal, leg.sample[0]['foot_force'][2])
assert normal > 10.0, normal
sys.stdout.write((leg.snapshot() + ports.tobytes()).hex())
"""


def test_compiled_leg_equals_its_python_source():
    """A drop through the impact with numba switched off gives the same bytes."""
    outputs = []
    for disable in ('0', '1'):
        environment = dict(os.environ, NUMBA_DISABLE_JIT=disable)
        outputs.append(subprocess.run(
            [sys.executable, '-c', PURE], env=environment, check=True, capture_output=True,
            cwd=Path(__file__).resolve().parents[4]).stdout)
    assert outputs[0] == outputs[1]
    assert len(outputs[0]) > 100


def test_a_leg_is_released_once():
    """What holds it again later keeps holding it."""
    own = Leg(SHEET, POSE, MS, release_ns=2 * MS)
    ports = np.zeros(3, LOAD_PORT)
    held = []
    for _ in range(4):
        own.ports(ports)
        held.append(own.is_held)
        own.advance(np.zeros(3, LOAD_REPLY))
    own.hold()
    own.ports(ports)
    assert held == [True, True, False, False] and own.is_held


def test_a_restored_leg_is_released_no_second_time():
    """One that was released before it was saved; one that was held is released at its time."""
    def own() -> Leg:
        return Leg(SHEET, POSE, MS, release_ns=2 * MS)

    def held(leg: Leg, ticks: int) -> list[bool]:
        found = []
        for _ in range(ticks):
            leg.ports(np.zeros(3, LOAD_PORT))
            found.append(leg.is_held)
            leg.advance(np.zeros(3, LOAD_REPLY))
        return found
    first, second, third = own(), own(), own()
    held(first, 1)
    second.restore(first.snapshot())
    assert held(second, 2) == [True, False]
    third.restore(second.snapshot())
    third.hold()
    assert held(third, 2) == [True, True]
