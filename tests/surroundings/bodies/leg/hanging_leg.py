"""A hanging leg, constant forces on it, and its state, energy and mass matrix."""

import math

from isa_ros.core.record import rows_of
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY
from isa_ros.surroundings.bodies.leg import motion as kernels
from isa_ros.surroundings.bodies.leg.leg import Leg, LegPose
from isa_ros.surroundings.bodies.leg.sheet import leg_record, STANDARD_GRAVITY
import numpy as np
from tests.legs import leg_sheet

MS = 1_000_000
SHEET = leg_sheet()
POSE = LegPose(haa=math.radians(13.0), hfe=math.radians(48.0), kfe=math.radians(-95.0),
               foot_height=0.1)
CONSTANTS = leg_record(SHEET)[0]
BODY = CONSTANTS.body


def hanging(step_ns=MS, pose=POSE):
    """Return the shipped leg."""
    return Leg(SHEET, pose, step_ns)


def constant(forces):
    """Return replies of actuators that push with constant forces."""
    replies = rows_of(3, LOAD_REPLY)
    replies['mean_forces'] = np.array(forces)[:, None]
    replies['force'] = forces
    return replies


def state(leg):
    """Return the leg's `LEG_STATE`."""
    return np.frombuffer(leg.snapshot(), kernels.LEG_STATE, 1, 8)[0]


def continuous(leg):
    """Return the leg's `ContinuousState`."""
    return kernels.continuous(state(leg))


def mass_matrix(y):
    """Return M at a state, shape (4, 4)."""
    terms = kernels.terms_of(y, CONSTANTS)
    names = ('z', 'haa', 'hfe', 'kfe')
    m = np.zeros((4, 4))
    for i, row in enumerate(names):
        for j, column in enumerate(names[i:], i):
            m[i, j] = m[j, i] = getattr(terms, f'm_{row}_{column}')
    return m


def speeds(y):
    """Return the speeds of a state's coordinates, (4,)."""
    return np.array((y.v_z, y.v_haa, y.v_hfe, y.v_kfe))


def energy(y):
    """Return kinetic plus potential energy, J."""
    v = speeds(y)
    return 0.5 * v @ mass_matrix(y) @ v + potential(y)


def potential(y):
    """Return m g times the height of the whole leg's centre of mass, J, from the frames."""
    b = BODY
    s1, c1 = math.sin(y.q_haa), math.cos(y.q_haa)
    s2, c2 = math.sin(y.q_hfe), math.cos(y.q_hfe)
    s3, c3 = math.sin(y.q_hfe + y.q_kfe), math.cos(y.q_hfe + y.q_kfe)

    def in_leg_plane(down, left):
        return -c1 * down - s1 * left

    hip = -b['c_hip_x'] * c1 + b['c_hip_y'] * s1
    thigh = in_leg_plane(b['c_thigh_x'] * c2 - b['c_thigh_y'] * s2,
                         b['l_hip'] + b['c_thigh_z'])
    calf = in_leg_plane(
        b['l_thigh'] * c2 + b['c_calf_x'] * c3 - b['c_calf_y'] * s3,
        b['l_hip'] + b['c_calf_z'])
    mass = b['m_slider'] + b['m_hip'] + b['m_thigh'] + b['m_calf']
    return STANDARD_GRAVITY * (
        mass * y.z + b['m_hip'] * hip + b['m_thigh'] * thigh + b['m_calf'] * calf)


def moving_leg(step_ns=MS, release=True, ticks=160):
    """Return a leg that has hit the ground and moves on it."""
    leg = hanging(step_ns)
    if release:
        leg.release()
    start = np.array(leg.actuator_positions)
    hold = np.array(leg.actuator_forces)
    ports = np.zeros(3, LOAD_PORT)
    for _ in range(ticks):
        leg.ports(ports)
        leg.advance(constant(
            hold + (300.0, 1e5, 1e5) * (start - ports['x0']) - (20.0, 4e3, 4e3) * ports['v0']))
    return leg
