"""
The port's copy of the leg against the leg, through ticks in which the foot hits the ground.

The forces of the actuators are those that the port assumes, a line over the tick; the leg is
integrated in steps of a thousandth of it.
"""

from functools import cache
import math

from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY
from isa_ros.surroundings.bodies.leg.leg import Leg, LegPose
from isa_ros.surroundings.bodies.leg.motion import (
    continuous, joint_speeds, leg_motion, LEG_STATE, leg_step)
from isa_ros.surroundings.bodies.leg.sheet import JOINTS, leg_record
import numpy as np
import pytest
from tests.legs import leg_sheet
from tests.surroundings.port_copy import end_of_copy

MS = 1_000_000
TICK, STEPS = 1e-3, 50  # s, plant steps of it
TIME_BYTES = 8          # a snapshot begins with the time
SHEET = leg_sheet()
CONSTANTS = leg_record(SHEET)[0]


@cache
def landing(later: int) -> tuple[Leg, np.ndarray]:
    """Return a leg ``later`` ticks after the one before it touches down, and its ports."""
    leg = Leg(SHEET, LegPose(haa=math.radians(13.0), hfe=math.radians(48.0),
                             kfe=math.radians(-95.0), foot_height=0.0197), MS)
    leg.release()
    start, hold = np.array(leg.actuator_positions), np.array(leg.actuator_forces)
    ports, replies = np.zeros(3, LOAD_PORT), np.zeros(3, LOAD_REPLY)
    states = []
    while len(states) < 2 or leg.sample[0]['foot_position'][2] > 0.0 or later > 0:
        if len(states) > 1 and leg.sample[0]['foot_position'][2] < 0.0:
            later -= 1
        states.append(leg.snapshot())
        leg.ports(ports)
        force = (hold + (300.0, 1e5, 1e5) * (start - ports['x0'])
                 - np.array((20.0, 4e3, 4e3)) * ports['v0'])
        replies['mean_forces'], replies['force'] = force[:, None], force
        leg.advance(replies)
    leg.restore(states[-1])
    leg.ports(ports)
    return leg, ports


def of_the_leg(leg: Leg) -> tuple[np.ndarray, np.ndarray, float]:
    """Return places and speeds of the actuators after the tick, and the largest foot force."""
    state = np.frombuffer(leg.snapshot(), LEG_STATE, 1, TIME_BYTES)[0]
    y, normal = continuous(state), 0.0
    for i in range(1000):
        force = tuple(state['force'] + state['slope'] * (i + 0.5) * TICK / 1000)
        y = leg_step(y, TICK / 1000, force, leg.is_held, CONSTANTS)
        normal = max(normal, leg_motion(y, force, leg.is_held, CONSTANTS).foot_force[2])
    end = leg_motion(y, force, leg.is_held, CONSTANTS)
    return np.array(end.position), np.array(end.lever) * joint_speeds(y), normal


def of_the_copy(leg: Leg, port: np.void, j: int) -> tuple[float, float]:
    """Return place and speed of a port's copy after the tick, as an actuator integrates it."""
    state = np.frombuffer(leg.snapshot(), LEG_STATE, 1, TIME_BYTES)[0]
    return end_of_copy(port, lambda t: state['force'][j] + t * state['slope'][j], TICK, STEPS)


@pytest.mark.parametrize('j', range(3), ids=JOINTS)
@pytest.mark.parametrize('later', [0, 1])
def test_the_copy_ends_a_tick_where_the_leg_does(later: int, j: int) -> None:
    """
    L15, in the tick of the touch-down and in the contact.

    Compared with what constant accelerations would miss, in place and in speed. In the window of
    the touch-down a Runge-Kutta step sees the force at its middle and its end only: of the four
    windows of contact that follow it may miss a part in twenty.
    """
    leg, ports = landing(later)
    place, speed, normal = of_the_leg(leg)
    x, v = of_the_copy(leg, ports[j], j)
    missed = place[j] - ports['x0'][j] - TICK * (ports['v0'][j] + 0.5 * TICK * ports['a0'][j])
    missed_speed = speed[j] - ports['v0'][j] - TICK * ports['a0'][j]
    assert normal > 1.0
    assert abs(x - place[j]) < 0.05 * abs(missed)
    assert abs(v - speed[j]) < 0.05 * abs(missed_speed)


def test_one_of_the_ticks_begins_in_the_air() -> None:
    """The port knows of the ground before the foot has reached it."""
    assert landing(0)[0].sample[0]['foot_position'][2] > 0.0
    assert landing(1)[0].sample[0]['foot_position'][2] < 0.0
