"""
How long a foot that falls on the ground touches it: the time scale of an impact.

The foot is the mass that the leg puts behind a vertical force at it, with actuators that do not
push, on the ground's spring k d^1.5 (Hertz). Neglected: damping, which changes the time by a few
per cent, friction, and the leg's weight.
"""

from isa_ros.core.elementary import exp, log
from isa_ros.surroundings.bodies.leg.motion import ContinuousState, factor, solve, terms_of
from isa_ros.surroundings.bodies.leg.sheet import leg_record, LegSheet

IMPACT_SPEED = 1.0  # m/s, a fall of 5 cm; at four times the speed the time is a quarter shorter
_SHARE, _EXPONENT = 5.0 / 4.0, 2.0 / 5.0    # of the energy, m v^2/2 = (2/5) k d^2.5
HERTZ = 2.943275    # 2 sqrt(pi) Gamma(7/5)/Gamma(9/10), the time in units of depth over speed


def foot_mass(sheet: LegSheet, joints: tuple[float, float, float]) -> float:
    """Return 1/(J M^-1 J^T) of the foot, upwards, at angles of the joints (rad), in kg."""
    haa, hfe, kfe = joints
    m = terms_of(ContinuousState(
        z=0.0, q_haa=haa, q_hfe=hfe, q_kfe=kfe, v_z=0.0, v_haa=0.0, v_hfe=0.0, v_kfe=0.0,
        shear_x=0.0, shear_y=0.0), leg_record(sheet)[0])
    gained = solve(factor(m, False), 1.0, m.j_z_haa, m.j_z_hfe, m.j_z_kfe)
    return 1.0 / float(gained.z + m.j_z_haa * gained.haa + m.j_z_hfe * gained.hfe
                       + m.j_z_kfe * gained.kfe)


def contact_time(sheet: LegSheet, joints: tuple[float, float, float]) -> float:
    """
    Return T = 2.943 d/v, d = (5 m v^2/(4 k))^(2/5), of an impact with `IMPACT_SPEED` v, in s.

    From m d'' = -k d^1.5; d is the greatest depth. The declared range keeps k > 0.
    """
    v, mass = IMPACT_SPEED, foot_mass(sheet, joints)
    depth = exp(_EXPONENT * log(_SHARE * mass * v * v / sheet.ground.stiffness))
    return HERTZ * depth / v
