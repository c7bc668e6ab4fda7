"""
One leg under three actuators: its state, accelerations and Runge-Kutta step.

Joints are in the order HAA, HFE, KFE; three values of one kind are a tuple in that order. Inside
a kernel y is the `ContinuousState`, f the actuators' forces, ``leg`` the record `LEG`. Equations
L6 and L12 of docs/equations.md.

Neglected: friction of joints and rail, compliance of links and joints.
"""

from typing import NamedTuple

from isa_ros.core.kernel import kernel
from isa_ros.surroundings.bodies.leg.dynamics import LEG_BODY, leg_terms
from isa_ros.surroundings.ground import contact, GROUND
from isa_ros.surroundings.linkage import actuator_coordinate, LINKAGE
from isa_ros.surroundings.port import kept_forces
import numpy as np


LEG = np.dtype([
    ('body', LEG_BODY), ('haa', LINKAGE), ('hfe', LINKAGE), ('kfe', LINKAGE), ('ground', GROUND)])
"""Every constant of one leg, SI."""


class ContinuousState(NamedTuple):
    """What the equations of motion integrate, or the rates of change of it."""

    z: float            # m
    q_haa: float        # rad
    q_hfe: float
    q_kfe: float
    v_z: float          # m/s
    v_haa: float        # rad/s
    v_hfe: float
    v_kfe: float
    shear_x: float      # of the sole, m
    shear_y: float


LEG_STATE = np.dtype([
    *((name, '<f8') for name in ContinuousState._fields),
    *kept_forces(3),
    ('is_held', '<f8'),           # 1.0: the slider is locked
])
"""The state of a leg that persists from tick to tick."""


class Coordinates(NamedTuple):
    """One value per generalised coordinate."""

    z: float
    haa: float
    hfe: float
    kfe: float


class Factor(NamedTuple):
    """D and the lower triangle of L of a mass matrix M = L D L^T."""

    d0: float
    d1: float
    d2: float
    d3: float
    l10: float
    l20: float
    l21: float
    l30: float
    l31: float
    l32: float


class LegMotion(NamedTuple):
    """How the leg moves at one instant; three values are those of the joints, or x y z."""

    acceleration: Coordinates            # m/s2, rad/s2
    shear_rate_x: float                  # m/s
    shear_rate_y: float
    factor: Factor                       # of the mass matrix
    position: tuple[float, ...]          # (3,), of the actuators, m | rad
    lever: tuple[float, ...]             # (3,), r
    lever_rate: tuple[float, ...]        # (3,), dr/dq
    foot_position: tuple[float, ...]     # (3,), m
    foot_force: tuple[float, ...]        # (3,), from the ground, N


@kernel
def factor(m, is_held):
    """
    Return the `Factor` of the mass matrix in the `LegTerms` m.

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
    return Factor(
        d0=m_zz, d1=d1, d2=d2, d3=d3, l10=l10, l20=l20, l21=l21, l30=l30, l31=l31, l32=l32)


@kernel
def solve(m, b0, b1, b2, b3):
    """Return the solution x of L D L^T x = b with the `Factor` m."""
    b1 -= m.l10 * b0
    b2 -= m.l20 * b0 + m.l21 * b1
    b3 -= m.l30 * b0 + m.l31 * b1 + m.l32 * b2
    x3 = b3 / m.d3
    x2 = b2 / m.d2 - m.l32 * x3
    x1 = b1 / m.d1 - m.l21 * x2 - m.l31 * x3
    x0 = b0 / m.d0 - m.l10 * x1 - m.l20 * x2 - m.l30 * x3
    return Coordinates(z=x0, haa=x1, hfe=x2, kfe=x3)


@kernel
def terms_of(y, leg):
    """Return the `LegTerms` of a state."""
    return leg_terms(y.z, y.q_haa, y.q_hfe, y.q_kfe, y.v_z, y.v_haa, y.v_hfe, y.v_kfe,
                     leg.body)


@kernel
def leg_motion(y, f, is_held, leg):
    """Return the `LegMotion` under actuator forces: M q'' = r F + J^T f_foot - h  (L6)."""
    m = terms_of(y, leg)
    f_haa, f_hfe, f_kfe = f
    x_haa, r_haa, dr_haa = actuator_coordinate(y.q_haa, leg.haa)
    x_hfe, r_hfe, dr_hfe = actuator_coordinate(y.q_hfe, leg.hfe)
    x_kfe, r_kfe, dr_kfe = actuator_coordinate(y.q_kfe, leg.kfe)
    f_x, f_y, f_z, rate_x, rate_y = contact(
        m.foot_z, m.foot_v_x, m.foot_v_y, m.foot_v_z, y.shear_x, y.shear_y, leg.ground)
    m_factor = factor(m, is_held)
    acceleration = solve(
        m_factor,
        0.0 if is_held else f_z - m.h_z,
        r_haa * f_haa + m.j_y_haa * f_y + m.j_z_haa * f_z - m.h_haa,
        r_hfe * f_hfe + m.j_x_hfe * f_x + m.j_y_hfe * f_y + m.j_z_hfe * f_z - m.h_hfe,
        r_kfe * f_kfe + m.j_x_kfe * f_x + m.j_y_kfe * f_y + m.j_z_kfe * f_z - m.h_kfe)
    return LegMotion(
        acceleration=acceleration, shear_rate_x=rate_x, shear_rate_y=rate_y,
        factor=m_factor, position=(x_haa, x_hfe, x_kfe), lever=(r_haa, r_hfe, r_kfe),
        lever_rate=(dr_haa, dr_hfe, dr_kfe),
        foot_position=(m.foot_x, m.foot_y, m.foot_z), foot_force=(f_x, f_y, f_z))


@kernel
def leg_rates(y, f, is_held, leg):
    """Return dy/dt, a `ContinuousState` of rates."""
    motion = leg_motion(y, f, is_held, leg)
    a = motion.acceleration
    return ContinuousState(
        z=y.v_z, q_haa=y.v_haa, q_hfe=y.v_hfe, q_kfe=y.v_kfe,
        v_z=a.z, v_haa=a.haa, v_hfe=a.hfe, v_kfe=a.kfe,
        shear_x=motion.shear_rate_x, shear_y=motion.shear_rate_y)


@kernel
def shifted(y, h, k):
    """Return y + h k."""
    return ContinuousState(
        z=y.z + h * k.z, q_haa=y.q_haa + h * k.q_haa, q_hfe=y.q_hfe + h * k.q_hfe,
        q_kfe=y.q_kfe + h * k.q_kfe, v_z=y.v_z + h * k.v_z, v_haa=y.v_haa + h * k.v_haa,
        v_hfe=y.v_hfe + h * k.v_hfe, v_kfe=y.v_kfe + h * k.v_kfe,
        shear_x=y.shear_x + h * k.shear_x, shear_y=y.shear_y + h * k.shear_y)


@kernel
def leg_step(y, h, f, is_held, leg):
    """Return y after one classical Runge-Kutta step under constant forces."""
    k1 = leg_rates(y, f, is_held, leg)
    k2 = leg_rates(shifted(y, 0.5 * h, k1), f, is_held, leg)
    k3 = leg_rates(shifted(y, 0.5 * h, k2), f, is_held, leg)
    k4 = leg_rates(shifted(y, h, k3), f, is_held, leg)
    y = shifted(shifted(y, h / 6.0, k1), h / 6.0, k4)
    return shifted(shifted(y, h / 3.0, k2), h / 3.0, k3)


@kernel
def joint_angles(y):
    """Return the joint angles of a state, rad."""
    return y.q_haa, y.q_hfe, y.q_kfe


@kernel
def joint_speeds(y):
    """Return the joint speeds of a state, rad/s."""
    return y.v_haa, y.v_hfe, y.v_kfe


@kernel
def actuator_accelerations(y, f, is_held, leg):
    """Return x'' = r q'' + (dr/dq) q'^2 of the three actuators  (L12), in m/s2 or rad/s2."""
    motion = leg_motion(y, f, is_held, leg)
    a, (r_haa, r_hfe, r_kfe) = motion.acceleration, motion.lever
    dr_haa, dr_hfe, dr_kfe = motion.lever_rate
    return (r_haa * a.haa + dr_haa * y.v_haa * y.v_haa,
            r_hfe * a.hfe + dr_hfe * y.v_hfe * y.v_hfe,
            r_kfe * a.kfe + dr_kfe * y.v_kfe * y.v_kfe)


@kernel
def continuous(state):
    """Return the `ContinuousState` in a `LEG_STATE`."""
    return ContinuousState(
        z=state.z, q_haa=state.q_haa, q_hfe=state.q_hfe, q_kfe=state.q_kfe,
        v_z=state.v_z, v_haa=state.v_haa, v_hfe=state.v_hfe, v_kfe=state.v_kfe,
        shear_x=state.shear_x, shear_y=state.shear_y)


@kernel
def keep_continuous(y, state):
    """Write a `ContinuousState` into a `LEG_STATE`."""
    state.z, state.q_haa, state.q_hfe, state.q_kfe = y.z, y.q_haa, y.q_hfe, y.q_kfe
    state.v_z, state.v_haa, state.v_hfe, state.v_kfe = y.v_z, y.v_haa, y.v_hfe, y.v_kfe
    state.shear_x, state.shear_y = y.shear_x, y.shear_y


@kernel
def of_joints(values):
    """Return the values of a field of three as a tuple."""
    return values[0], values[1], values[2]
