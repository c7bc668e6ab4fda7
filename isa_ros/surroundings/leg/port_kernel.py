"""
Exchange of a leg with its three actuators: load ports down, a tick under their forces.

States and joints as in `surroundings.leg.motion`; L1 is the port, L12-L16 are its coefficients
for a leg and the forces kept from tick to tick.
"""

import math

from isa_ros.core.kernel import kernel
from isa_ros.core.signals import LOAD_REPLY
from isa_ros.core.timebase import FORCE_WINDOWS, NS_PER_SECOND
from isa_ros.surroundings.ground import bristle_rates
from isa_ros.surroundings.leg.dynamics import leg_terms
from isa_ros.surroundings.leg.motion import (
    actuator_accelerations, FORCE, leg_motion, leg_step, MEAN, N_STATES, OLDER, shifted, SLOPE,
    solve, unpacked)
from isa_ros.surroundings.linkage import actuator_coordinate
import numpy as np

LEG_SAMPLE = np.dtype([
    ('position', '<f8', (3,)),        # joint angles, rad
    ('velocity', '<f8', (3,)),        # rad/s
    ('torque', '<f8', (3,)),          # lever times sensor force, Nm
    ('foot_force', '<f8', (3,)),      # from the ground, base axes, N
    ('foot_position', '<f8', (3,)),   # base axes, z above the ground, m
    ('height', '<f8'),                # HAA axis above the ground, m
    ('height_velocity', '<f8'),       # m/s
])
"""What a leg shows at the end of a tick."""
LEG_UNITS = {
    'position': 'rad', 'velocity': 'rad/s', 'torque': 'Nm', 'foot_force': 'N',
    'foot_position': 'm', 'height': 'm', 'height_velocity': 'm/s'}

REPLY_WIDTH = LOAD_REPLY.itemsize // 8
MEANS = 0                   # places in a reply's row of floats
END_FORCE = FORCE_WINDOWS
SUBSTEP_NS = 100_000        # longest Runge-Kutta step of the leg, coupling.md
PROBE_DISPLACEMENT = 1e-7   # m | rad: 1e-3 of the smallest depth at which the ground matters
PROBE_SPEED = 1e-5          # m/s | rad/s: equally small against impact speeds


@kernel
def response(j, a):
    """
    Return (u, 1/m_eff) of a force at actuator ``j``  (L13).

    u is the direction in which the leg yields to it, scaled to one unit of x_j: M^-1 e_j / (r
    (M^-1)_jj); 1/m_eff = r^2 (M^-1)_jj.
    """
    e = (1.0 if j == 0 else 0.0, 1.0 if j == 1 else 0.0, 1.0 if j == 2 else 0.0)
    c = solve(a.d, a.l, 0.0, e[0], e[1], e[2])
    scale = 1.0 / (a.r[j] * c[j + 1])
    return (c[0] * scale, c[1] * scale, c[2] * scale, c[3] * scale), a.r[j] * a.r[j] * c[j + 1]


@kernel
def bristle_follow(y, u, body, ground):
    """Return the bristles' deflection for a displacement u of the leg: (dz'/dv) J u  (L14)."""
    m = leg_terms(y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], body)
    if m.foot_z >= 0.0:
        return 0.0, 0.0
    w_x = m.j_x_hfe * u[2] + m.j_x_kfe * u[3]
    w_y = m.j_y_haa * u[1] + m.j_y_hfe * u[2] + m.j_y_kfe * u[3]
    s = PROBE_SPEED
    before = bristle_rates(y[8], y[9], m.foot_v_x, m.foot_v_y, True, ground)
    after = bristle_rates(
        y[8], y[9], m.foot_v_x + s * w_x, m.foot_v_y + s * w_y, True, ground)
    return (after[0] - before[0]) / s, (after[1] - before[1]) / s


@kernel
def leg_ports(flat, look_ahead, rows, body_rows, linkages, ground_rows, ports):
    """
    Fill the `LOAD_PORT` of the three actuators, rows ``rows`` of ``ports``  (L1, L12-L15).

    Pressures are left as they are. ``look_ahead`` (s) is the distance of the jerk's
    finite difference.
    """
    body, ground = body_rows[0], ground_rows[0]
    y, f, slope, is_held = unpacked(flat)
    a = leg_motion(y, f, is_held, body, linkages, ground)
    now = actuator_accelerations(y, f, is_held, body, linkages, ground)
    h = look_ahead
    speed = (y[4] + 0.5 * h * a.a_z, y[5] + 0.5 * h * a.a_haa, y[6] + 0.5 * h * a.a_hfe,
             y[7] + 0.5 * h * a.a_kfe)
    ahead = shifted(y, h, (speed[0], speed[1], speed[2], speed[3], a.a_z, a.a_haa, a.a_hfe,
                           a.a_kfe, a.rate_x, a.rate_y))
    later = actuator_accelerations(
        ahead, (f[0] + h * slope[0], f[1] + h * slope[1], f[2] + h * slope[2]),
        is_held, body, linkages, ground)
    for j in range(3):
        port = ports[rows[j]]
        u, inverse_mass = response(j, a)
        x, r, _ = actuator_coordinate(y[j + 1], linkages[j])
        port.x0, port.v0, port.a0 = x, r * y[j + 5], now[j]
        port.inverse_mass = inverse_mass
        port.a_bias = now[j] - f[j] * inverse_mass
        port.jerk = (later[j] - now[j]) / h - slope[j] * inverse_mass
        z_x, z_y = bristle_follow(y, u, body, ground)
        moved = shifted(y, PROBE_DISPLACEMENT,
                        (u[0], u[1], u[2], u[3], 0.0, 0.0, 0.0, 0.0, z_x, z_y))
        faster = shifted(y, PROBE_SPEED,
                         (0.0, 0.0, 0.0, 0.0, u[0], u[1], u[2], u[3], 0.0, 0.0))
        port.stiffness = (now[j] - actuator_accelerations(
            moved, f, is_held, body, linkages, ground)[j]) / PROBE_DISPLACEMENT
        port.damping = (now[j] - actuator_accelerations(
            faster, f, is_held, body, linkages, ground)[j]) / PROBE_SPEED


@kernel
def fill_sample(y, f, is_held, body, linkages, ground, sample):
    """Fill one `LEG_SAMPLE`, a flat row; ``f`` are the sensor forces."""
    a = leg_motion(y, f, is_held, body, linkages, ground)
    for j in range(3):
        sample[j] = y[j + 1]
        sample[j + 3] = y[j + 5]
        sample[j + 6] = a.r[j] * f[j]
        sample[j + 9] = a.foot[j + 3]
        sample[j + 12] = a.foot[j]
    sample[15], sample[16] = y[0], y[4]


@kernel
def reply_column(replies, rows, column):
    """Return one column of the three actuators' rows of the flat replies."""
    return replies[rows[0], column], replies[rows[1], column], replies[rows[2], column]


@kernel
def leg_tick(flat, step_ns, rows, body_rows, linkages, ground_rows, replies, sample):
    """
    Advance by one macro step under the mean forces of its windows; return a broken state or -1.

    ``replies`` are the `LOAD_REPLY` rows as floats, shape (n_actuators, REPLY_WIDTH). Each
    window is divided into equal Runge-Kutta steps of at most `SUBSTEP_NS`.
    """
    body, ground = body_rows[0], ground_rows[0]
    y, _, _, is_held = unpacked(flat)
    window_ns = step_ns // FORCE_WINDOWS
    substeps = (window_ns + SUBSTEP_NS - 1) // SUBSTEP_NS
    h = window_ns / NS_PER_SECOND / substeps
    for window in range(FORCE_WINDOWS):
        f = reply_column(replies, rows, MEANS + window)
        for _ in range(substeps):
            y = leg_step(y, h, f, is_held, body, linkages, ground)
    for i in range(N_STATES):
        flat[i] = y[i]
        if not math.isfinite(y[i]):
            return i
    keep_forces(flat, step_ns / NS_PER_SECOND, rows, replies)
    fill_sample(y, reply_column(replies, rows, END_FORCE), is_held, body, linkages, ground,
                sample)
    return -1


@kernel
def window_line(replies, row):
    """
    Return (mean, slope per window, R^2) of the line through a tick's window means.

    R^2, the share of their spread that is a trend, is 0 for equal means.
    """
    n = float(FORCE_WINDOWS)
    mean, moment, spread = 0.0, 0.0, 0.0
    for window in range(FORCE_WINDOWS):
        mean += replies[row, MEANS + window] / n
    for window in range(FORCE_WINDOWS):
        departure = replies[row, MEANS + window] - mean
        moment += (window - 0.5 * (n - 1.0)) * departure
        spread += departure * departure
    slope = 12.0 * moment / (n * (n * n - 1.0))
    return mean, slope, slope * moment / spread if spread > 0.0 else 0.0


@kernel
def keep_forces(flat, step, rows, replies):
    """
    Keep the force that each port will assume of the other actuators, and its slope  (L16).

    Mean of the tick, slope F' = R^4 F'_line + (1 - R^4) (mean - mean two ticks ago) / (2 H),
    force at the tick's end = mean + F' H / 2. A trend within the tick is weighted by how well
    a line fits it: if the ringing of a load cell reached the other actuators as a trend, the
    exchange would feed it (with a damping ratio of 0.01 it grows when it beats with the ticks).
    """
    for j in range(3):
        mean, rise, r_2 = window_line(replies, rows[j])
        trust = r_2 * r_2
        slope = (trust * rise * FORCE_WINDOWS / step
                 + (1.0 - trust) * (mean - flat[OLDER + j]) / (2.0 * step))
        flat[OLDER + j] = flat[MEAN + j]
        flat[MEAN + j] = mean
        flat[SLOPE + j] = slope
        flat[FORCE + j] = mean + 0.5 * step * slope
