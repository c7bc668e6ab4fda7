"""The time scale of an impact: the mass behind the foot, and how long the ground holds it."""

import math

from isa_ros.surroundings.bodies.leg import motion as kernels
from isa_ros.surroundings.bodies.leg.impact import foot_mass
from isa_ros.surroundings.bodies.leg.sheet import leg_record
from isa_ros.surroundings.impact import contact_time, IMPACT_SPEED
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.legs import leg_sheet

SHEET = leg_sheet()
JOINTS = math.radians(10.0), math.radians(41.3), math.radians(-80.0)


def test_the_mass_behind_the_foot_is_what_a_force_on_it_accelerates():
    """
    Released in the air and pushed up by 1 N, the foot gains 1/m more than without; z = J q.

    The push is the ground's own force at a depth of (1 N/k)^(2/3).
    """
    leg = leg_record(SHEET)[0]
    depth = (1.0 / leg.ground.stiffness) ** (2.0 / 3.0)
    gained = []
    for height in (1.0, -depth):
        y = kernels.ContinuousState(0.0, *JOINTS, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        y = y._replace(z=height - kernels.terms_of(y, leg).foot_z)
        terms, f = kernels.terms_of(y, leg), (0.0, 0.0, 0.0)
        moved = kernels.leg_motion(y, f, False, leg)
        a = moved.acceleration
        gained.append(a.z + terms.j_z_haa * a.haa + terms.j_z_hfe * a.hfe
                      + terms.j_z_kfe * a.kfe)
    assert moved.foot_force[2] == pytest.approx(1.0, rel=1e-9)
    # the shear is 0: no friction; the difference of accelerations of 10 m/s2 has 1e-15 * 10
    assert foot_mass(SHEET, JOINTS) == pytest.approx(1.0 / (gained[1] - gained[0]), rel=1e-9)


def test_the_time_is_that_of_the_equation_it_solves():
    """Solve m d'' = -k d^1.5 from d = 0 and d' = v until d = 0 again."""
    mass, stiffness = foot_mass(SHEET, JOINTS), SHEET.ground.stiffness

    def leaves(t: float, y: np.ndarray) -> float:
        return float(y[0])
    leaves.terminal, leaves.direction = True, -1.0  # type: ignore[attr-defined]
    solved = solve_ivp(
        lambda t, y: (y[1], -stiffness / mass * max(y[0], 0.0) ** 1.5), (0.0, 1.0),
        (0.0, IMPACT_SPEED), events=leaves, rtol=1e-10, atol=1e-14, max_step=1e-4)
    # the integration's 1e-10 a step, over a hundred steps
    assert contact_time(mass, stiffness) == pytest.approx(solved.t[-1], rel=1e-7)
