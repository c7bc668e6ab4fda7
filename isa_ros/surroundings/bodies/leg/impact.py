"""The mass that a leg puts behind a vertical force at its foot: that of an impact."""

from isa_ros.surroundings.bodies.leg.motion import ContinuousState, factor, solve, terms_of
from isa_ros.surroundings.bodies.leg.sheet import leg_record, LegSheet


def foot_mass(sheet: LegSheet, joints: tuple[float, float, float]) -> float:
    """
    Return 1/(J M^-1 J^T) of the foot, upwards, at angles of the joints (rad), in kg.

    Its actuators do not push.
    """
    haa, hfe, kfe = joints
    m = terms_of(ContinuousState(
        z=0.0, q_haa=haa, q_hfe=hfe, q_kfe=kfe, v_z=0.0, v_haa=0.0, v_hfe=0.0, v_kfe=0.0,
        shear_x=0.0, shear_y=0.0), leg_record(sheet)[0])
    gained = solve(factor(m, False), 1.0, m.j_z_haa, m.j_z_hfe, m.j_z_kfe)
    return 1.0 / float(gained.z + m.j_z_haa * gained.haa + m.j_z_hfe * gained.hfe
                       + m.j_z_kfe * gained.kfe)
