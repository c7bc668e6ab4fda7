"""
The motion of a robot: accelerations under its actuators, rates of its state, Runge-Kutta steps.

A state y is a row of floats: place and quaternion of a free root (7), coordinates of the joints
(n); speeds of the root (6) and of the joints; the shear of each contact (2); work of the
actuators, energy given to the ground and work of forces from outside since t = 0.

Neglected: friction and stops of joints (the actuators have theirs), compliance of links.
"""

import math
from typing import Any, NamedTuple

from isa_ros.core.kernel import kernel
from isa_ros.surroundings.bodies.robot.reach import add_drives, push, reach, touch
from isa_ros.surroundings.bodies.robot.sheet import RobotSheet
from isa_ros.surroundings.bodies.robot.tree import (
    assemble, coordinates, factor, hold, root_speeds, solve, sweep)
from isa_ros.surroundings.vectors import dot, three

SMALLEST_SHEAR = 1e-100     # m: a shear that decays in the air would become denormal, and slow


class TreeRecords(NamedTuple):
    """Records of a robot, and its scratch; in kernels only."""

    links: Any
    speeds: Any
    drives: Any
    levers: Any
    contacts: Any
    mass: Any           # (d, d), factored
    bias: Any           # (d,)
    acceleration: Any   # (d,), of the speeds
    response: Any       # (d,), likewise to a force at one actuator
    forces: Any         # (k,), of the actuators
    ends: Any           # (2, k), places and speeds of the actuators after the tick
    ahead: Any          # (s,), a state, and below what a step needs
    rates: Any
    trial: Any
    total: Any


def state_names(sheet: RobotSheet) -> list[str]:
    """Return the names of the floats of a state."""
    joints = [joint.name for joint in sheet.joints]
    place, speed = [], []
    if sheet.is_free:
        place = [f'position[{k}]' for k in range(3)] + [f'orientation[{k}]' for k in range(4)]
        speed = [f'{name}[{k}]' for name in ('velocity', 'angular_velocity') for k in range(3)]
    return [*place, *(f'{name}_position' for name in joints),
            *speed, *(f'{name}_velocity' for name in joints),
            *(f'{own.name}_shear[{k}]' for own in sheet.contacts for k in range(2)),
            'drive_work', 'ground_energy', 'push_work']


def scratch_size(n_speeds: int, n_drives: int, n_state: int) -> int:
    """Return the number of floats that `tree_of` divides."""
    return n_speeds * (n_speeds + 3) + 3 * n_drives + 4 * n_state


@kernel
def tree_of(records, n_state):
    """Return the `TreeRecords` of `RobotRecords`, with arrays in the scratch."""
    scratch, d, k = records.scratch, len(records.speeds), len(records.drives)
    at = d * d
    forces = at + 3 * d
    state = forces + 3 * k
    return TreeRecords(
        links=records.links, speeds=records.speeds, drives=records.drives,
        levers=records.levers, contacts=records.contacts,
        mass=scratch[:at].reshape(d, d), bias=scratch[at:at + d],
        acceleration=scratch[at + d:at + 2 * d], response=scratch[at + 2 * d:forces],
        forces=scratch[forces:forces + k],
        ends=scratch[forces + k:state].reshape(2, k),
        ahead=scratch[state:state + n_state], rates=scratch[state + n_state:state + 2 * n_state],
        trial=scratch[state + 2 * n_state:state + 3 * n_state],
        total=scratch[state + 3 * n_state:state + 4 * n_state])


@kernel
def look(y, tree):
    """Fill motion, contacts and drives at a state, whatever the forces; return a push's power."""
    sweep(y, tree.links, tree.speeds)
    touch(y, tree.links, tree.speeds, tree.contacts)
    reach(y, tree.links, tree.speeds, tree.drives, tree.levers)
    return push(tree.links)


@kernel
def let_go(speeds, is_held, x):
    """Set generalised forces on held speeds to 0."""
    if is_held:
        for d in range(len(x)):
            if speeds[d].is_held:
                x[d] = 0.0


@kernel
def move(y, f, is_held, tree):
    """
    Fill the accelerations under actuator forces f, and the factor of the mass matrix  (L24).

    Return the power of the forces from outside, W.
    """
    pushed = look(y, tree)
    assemble(tree.links, tree.speeds, tree.mass, tree.bias)
    if is_held:
        hold(tree.speeds, tree.mass)
    factor(tree.speeds, tree.mass)
    a = tree.acceleration
    for d in range(len(a)):
        a[d] = -tree.bias[d]
    add_drives(f, tree.drives, tree.levers, a)
    let_go(tree.speeds, is_held, a)
    solve(tree.speeds, tree.mass, a)
    return pushed


@kernel
def turn_rate(y, v, out):
    """Fill the rate of the quaternion at y[3:7] under the angular velocity at y[v + 3]  (L28)."""
    w_x, w_y, w_z = y[v + 3], y[v + 4], y[v + 5]
    w, x, y_, z = y[3], y[4], y[5], y[6]
    out[3] = -0.5 * (w_x * x + w_y * y_ + w_z * z)
    out[4] = 0.5 * (w_x * w + w_y * z - w_z * y_)
    out[5] = 0.5 * (w_y * w + w_z * x - w_x * z)
    out[6] = 0.5 * (w_z * w + w_x * y_ - w_y * x)


@kernel
def fill_rates(y, f, is_held, tree):
    """Fill ``tree.rates``, the rate of change of a state  (L24, L28, L29)."""
    pushed = move(y, f, is_held, tree)
    out, v, n = tree.rates, coordinates(tree.links, tree.speeds), len(tree.links) - 1
    if root_speeds(tree.links, tree.speeds) > 0:
        for k in range(3):
            out[k] = y[v + k]
        turn_rate(y, v, out)
    d = len(tree.speeds)
    for i in range(n):
        out[v - n + i] = y[v + d - n + i]
    for i in range(d):
        out[v + i] = tree.acceleration[i]
    power = 0.0
    for i in range(len(tree.contacts)):
        own = tree.contacts[i]
        out[v + d + 2 * i], out[v + d + 2 * i + 1] = own.shear_rate[0], own.shear_rate[1]
        power -= dot(three(own.force), three(own.velocity))
    work = 0.0
    for j in range(len(tree.drives)):
        work += f[j] * tree.drives[j].velocity
    out[len(y) - 3], out[len(y) - 2], out[len(y) - 1] = work, power, pushed


@kernel
def tidy(y, tree):
    """Bring the quaternion to length 1, and shears that have decayed to 0."""
    if root_speeds(tree.links, tree.speeds) > 0:
        scale = 1.0 / math.sqrt(y[3] * y[3] + y[4] * y[4] + y[5] * y[5] + y[6] * y[6])
        for i in range(3, 7):
            y[i] *= scale
    z = coordinates(tree.links, tree.speeds) + len(tree.speeds)
    for i in range(z, z + 2 * len(tree.contacts)):
        if abs(y[i]) < SMALLEST_SHEAR:
            y[i] = 0.0


@kernel
def robot_step(y, h, f, is_held, tree):
    """Advance y by one classical Runge-Kutta step under constant forces."""
    trial, total, rates = tree.trial, tree.total, tree.rates
    for i in range(len(y)):
        trial[i], total[i] = y[i], 0.0
    for stage in range(4):
        fill_rates(trial, f, is_held, tree)
        weight = 1.0 if stage in (0, 3) else 2.0
        ahead = 0.5 * h if stage < 2 else h
        for i in range(len(y)):
            total[i] += weight * rates[i]
            trial[i] = y[i] + ahead * rates[i]
    for i in range(len(y)):
        y[i] += h / 6.0 * total[i]
    tidy(y, tree)
