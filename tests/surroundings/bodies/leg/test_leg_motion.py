"""How a leg moves: at rest, in free fall, by work, on the ground, at every step."""

import math

from isa_ros.core.signals import LOAD_PORT
from isa_ros.surroundings.bodies.leg import motion as kernels
from isa_ros.surroundings.bodies.leg.leg import LegPose
from isa_ros.surroundings.bodies.leg.sheet import STANDARD_GRAVITY
import numpy as np
import pytest
from tests.surroundings.bodies.leg.hanging_leg import (
    BODY, constant, CONSTANTS, continuous, energy, hanging, mass_matrix, moving_leg, MS, POSE,
    speeds)


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
    leg = hanging(pose=LegPose(haa=POSE.haa, hfe=POSE.hfe, kfe=POSE.kfe, foot_height=0.01))
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
