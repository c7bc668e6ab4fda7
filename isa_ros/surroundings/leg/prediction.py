"""
How the leg will move during the next tick, and port coefficients that move alike.

An impact may begin and pass its peak within one tick, so the motion is integrated through it
under the forces that the ports assume; the two coefficients of time in a port, a_bias and jerk,
are those with which the actuator's copy of its load ends the tick at that place with that speed.
Equations L1 and L15 of docs/equations.md.
"""

import math

from isa_ros.core.kernel import kernel
from isa_ros.core.timebase import FORCE_WINDOWS
from isa_ros.surroundings.leg.motion import leg_step

COPY_STEPS = 50  # of a tick, as many as the actuator makes in one of 1 ms


@kernel
def assumed_force(f, slope, t):
    """Return the forces that the ports assume ``t`` seconds after the tick's beginning  (L16)."""
    return f[0] + t * slope[0], f[1] + t * slope[1], f[2] + t * slope[2]


@kernel
def predicted(y, tick, f, slope, is_held, leg):
    """Return y a tick of ``tick`` seconds later under the assumed forces, a step a window."""
    h = tick / FORCE_WINDOWS
    for window in range(FORCE_WINDOWS):
        y = leg_step(y, h, assumed_force(f, slope, (window + 0.5) * h), is_held, leg)
    return y


@kernel
def copy_response(tick, k, d):
    """
    Return e_1(H), e_1'(H) and e_2(H) of e'' = 1 - k e - d e' and e_2' = e_1, all from 0.

    The answers of a port's copy to a constant acceleration, and of its place to a growing one.
    """
    h = tick / COPY_STEPS
    e, v, integral = 0.0, 0.0, 0.0
    for _ in range(COPY_STEPS):
        a_1 = 1.0 - k * e - d * v
        v_2, e_2 = v + 0.5 * h * a_1, e + 0.5 * h * v
        a_2 = 1.0 - k * e_2 - d * v_2
        v_3, e_3 = v + 0.5 * h * a_2, e + 0.5 * h * v_2
        a_3 = 1.0 - k * e_3 - d * v_3
        v_4, e_4 = v + h * a_3, e + h * v_3
        a_4 = 1.0 - k * e_4 - d * v_4
        integral += h / 6.0 * (e + 2.0 * (e_2 + e_3) + e_4)
        e += h / 6.0 * (v + 2.0 * (v_2 + v_3) + v_4)
        v += h / 6.0 * (a_1 + 2.0 * (a_2 + a_3) + a_4)
    return e, v, integral


@kernel
def resolved(k, tick):
    """Return the stiffness k, cut to that of a copy which swings once to and fro in a tick."""
    return min(k, math.pi * math.pi / (tick * tick))


@kernel
def matched(place, speed, tick, k, d):
    """
    Return (a, b) with which e'' = a + b t - k e - d e' ends at ``place`` with ``speed``.

    e is the copy's departure from the reference x_r. The determinant e_1^2 - e_1' e_2 is
    H^4/12 for k = d = 0 and > 0 for the stiffness that `resolved` leaves.
    """
    e, v, integral = copy_response(tick, k, d)
    determinant = e * e - v * integral
    return (place * e - integral * speed) / determinant, (e * speed - v * place) / determinant
