"""
What the load port says of a leg whose foot sticks to the ground.

Standing, the sole under the foot shears with it (L14) and holds it along the ground as a spring
k_t. An actuator that pushes a little harder during a tick feels it: without the shear the
stiffness in the port would be an eighth at the abduction, half at the thigh and four fifths at
the knee.
"""

from functools import cache
import math

from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY
from isa_ros.surroundings.bodies.leg.leg import Leg, LegPose
from isa_ros.surroundings.bodies.leg.motion import continuous, leg_motion, LEG_STATE, leg_step
from isa_ros.surroundings.bodies.leg.sheet import JOINTS, leg_record
import numpy as np
import pytest
from tests.legs import leg_sheet

MS = 1_000_000
T, N = 1e-3, 1000  # s of a tick, steps of the leg in it
TIME_BYTES = 8     # a snapshot begins with the time
CONSTANTS = leg_record(leg_sheet())[0]
ACTUATORS = pytest.mark.parametrize('j', range(3), ids=JOINTS)


@cache
def standing() -> tuple[Leg, np.ndarray]:
    """Return a leg that has stood on springs and dampers for 3 s, and its ports."""
    leg = Leg(leg_sheet(), LegPose(haa=math.radians(13.0), hfe=math.radians(48.0),
                                   kfe=math.radians(-95.0), foot_height=0.01), MS)
    leg.release()
    start = np.array(leg.actuator_positions)
    stiffness, damping = np.array((2e3, 3e5, 3e5)), np.array((60.0, 6e3, 6e3))
    ports, replies = np.zeros(3, LOAD_PORT), np.zeros(3, LOAD_REPLY)
    for _ in range(3000):
        leg.ports(ports)
        force = stiffness * (start - ports['x0']) - damping * ports['v0']
        replies['mean_forces'], replies['force'] = force[:, None], force
        leg.advance(replies)
    leg.ports(ports)
    return leg, ports


def moved_by_a_newton(j: int) -> float:
    """Return how much farther a newton (or Nm) more at actuator ``j`` brings it in a tick."""
    leg, _ = standing()
    state = np.frombuffer(leg.snapshot(), LEG_STATE, 1, TIME_BYTES)[0]
    y_0, force = continuous(state), state['force']
    ends = []
    for extra in (0.0, 1.0):
        y, pushed = y_0, tuple(force[k] + (extra if k == j else 0.0) for k in range(3))
        for _ in range(N):
            y = leg_step(y, T / N, pushed, leg.is_held, CONSTANTS)
        ends.append(leg_motion(y, pushed, leg.is_held, CONSTANTS).position[j])
    return ends[1] - ends[0]


def predicted_by_the_port(j: int) -> float:
    """Return the same of the port's linear copy, x'' = 1/m_eff - k x - d x'."""
    port = standing()[1][j]
    x = v = 0.0
    for _ in range(N):
        a = port['inverse_mass'] - port['stiffness'] * x - port['damping'] * v
        x += T / N * (v + 0.5 * T / N * a)
        v += T / N * a
    return x


def test_the_foot_sticks() -> None:
    """It stands within its friction cone, loaded to half of it: the sole is sheared."""
    f_x, f_y, normal = standing()[0].sample[0]['foot_force']
    assert 0.3 * 0.7 * normal < math.hypot(f_x, f_y) < 0.7 * 0.7 * normal


@ACTUATORS
def test_the_port_knows_how_a_sticking_leg_gives_way_during_the_next_tick(j: int) -> None:
    """
    L13 to L15: the ground takes 0.9 to 6 % of the way a free leg would move in a tick.

    The port must know that part to half a percent: leg and copy are integrated alike, and a
    newton (or Nm) moves the foot by 1e-6 m at most, a thousandth of the 1.3e-3 m over which the
    law of the ground bends. A port that left the sole as it is would miss a tenth to
    a half of it.
    """
    moved = moved_by_a_newton(j)
    free = 0.5 * float(standing()[1]['inverse_mass'][j]) * T * T
    held_back = free - moved
    assert held_back > 0.005 * free
    assert free - predicted_by_the_port(j) == pytest.approx(held_back, rel=5e-3, abs=0.0)
