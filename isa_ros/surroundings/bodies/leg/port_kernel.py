"""
Exchange of a leg with its three actuators: load ports down, a tick under their forces.

States, joints and ``leg`` as in `motion`. ``states``, ``legs`` and ``samples`` are one
`LEG_STATE`, `LEG` and `LEG_SAMPLE`, (1,) each; ``rows`` (3,) are the places of the three actuators
in ``ports`` and ``replies``. L1 is the port, L12-L14 are its coefficients for a leg; L15 and L16
are those of any body (`isa_ros.surroundings.port`).
"""

from isa_ros.core.fields import Field, record_type
from isa_ros.core.kernel import kernel
from isa_ros.core.timebase import FORCE_WINDOWS, NS_PER_SECOND
from isa_ros.surroundings.bodies.leg.motion import (
    actuator_accelerations, continuous, ContinuousState, Coordinates, joint_angles, joint_speeds,
    keep_continuous, leg_motion, leg_step, of_joints, shifted, solve, terms_of)
from isa_ros.surroundings.ground import contact
from isa_ros.surroundings.port import assumed_force, keep_forces, match_ports, resolved
from isa_ros.surroundings.vectors import first_broken

LEG_FIELDS = (
    Field('position', 'rad', 'joint angles', (3,)),
    Field('velocity', 'rad/s', 'of the joints', (3,)),
    Field('torque', 'Nm', 'lever times sensor force', (3,)),
    Field('foot_force', 'N', 'from the ground, base axes', (3,)),
    Field('foot_position', 'm', 'base axes, z above the ground', (3,)),
    Field('height', 'm', 'HAA axis above the ground'),
    Field('height_velocity', 'm/s', 'of the HAA axis'),
    Field('foot_moment', 'Nm', 'of the foot force about the origin of the base axes', (3,)),
)
"""The sample of a leg at the end of a tick."""
LEG_SAMPLE = record_type(LEG_FIELDS)

SUBSTEP_NS = 100_000        # longest Runge-Kutta step of the leg, coupling.md
PROBE_DISPLACEMENT = 1e-7   # m | rad: 1e-3 of the smallest depth at which the ground matters
PROBE_SPEED = 1e-5          # m/s | rad/s: equally small against impact speeds


@kernel
def response(j, motion):
    """
    Return (u, 1/m_eff) of a force at actuator ``j``  (L13).

    u is the direction in which the leg yields to it, scaled to one unit of x_j: M^-1 e_j / (r
    (M^-1)_jj); 1/m_eff = r^2 (M^-1)_jj.
    """
    c = solve(motion.factor, 0.0,
              1.0 if j == 0 else 0.0, 1.0 if j == 1 else 0.0, 1.0 if j == 2 else 0.0)
    r, c_jj = motion.lever[j], (c.haa, c.hfe, c.kfe)[j]
    scale = 1.0 / (r * c_jj)
    u = Coordinates(z=c.z * scale, haa=c.haa * scale, hfe=c.hfe * scale, kfe=c.kfe * scale)
    return u, r * r * c_jj


@kernel
def shear_follow(y, u, leg):
    """
    Return how far the sole's shear follows a displacement u of the leg  (L14).

    (dz'/dv) J u at the present normal force: J u where the foot sticks, the part of it across
    the friction force where it slides, 0 in the air.
    """
    m = terms_of(y, leg)
    ground, s = leg.ground, PROBE_SPEED
    w_x = m.j_x_hfe * u.hfe + m.j_x_kfe * u.kfe
    w_y = m.j_y_haa * u.haa + m.j_y_hfe * u.hfe + m.j_y_kfe * u.kfe
    _, _, _, x_before, y_before = contact(
        m.foot_z, m.foot_v_x, m.foot_v_y, m.foot_v_z, y.shear_x, y.shear_y, ground)
    _, _, _, x_after, y_after = contact(
        m.foot_z, m.foot_v_x + s * w_x, m.foot_v_y + s * w_y, m.foot_v_z, y.shear_x, y.shear_y,
        ground)
    return (x_after - x_before) / s, (y_after - y_before) / s


@kernel
def displaced(y, u, leg):
    """Return y displaced by `PROBE_DISPLACEMENT` along u, the shear with it  (L14)."""
    z_x, z_y = shear_follow(y, u, leg)
    return shifted(y, PROBE_DISPLACEMENT, ContinuousState(
        z=u.z, q_haa=u.haa, q_hfe=u.hfe, q_kfe=u.kfe,
        v_z=0.0, v_haa=0.0, v_hfe=0.0, v_kfe=0.0, shear_x=z_x, shear_y=z_y))


@kernel
def faster(y, u):
    """Return y with `PROBE_SPEED` more along u."""
    return shifted(y, PROBE_SPEED, ContinuousState(
        z=0.0, q_haa=0.0, q_hfe=0.0, q_kfe=0.0,
        v_z=u.z, v_haa=u.haa, v_hfe=u.hfe, v_kfe=u.kfe, shear_x=0.0, shear_y=0.0))


@kernel
def predicted(y, tick, f, slope, is_held, leg):
    """Return y a tick of ``tick`` seconds later under the assumed forces, a step a window."""
    h = tick / FORCE_WINDOWS
    for window in range(FORCE_WINDOWS):
        t = (window + 0.5) * h
        y = leg_step(y, h, (
            assumed_force(f[0], slope[0], t), assumed_force(f[1], slope[1], t),
            assumed_force(f[2], slope[2], t)), is_held, leg)
    return y


@kernel
def leg_ports(states, tick, rows, legs, ports):
    """
    Fill the `LOAD_PORT` of the three actuators for ``tick`` seconds  (L1, L12-L15).

    Pressures are left as they are.
    """
    state, leg = states[0], legs[0]
    y, is_held = continuous(state), state.is_held != 0.0
    f, slope = of_joints(state.force), of_joints(state.slope)
    motion, speeds = leg_motion(y, f, is_held, leg), joint_speeds(y)
    now = actuator_accelerations(y, f, is_held, leg)
    for j in range(3):
        port = ports[rows[j]]
        u, inverse_mass = response(j, motion)
        port.x0, port.v0 = motion.position[j], motion.lever[j] * speeds[j]
        port.a0 = now[j]
        port.inverse_mass = inverse_mass
        port.stiffness = resolved((now[j] - actuator_accelerations(
            displaced(y, u, leg), f, is_held, leg)[j]) / PROBE_DISPLACEMENT, tick)
        port.damping = (now[j] - actuator_accelerations(
            faster(y, u), f, is_held, leg)[j]) / PROBE_SPEED
    y = predicted(y, tick, f, slope, is_held, leg)
    end, (v_haa, v_hfe, v_kfe) = leg_motion(y, f, is_held, leg), joint_speeds(y)
    r_haa, r_hfe, r_kfe = end.lever
    match_ports(ports, rows, tick, state, end.position,
                (r_haa * v_haa, r_hfe * v_hfe, r_kfe * v_kfe))


@kernel
def fill_sample(y, f, is_held, leg, sample):
    """Fill one `LEG_SAMPLE`; ``f`` are the sensor forces."""
    motion = leg_motion(y, f, is_held, leg)
    angles, speeds = joint_angles(y), joint_speeds(y)
    for j in range(3):
        sample.position[j] = angles[j]
        sample.velocity[j] = speeds[j]
        sample.torque[j] = motion.lever[j] * f[j]
        sample.foot_force[j] = motion.foot_force[j]
        sample.foot_position[j] = motion.foot_position[j]
    sample.height, sample.height_velocity = y.z, y.v_z
    (p_x, p_y, p_z), (f_x, f_y, f_z) = motion.foot_position, motion.foot_force
    sample.foot_moment[0] = p_y * f_z - p_z * f_y + 0.0  # no -0.0 in flight
    sample.foot_moment[1] = p_z * f_x - p_x * f_z + 0.0
    sample.foot_moment[2] = p_x * f_y - p_y * f_x + 0.0


@kernel
def mean_forces(replies, rows, window):
    """Return the actuators' mean forces in one window of the tick."""
    return (replies[rows[0]].mean_forces[window], replies[rows[1]].mean_forces[window],
            replies[rows[2]].mean_forces[window])


@kernel
def leg_tick(states, step_ns, rows, legs, replies, samples):
    """
    Advance by one macro step under the mean forces of its windows; return `first_broken`.

    Each window is divided into equal Runge-Kutta steps of at most `SUBSTEP_NS`. A state that
    broke leaves forces and sample as they were.
    """
    state, leg = states[0], legs[0]
    y, is_held = continuous(state), state.is_held != 0.0
    window_ns = step_ns // FORCE_WINDOWS
    substeps = (window_ns + SUBSTEP_NS - 1) // SUBSTEP_NS
    h = window_ns / NS_PER_SECOND / substeps
    for window in range(FORCE_WINDOWS):
        f = mean_forces(replies, rows, window)
        for _ in range(substeps):
            y = leg_step(y, h, f, is_held, leg)
    keep_continuous(y, state)
    broken = first_broken(y)
    if broken < 0:
        keep_forces(state, step_ns / NS_PER_SECOND, rows, replies)
        end_force = (replies[rows[0]].force, replies[rows[1]].force, replies[rows[2]].force)
        fill_sample(y, end_force, is_held, leg, samples[0])
    return broken
