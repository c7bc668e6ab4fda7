"""
What any body needs for quiet load ports: its actuators' forces kept, its motion matched.

k actuators move the body; ``rows`` (k,) are their places in the run's arrays of `LOAD_PORT` and
`LOAD_REPLY`. The body looks ahead: it integrates its motion through the next tick under the forces
that `assumed_force` gives, and `match_ports` chooses the two coefficients of time in each port,
a_bias and jerk, so that the actuator's copy of its load ends the tick at that place with that
speed. An impact may begin and pass its peak within one tick. Equations L1, L15 and L16 of
docs/equations.md.
"""

import math

from isa_ros.core.kernel import kernel
from isa_ros.core.timebase import FORCE_WINDOWS

COPY_STEPS = 50  # of a tick, as many as the actuator makes in one of 1 ms


def kept_forces(k: int) -> list[tuple[str, str, tuple[int]]]:
    """Return the fields of a body's state that `keep_forces` keeps for k actuators."""
    return [
        ('force', '<f8', (k,)),       # estimated at the tick's end, N | Nm
        ('slope', '<f8', (k,)),       # its slope, N/s | Nm/s
        ('mean_force', '<f8', (k,)),  # over the last tick, N | Nm
        ('older_mean', '<f8', (k,)),  # over the tick before, N | Nm
    ]


@kernel
def assumed_force(force, slope, t):
    """Return the force that a port assumes ``t`` seconds after the tick's beginning  (L16)."""
    return force + t * slope


@kernel
def window_line(means):
    """
    Return (mean, slope per window, R^2) of the line through a tick's window means.

    R^2, the share of their spread that is a trend, is 0 for equal means.
    """
    n = float(FORCE_WINDOWS)
    mean, moment, spread = 0.0, 0.0, 0.0
    for window in range(FORCE_WINDOWS):
        mean += means[window] / n
    for window in range(FORCE_WINDOWS):
        departure = means[window] - mean
        moment += (window - 0.5 * (n - 1.0)) * departure
        spread += departure * departure
    slope = 12.0 * moment / (n * (n * n - 1.0))
    return mean, slope, slope * moment / spread if spread > 0.0 else 0.0


@kernel
def keep_forces(state, step, rows, replies):
    """
    Keep in the `kept_forces` of ``state`` what each port will assume of the other forces  (L16).

    Mean of the tick, slope F' = R^4 F'_line + (1 - R^4) (mean - mean two ticks ago) / (2 H),
    force at the tick's end = mean + F' H / 2. A trend within the tick is weighted by how well
    a line fits it: if the ringing of a load cell reached the other actuators as a trend, the
    exchange would feed it (with a damping ratio of 0.01 it grows when it beats with the ticks).
    """
    for j in range(len(rows)):
        mean, rise, r_2 = window_line(replies[rows[j]].mean_forces)
        trust = r_2 * r_2
        slope = (trust * rise * FORCE_WINDOWS / step
                 + (1.0 - trust) * (mean - state.older_mean[j]) / (2.0 * step))
        state.older_mean[j] = state.mean_force[j]
        state.mean_force[j] = mean
        state.slope[j] = slope
        state.force[j] = mean + 0.5 * step * slope


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


@kernel
def match_ports(ports, rows, tick, state, position, speed):
    """
    Fill a_bias and jerk of k `LOAD_PORT` rows whose other numbers are filled  (L15).

    ``position`` (m | rad) and ``speed`` (m/s | rad/s), k of each, are those at the end of the tick
    of ``tick`` seconds, under the forces assumed by the `kept_forces` of ``state``.
    """
    for j in range(len(rows)):
        port = ports[rows[j]]
        a, b = matched(
            position[j] - port.x0 - tick * (port.v0 + 0.5 * tick * port.a0),
            speed[j] - port.v0 - tick * port.a0, tick, port.stiffness, port.damping)
        port.a_bias = a + port.a0 - state.force[j] * port.inverse_mass
        port.jerk = b - state.slope[j] * port.inverse_mass
