"""The leg as a load: statics, momentum, energy, ports, determinism, errors."""

import math
import os
from pathlib import Path
import subprocess
import sys

from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY
from isa_ros.errors import ConfigError, SimulationDiverged
from isa_ros.surroundings.bodies.leg import motion as kernels
from isa_ros.surroundings.bodies.leg.leg import Leg, LegPose
from isa_ros.surroundings.bodies.leg.sheet import JOINTS
from isa_ros.surroundings.linkage import actuator_coordinate
import numpy as np
import pytest
from tests.surroundings.bodies.leg.hanging_leg import (
    constant, CONSTANTS, continuous, hanging, mass_matrix, moving_leg, MS, POSE, SHEET, state)


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
    (LegPose(haa=0.0, hfe=0.0, kfe=-1.5, foot_height=0.1),
     r'pose\.hfe = 0 deg, must be within 15'),
    (LegPose(haa=1.0, hfe=0.8, kfe=-1.5, foot_height=0.1), r'pose\.haa = 57\.2958 deg, must be'),
    (LegPose(haa=0.0, hfe=0.8, kfe=-1.5, foot_height=-0.01),
     r'foot_height = -0\.01 m, must be >= 0'),
    (LegPose(haa=math.nan, hfe=0.8, kfe=-1.5, foot_height=0.1), r'pose\.haa = nan deg')])
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
leg = t.hanging(pose=t.LegPose(haa=0.2, hfe=0.8, kfe=-1.6, foot_height=0.002))
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
