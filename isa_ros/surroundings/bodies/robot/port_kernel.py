"""
Exchange of a robot with its actuators: load ports down, a tick under their forces.

A ``state`` is a row of floats: y of `motion`, the `KeptForces` of the k actuators, and 1.0 while
the robot is held. ``rows`` (k,) are the places of the actuators in ``ports`` and ``replies``. L13
to L15 are those of the leg for any tree; L32 takes the place of L16.
"""

import math

from isa_ros.core.kernel import kernel
from isa_ros.core.timebase import FORCE_WINDOWS, NS_PER_SECOND
from isa_ros.surroundings.bodies.robot.kept_forces import (
    FIELDS, keep_rigid_forces, kept_part)
from isa_ros.surroundings.bodies.robot.motion import (
    let_go, look, move, robot_step, tree_of)
from isa_ros.surroundings.bodies.robot.reach import along, motion_by
from isa_ros.surroundings.bodies.robot.tree import coordinates, root_speeds, solve
from isa_ros.surroundings.ground import contact
from isa_ros.surroundings.port import assumed_force, match_ports
from isa_ros.surroundings.vectors import dot, first_broken, plus, scaled, three, ZERO

SUBSTEP_NS = 200_000        # longest Runge-Kutta step of a robot, a force window of a tick of 1 ms
PROBE_DISPLACEMENT = 1e-7   # m | rad: 1e-3 of the smallest depth at which the ground matters
PROBE_SPEED = 1e-5          # m/s | rad/s: equally small against impact speeds
DEAD_CENTRE = 1e-12         # 1/kg | 1/(kg m2): below it an actuator does not move the robot


@kernel
def motion_part(state, k):
    """Return the view of y in a state."""
    return state[:len(state) - FIELDS * k - 1]


@kernel
def fill_response(drive, is_held, tree):
    """Fill u of `response` and return 1/m_eff = J M^-1 J^T, u = M^-1 J^T m_eff  (L13)."""
    u = tree.response
    for d in range(len(u)):
        u[d] = 0.0
    for e in range(drive.first, drive.end):
        u[tree.levers[e].speed] += tree.levers[e].lever
    let_go(tree.speeds, is_held, u)
    solve(tree.speeds, tree.mass, u)
    inverse_mass = along(drive, tree.levers, u)
    scale = 1.0 / inverse_mass if inverse_mass > DEAD_CENTRE else 0.0
    for d in range(len(u)):
        u[d] *= scale
    return inverse_mass


@kernel
def displaced_by(own, tree):
    """Return how a contact moves by the response u, m per unit of the actuator."""
    place, w = three(own.position), ZERO
    d = root_speeds(tree.links, tree.speeds) + own.link - 1
    while d >= 0:
        w = plus(w, scaled(tree.response[d], motion_by(tree.speeds[d], place)))
        d = tree.speeds[d].parent
    return w


@kernel
def contact_response(y, tree):
    """
    Return minus the work of the ground's forces along u, by a displacement and by a speed u.

    The shear follows a displacement as in the leg  (L14).
    """
    k, c = 0.0, 0.0
    z = coordinates(tree.links, tree.speeds) + len(tree.speeds)
    up = y[2] if root_speeds(tree.links, tree.speeds) > 0 else 0.0
    for i in range(len(tree.contacts)):
        own = tree.contacts[i]
        if own.force[2] > 0.0:
            w, force, (v_x, v_y, v_z) = displaced_by(own, tree), three(own.force), three(
                own.velocity)
            z_x, z_y, height, ground = (
                y[z + 2 * i], y[z + 2 * i + 1], own.position[2] + up, own.ground)
            s = PROBE_SPEED
            _, _, _, x, y_ = contact(
                height, v_x + s * w[0], v_y + s * w[1], v_z, z_x, z_y, ground)
            follow = PROBE_DISPLACEMENT / s
            f_x, f_y, f_z, _, _ = contact(
                height + PROBE_DISPLACEMENT * w[2], v_x, v_y, v_z,
                z_x + follow * (x - own.shear_rate[0]), z_y + follow * (y_ - own.shear_rate[1]),
                ground)
            k -= (dot((f_x, f_y, f_z), w) - dot(force, w)) / PROBE_DISPLACEMENT
            f_x, f_y, f_z, _, _ = contact(
                height, v_x + s * w[0], v_y + s * w[1], v_z + s * w[2], z_x, z_y, ground)
            c -= (dot((f_x, f_y, f_z), w) - dot(force, w)) / s
    return k, c


@kernel
def bounded(value, bound):
    """Return a value cut to what a tick resolves: per metre of a dead centre it has no bounds."""
    return min(max(value, -bound), bound)


@kernel
def robot_instant(state, forces, records):
    """Fill the scratch with the motion of a state under sensor forces (k,)."""
    y = motion_part(state, len(records.drives))
    move(y, forces, state[len(state) - 1] != 0.0, tree_of(records, len(y)))


@kernel
def robot_ports(state, tick, rows, records, ports):
    """
    Fill the `LOAD_PORT` of all actuators for ``tick`` seconds  (L1, L13-L15).

    k and d are the response of the ground. Pressures are left as they are.
    """
    drives, levers, n = records.drives, records.levers, len(records.drives)
    y, kept, is_held = motion_part(state, n), kept_part(state, n), state[len(state) - 1] != 0.0
    tree = tree_of(records, len(y))
    move(y, kept.force, is_held, tree)
    for j in range(n):
        port, drive = ports[rows[j]], drives[j]
        port.x0, port.v0 = drive.position, drive.velocity
        port.a0 = along(drive, levers, tree.acceleration) + drive.curvature
        inverse_mass = fill_response(drive, is_held, tree)
        k, c = contact_response(y, tree)
        port.inverse_mass = drive.inverse_mass = inverse_mass
        port.stiffness = bounded(inverse_mass * k, math.pi * math.pi / (tick * tick))
        port.damping = bounded(inverse_mass * c, 1.0 / tick)
    predict(y, tick, kept, is_held, tree)
    match_ports(ports, rows, tick, kept, tree.ends[0], tree.ends[1])


@kernel
def predict(y, tick, kept, is_held, tree):
    """Fill places and speeds of the actuators a tick later under the assumed forces  (L15)."""
    h, ahead, forces = tick / FORCE_WINDOWS, tree.ahead, tree.forces
    for i in range(len(y)):
        ahead[i] = y[i]
    for window in range(FORCE_WINDOWS):
        for j in range(len(forces)):
            forces[j] = assumed_force(kept.force[j], kept.slope[j], (window + 0.5) * h)
        robot_step(ahead, h, forces, is_held, tree)
    look(ahead, tree)
    for j in range(len(forces)):
        tree.ends[0, j], tree.ends[1, j] = tree.drives[j].position, tree.drives[j].velocity


@kernel
def robot_tick(state, step_ns, rows, records, replies):
    """
    Advance by one tick under the mean forces of its windows; return `first_broken`.

    Each window is divided into equal Runge-Kutta steps of at most `SUBSTEP_NS`. The scratch has
    the motion at its end under the last sensor forces. A state that broke keeps its old forces.
    """
    n = len(records.drives)
    y, is_held = motion_part(state, n), state[len(state) - 1] != 0.0
    tree = tree_of(records, len(y))
    window_ns = step_ns // FORCE_WINDOWS
    substeps = (window_ns + SUBSTEP_NS - 1) // SUBSTEP_NS
    h = window_ns / NS_PER_SECOND / substeps
    for window in range(FORCE_WINDOWS):
        for j in range(n):
            tree.forces[j] = replies[rows[j]].mean_forces[window]
        for _ in range(substeps):
            robot_step(y, h, tree.forces, is_held, tree)
    broken = first_broken(y)
    if broken < 0:
        for j in range(n):
            tree.forces[j] = replies[rows[j]].force
        move(y, tree.forces, is_held, tree)
        keep_rigid_forces(
            kept_part(state, n), step_ns / NS_PER_SECOND, rows, tree.drives, replies)
    return broken
