"""
Inertial measurement units on the links of a leg.

A unit reads, in the axes of its link, the specific force f = R^T (a - g) at its place (m/s2) and
the angular velocity w (rad/s): at rest f points up with 9.80665 m/s2, in free fall it is 0. From
link to link, with parent's values turned into the own axes  (L22)

    w = w_p + q' e_z
    w' = w_p' + q'' e_z + w_p x q' e_z
    f = f_p + w_p' x o + w_p x (w_p x o)

where o is the joint's place on the parent, and the slider's are w = 0, f = (0, 0, z'' + g). The
accelerations are those of the leg under the actuators' forces and the ground at that instant
(L6). Frames as in scripts/generate_leg.py, and in the URDF.

Each axis has a constant error and white noise at its readings. Neglected: ranges, resolution,
bandwidth and misalignment.
"""

from isa_ros.core.elementary import cos, sin
from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.noise import normal
from isa_ros.core.parameter import choice
from isa_ros.core.record import record
from isa_ros.core.units import MILLI
from isa_ros.surroundings.bodies.leg.motion import continuous, leg_motion
from isa_ros.surroundings.inertial_unit import AXES, InertialUnitSheet
from isa_ros.surroundings.vectors import cross
import numpy as np

LINKS = ('slider_link', 'hip', 'thigh', 'calf')
"""Links of the URDF, from the rail to the foot."""


@frozen(kw_only=True)
class Imu(InertialUnitSheet):
    """An inertial measurement unit on a link of the leg."""

    link: str = choice('the link that it is fixed to; its axes are those of the link', *LINKS)


IMU = np.dtype([
    ('link', 'i8'),                     # index in LINKS
    ('place', 'f8', (3,)),              # m, link axes
    ('sigma', 'f8', (AXES,)),           # m/s2, rad/s
    ('bias', 'f8', (AXES,)),            # m/s2, rad/s
    ('key', 'u8'),                      # of its noise
])
"""Every constant of one unit, SI."""


def imu_record(sheet: Imu, key: int) -> np.record:
    """Return the `IMU` record of a sheet; ``key`` is that of its noise."""
    return record(
        IMU, link=LINKS.index(sheet.link), key=key,
        place=[sheet.x_mm * MILLI, sheet.y_mm * MILLI, sheet.z_mm * MILLI],
        sigma=3 * [sheet.accelerometer_sigma] + 3 * [sheet.gyro_sigma],
        bias=3 * [sheet.accelerometer_bias] + 3 * [sheet.gyro_bias])


@kernel
def carried(f, w, w_rate, o):
    """Return the specific force at a place o from the one at the origin of a turning link."""
    turned, spun = cross(w_rate, o), cross(w, cross(w, o))
    return (f[0] + turned[0] + spun[0], f[1] + turned[1] + spun[1], f[2] + turned[2] + spun[2])


@kernel
def about_z(s, c, v):
    """Return a vector in axes turned about z by the angle of sine s and cosine c."""
    return (c * v[0] + s * v[1], c * v[1] - s * v[0], v[2])


@kernel
def hinged(f, w, w_rate, q, v, a):
    """
    Return (f, w, w') of a link about the z of its parent's axes  (L22).

    q, v and a are angle, speed and acceleration of the joint.
    """
    s, c = sin(q), cos(q)
    f, w, w_rate = about_z(s, c, f), about_z(s, c, w), about_z(s, c, w_rate)
    across = cross(w, (0.0, 0.0, v))
    return (f, (w[0], w[1], w[2] + v),
            (w_rate[0] + across[0], w_rate[1] + across[1], w_rate[2] + a))


@kernel
def in_hip_axes(v):
    """Return a vector of the slider in the hip's axes at zero angle: down, right, backward."""
    return (-v[2], -v[1], -v[0])


@kernel
def in_thigh_axes(v):
    """Return a vector of the hip in the thigh's axes at zero angle: down, backward, left."""
    return (v[0], v[2], -v[1])


@kernel
def link_motion(link, y, a, body):
    """
    Return (f, w, w') of a link at its joint, in its axes  (L22).

    ``y`` is a `ContinuousState`, ``a`` its accelerations, `Coordinates`.
    """
    zero = (0.0, 0.0, 0.0)
    f, w, w_rate = (0.0, 0.0, a.z + body.gravity), zero, zero
    if link >= 1:
        f, w, w_rate = hinged(in_hip_axes(f), w, w_rate, y.q_haa, y.v_haa, a.haa)
    if link >= 2:
        f = carried(f, w, w_rate, (body.d_hip, -body.l_hip, 0.0))
        f, w, w_rate = hinged(
            in_thigh_axes(f), in_thigh_axes(w), in_thigh_axes(w_rate), y.q_hfe, y.v_hfe, a.hfe)
    if link >= 3:
        f = carried(f, w, w_rate, (body.l_thigh, 0.0, 0.0))
        f, w, w_rate = hinged(f, w, w_rate, y.q_kfe, y.v_kfe, a.kfe)
    return f, w, w_rate


@kernel
def read_imu(step, states, forces, legs, imu, reading):
    """
    Fill the six numbers of one reading at plant step ``step``.

    ``states`` and ``legs`` are one `LEG_STATE` and `LEG`, (1,); ``forces`` (N | Nm) are those of
    the three actuators at that instant.
    """
    state, leg = states[0], legs[0]
    y = continuous(state)
    motion = leg_motion(y, forces, state.is_held != 0.0, leg)
    f, w, w_rate = link_motion(imu.link, y, motion.acceleration, leg.body)
    f = carried(f, w, w_rate, (imu.place[0], imu.place[1], imu.place[2]))
    for k in range(3):
        reading[k], reading[3 + k] = f[k], w[k]
    for k in range(AXES):
        reading[k] += imu.bias[k]
        if imu.sigma[k] != 0.0:
            reading[k] += imu.sigma[k] * normal(imu.key, step, k)
