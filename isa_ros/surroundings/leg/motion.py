"""
One leg under three actuators: its state, accelerations and Runge-Kutta step.

Continuous states are one flat row of floats (`LEG_STATE`); inside a kernel they are a tuple
y = (z, q_haa, q_hfe, q_kfe, their speeds, bristle x, bristle y). Joints are in the order
HAA, HFE, KFE. Equations L6 and L12 of docs/equations.md.

Neglected: friction of joints and rail, compliance of links and joints.
"""

from typing import NamedTuple

from isa_ros.core.kernel import kernel
from isa_ros.surroundings.ground import contact
from isa_ros.surroundings.leg.dynamics import leg_terms
from isa_ros.surroundings.linkage import actuator_coordinate
import numpy as np

STATE_NAMES = (
    'z', 'q_haa', 'q_hfe', 'q_kfe',         # m, rad
    'v_z', 'v_haa', 'v_hfe', 'v_kfe',       # m/s, rad/s
    'bristle_x', 'bristle_y',               # m
    'force_haa', 'force_hfe', 'force_kfe',  # estimated at the tick's end, N | Nm
    'slope_haa', 'slope_hfe', 'slope_kfe',  # its slope, N/s | Nm/s
    'mean_haa', 'mean_hfe', 'mean_kfe',     # over the last tick, N | Nm
    'older_haa', 'older_hfe', 'older_kfe',  # over the tick before, N | Nm
    'is_held',                              # 1.0: the slider is locked
)
LEG_STATE = np.dtype([(name, '<f8') for name in STATE_NAMES])
"""The state of a leg that persists from tick to tick."""

N_STATES = 10
FORCE = N_STATES            # place of the force estimates in the flat state
SLOPE = FORCE + 3
MEAN = SLOPE + 3            # place of the last tick's mean forces
OLDER = MEAN + 3           # and of the one before
HELD = OLDER + 3


class Motion(NamedTuple):
    """Accelerations, the factor L D L^T of the mass matrix, levers and the foot."""

    a_z: float
    a_haa: float
    a_hfe: float
    a_kfe: float
    rate_x: float
    rate_y: float
    d: tuple[float, ...]     # (4,)
    l: tuple[float, ...]     # (6,), see `factor`
    r: tuple[float, ...]     # (3,), lever arms
    dr: tuple[float, ...]    # (3,), their derivatives
    foot: tuple[float, ...]  # position and force from the ground, x y z each


@kernel
def factor(m, is_held):
    """
    Return D (4) and L (6: 10 20 21 30 31 32) of M = L D L^T.

    A held slider is the constraint z'' = 0: its row and column become those of a unit mass
    without forces. D > 0 because M is positive definite.
    """
    m_zz, m_z1, m_z2, m_z3 = m.m_z_z, m.m_z_haa, m.m_z_hfe, m.m_z_kfe
    if is_held:
        m_zz, m_z1, m_z2, m_z3 = 1.0, 0.0, 0.0, 0.0
    l10, l20, l30 = m_z1 / m_zz, m_z2 / m_zz, m_z3 / m_zz
    d1 = m.m_haa_haa - l10 * m_z1
    e21, e31 = m.m_haa_hfe - l20 * m_z1, m.m_haa_kfe - l30 * m_z1
    l21, l31 = e21 / d1, e31 / d1
    d2 = m.m_hfe_hfe - l20 * m_z2 - l21 * e21
    e32 = m.m_hfe_kfe - l30 * m_z2 - l31 * e21
    l32 = e32 / d2
    d3 = m.m_kfe_kfe - l30 * m_z3 - l31 * e31 - l32 * e32
    return (m_zz, d1, d2, d3), (l10, l20, l21, l30, l31, l32)


@kernel
def solve(d, l, b0, b1, b2, b3):  # noqa: E741, the symbol of the factorisation
    """Return the solution of L D L^T x = b."""
    b1 -= l[0] * b0
    b2 -= l[1] * b0 + l[2] * b1
    b3 -= l[3] * b0 + l[4] * b1 + l[5] * b2
    x3 = b3 / d[3]
    x2 = b2 / d[2] - l[5] * x3
    x1 = b1 / d[1] - l[2] * x2 - l[4] * x3
    x0 = b0 / d[0] - l[0] * x1 - l[1] * x2 - l[3] * x3
    return x0, x1, x2, x3


@kernel
def leg_motion(y, f, is_held, body, linkages, ground):
    """Return the `Motion` under actuator forces ``f``: M q'' = r F + J^T f_foot - h  (L6)."""
    m = leg_terms(y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], body)
    _, r1, dr1 = actuator_coordinate(y[1], linkages[0])
    _, r2, dr2 = actuator_coordinate(y[2], linkages[1])
    _, r3, dr3 = actuator_coordinate(y[3], linkages[2])
    f_x, f_y, f_z, rate_x, rate_y = contact(
        m.foot_z, m.foot_v_x, m.foot_v_y, m.foot_v_z, y[8], y[9], ground)
    d, l = factor(m, is_held)  # noqa: E741
    b0 = 0.0 if is_held else f_z - m.h_z
    b1 = r1 * f[0] + m.j_y_haa * f_y + m.j_z_haa * f_z - m.h_haa
    b2 = r2 * f[1] + m.j_x_hfe * f_x + m.j_y_hfe * f_y + m.j_z_hfe * f_z - m.h_hfe
    b3 = r3 * f[2] + m.j_x_kfe * f_x + m.j_y_kfe * f_y + m.j_z_kfe * f_z - m.h_kfe
    a = solve(d, l, b0, b1, b2, b3)
    return Motion(a[0], a[1], a[2], a[3], rate_x, rate_y, d, l, (r1, r2, r3), (dr1, dr2, dr3),
                  (m.foot_x, m.foot_y, m.foot_z, f_x, f_y, f_z))


@kernel
def leg_rates(y, f, is_held, body, linkages, ground):
    """Return dy/dt, a tuple of `N_STATES`."""
    a = leg_motion(y, f, is_held, body, linkages, ground)
    return (y[4], y[5], y[6], y[7], a.a_z, a.a_haa, a.a_hfe, a.a_kfe, a.rate_x, a.rate_y)


@kernel
def shifted(y, h, k):
    """Return y + h k."""
    return (y[0] + h * k[0], y[1] + h * k[1], y[2] + h * k[2], y[3] + h * k[3],
            y[4] + h * k[4], y[5] + h * k[5], y[6] + h * k[6], y[7] + h * k[7],
            y[8] + h * k[8], y[9] + h * k[9])


@kernel
def leg_step(y, h, f, is_held, body, linkages, ground):
    """Return y after one classical Runge-Kutta step under constant forces."""
    k1 = leg_rates(y, f, is_held, body, linkages, ground)
    k2 = leg_rates(shifted(y, 0.5 * h, k1), f, is_held, body, linkages, ground)
    k3 = leg_rates(shifted(y, 0.5 * h, k2), f, is_held, body, linkages, ground)
    k4 = leg_rates(shifted(y, h, k3), f, is_held, body, linkages, ground)
    y = shifted(shifted(y, h / 6.0, k1), h / 6.0, k4)
    return shifted(shifted(y, h / 3.0, k2), h / 3.0, k3)


@kernel
def actuator_accelerations(y, f, is_held, body, linkages, ground):
    """Return x'' = r q'' + (dr/dq) q'^2 of the three actuators  (L12), in m/s2 or rad/s2."""
    a = leg_motion(y, f, is_held, body, linkages, ground)
    return (a.r[0] * a.a_haa + a.dr[0] * y[5] * y[5],
            a.r[1] * a.a_hfe + a.dr[1] * y[6] * y[6],
            a.r[2] * a.a_kfe + a.dr[2] * y[7] * y[7])


@kernel
def unpacked(flat):
    """Return (y, forces, slopes, is_held) of the flat state."""
    y = (flat[0], flat[1], flat[2], flat[3], flat[4], flat[5], flat[6], flat[7], flat[8], flat[9])
    return (y, (flat[FORCE], flat[FORCE + 1], flat[FORCE + 2]),
            (flat[SLOPE], flat[SLOPE + 1], flat[SLOPE + 2]), flat[HELD] != 0.0)
