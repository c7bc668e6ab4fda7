"""The copy of its load that an actuator integrates from a port, by Runge-Kutta steps."""

from collections.abc import Callable

from isa_ros.loads.port import load_acceleration
import numpy as np


def end_of_copy(
        own: np.void, force: Callable[[float], float], seconds: float, n_steps: int,
        ) -> tuple[float, float]:
    """Return place and speed after some time under a force of time, by ``n_steps`` of RK4."""
    x, v, h = float(own['x0']), float(own['v0']), seconds / n_steps

    def rate(t: float, x: float, v: float) -> float:
        return float(load_acceleration(t, x, v, force(t), own))
    for i in range(n_steps):
        t = i * h
        a_1 = rate(t, x, v)
        a_2 = rate(t + 0.5 * h, x + 0.5 * h * v, v + 0.5 * h * a_1)
        a_3 = rate(t + 0.5 * h, x + 0.5 * h * (v + 0.5 * h * a_1), v + 0.5 * h * a_2)
        a_4 = rate(t + h, x + h * (v + 0.5 * h * a_2), v + h * a_3)
        x += h * v + h * h / 6.0 * (a_1 + a_2 + a_3)
        v += h / 6.0 * (a_1 + 2.0 * (a_2 + a_3) + a_4)
    return x, v
