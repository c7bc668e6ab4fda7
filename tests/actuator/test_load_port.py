"""
The load port inside an actuator: its copy of the load moves as L1 says over whole ticks.

A Runge-Kutta step of fourth order is exact for the polynomials of third degree that L1 gives
without a force, if every stage is evaluated at its own time. What is left are the roundings of
100 steps of numbers below 0.06 m and 0.1 m/s: below 1e-15 of the unit each.
"""

from isa_ros.actuator.timing import Timing
from isa_ros.core.signals import LOAD_PORT
import numpy as np
import pytest
from tests.sheets import smart_actuator

TICK = Timing(step_ns=2_000_000, controller_offset_ns=120_000)
T = 2e-3  # s, a tick of 100 plant steps
X_0, V_0 = 0.05, 0.02  # m, m/s


def load_after_a_tick(**values: float) -> tuple[float, float]:
    """Return position and speed of an actuator's copy of its load after one tick."""
    actuator = smart_actuator('isa_v5', None, position=X_0, timing=TICK)
    port = np.zeros(1, LOAD_PORT)[0]
    port['x0'], port['v0'], port['supply_pressure'] = X_0, V_0, 20.7e6
    for name, value in values.items():
        port[name] = value
    actuator.tick(port)
    load = actuator._body.load
    return float(load.position), float(load.velocity)


@pytest.mark.parametrize('jerk', [1e4, -1e4])
def test_a_load_nothing_pushes_moves_by_its_bias_and_jerk(jerk):
    """L1 with 1/m = k = d = 0: x0 + v0 t + a_bias t^2/2 + jerk t^3/6."""
    x, v = load_after_a_tick(a_bias=7.0, jerk=jerk)
    assert x == pytest.approx(
        X_0 + V_0 * T + 7.0 * T ** 2 / 2.0 + jerk * T ** 3 / 6.0, rel=0.0, abs=1e-15)
    assert v == pytest.approx(V_0 + 7.0 * T + jerk * T ** 2 / 2.0, rel=0.0, abs=1e-14)
    assert abs(jerk * T ** 3 / 6.0) > 1e-5, 'the jerk shows'


@pytest.mark.parametrize(('stiffness', 'damping'), [(1e6, 0.0), (0.0, 3e3), (1e6, 3e3)])
def test_a_load_on_its_reference_stays_on_it(stiffness, damping):
    """
    L1: k and d pull towards x_r(t) = x0 + v0 t + a0 t^2/2, which moves under the tick.

    The middle stages stand beside it by a0 h^2/8, which leaves at most k d a0 h^4/48 = 4e-10 m/s
    a step, for the 1/(d h) = 17 steps that damping needs, and k^2 a0 h^5/96 = 1e-12 m/s a step
    without: 7e-9 m/s, which are 1e-11 m in a tick. A stage half a step late gives 7e-5 m/s.
    """
    x, v = load_after_a_tick(a0=40.0, a_bias=40.0, stiffness=stiffness, damping=damping)
    assert x == pytest.approx(X_0 + V_0 * T + 40.0 * T ** 2 / 2.0, rel=0.0, abs=1e-11)
    assert v == pytest.approx(V_0 + 40.0 * T, rel=0.0, abs=7e-9)


def test_the_force_of_the_sensor_pushes_the_load():
    """L1: F/m_eff for the impulse that the reply tells, here of a load that is pulled away."""
    actuator = smart_actuator('isa_v5', None, position=X_0, timing=TICK)
    port = np.zeros(1, LOAD_PORT)[0]
    port['x0'], port['supply_pressure'], port['inverse_mass'] = X_0 + 1e-4, 20.7e6, 0.02
    actuator.tick(port)
    impulse = float(np.mean(actuator.reply.mean_forces)) * T
    assert impulse < -0.1
    # both are sums of the same 100 steps' stages
    assert actuator._body.load.velocity == pytest.approx(0.02 * impulse, rel=1e-12, abs=0.0)
