"""
The sample of a robot and the readings of its inertial units, from the scratch of an instant.

`isa_ros.surroundings.bodies.robot.motion.move` was called for the same state before.
"""

import math

from isa_ros.core.constants import STANDARD_GRAVITY
from isa_ros.core.kernel import kernel
from isa_ros.core.noise import normal
from isa_ros.surroundings.bodies.robot.motion import tree_of
from isa_ros.surroundings.bodies.robot.reach import place_of, velocity_of
from isa_ros.surroundings.bodies.robot.tree import coordinates, root_speeds
from isa_ros.surroundings.vectors import (
    cross, dot, nine, plus, product, put, scaled, symmetric, three, turned_back)


@kernel
def link_energies(link, height):
    """Return kinetic and potential energy of a link, J; the root is at ``height``  (L30)."""
    axes, m = nine(link.axes), link.mass
    place = place_of(link, link.com)
    v, spin = velocity_of(link, place), turned_back(axes, three(link.turning))
    return (0.5 * (m * dot(v, v) + dot(spin, symmetric(link.inertia, spin))),
            m * STANDARD_GRAVITY * (place[2] + height))


@kernel
def stored_in(own, height, shear_x, shear_y):
    """Return the energy stored in a contact's ground and sole, 2/5 k d^2.5 + k_t z^2/2  (L30)."""
    ground, depth = own.ground, max(0.0, -height)
    return (0.4 * ground.stiffness * depth * depth * math.sqrt(depth)
            + 0.5 * ground.tangential_stiffness * (shear_x * shear_x + shear_y * shear_y))


@kernel
def fill_sample(y, f, records, out):
    """Fill the floats of a sample, in the order of its fields; ``f`` are the sensor forces."""
    links, speeds, drives, levers, contacts, _ = records
    v, n, d = coordinates(links, speeds), len(links) - 1, len(speeds)
    is_free = root_speeds(links, speeds) > 0
    at = 0
    if is_free:
        for i in range(7):
            out[i] = y[i]
        for i in range(6):
            out[7 + i] = y[v + i]
        axes = nine(links[0].axes)
        put(turned_back(axes, three(out[7:10])), out[13:16])
        put(turned_back(axes, three(out[10:13])), out[16:19])
        at = 19
    torques = at + 2
    for i in range(n):
        out[at], out[at + 1], out[at + 2] = y[v - n + i], y[v + d - n + i], 0.0
        at += 3
    for j in range(len(drives)):
        for e in range(drives[j].first, drives[j].end):
            out[at] = levers[e].lever
            out[torques + 3 * (levers[e].speed - d + n)] += levers[e].lever * f[j]
            at += 1
    height, elastic = y[2] if is_free else 0.0, 0.0
    z = v + d
    for i in range(len(contacts)):
        own = contacts[i]
        for k in range(3):
            out[at + k] = own.force[k] + 0.0    # no -0.0 in the air
            out[at + 3 + k] = own.position[k] + (y[k] if is_free else 0.0)
        out[at + 6] = 1.0 if own.force[2] > 0.0 else 0.0
        elastic += stored_in(own, own.position[2] + height, y[z + 2 * i], y[z + 2 * i + 1])
        at += 7
        if own.is_foot:
            axes = product(nine(links[own.link].axes), nine(own.rotation))
            force = turned_back(axes, three(own.force))
            put(force, out[at:at + 3])
            put(cross(three(own.arm), force), out[at + 3:at + 6])
            for k in range(6):
                out[at + k] += 0.0
            at += 6
    kinetic, potential = 0.0, 0.0
    for i in range(len(links)):
        moving, lifted = link_energies(links[i], height)
        kinetic += moving
        potential += lifted
    out[at], out[at + 1], out[at + 2] = kinetic, potential, elastic
    out[at + 3], out[at + 4] = y[len(y) - 2] - elastic, y[len(y) - 3]
    out[at + 5] = y[len(y) - 1]


@kernel
def read_unit(step, y, records, unit, reading):
    """
    Fill the six numbers of a reading at plant step ``step``, in the unit's axes  (L31).

    Specific force f = a - g and angular velocity, a with the accelerations of `move`.
    """
    tree = tree_of(records, len(y))
    link, speeds = tree.links[unit.link], tree.speeds
    place = place_of(link, unit.place)
    linear, angular = three(link.acceleration), three(link.turning_rate)
    d = root_speeds(tree.links, speeds) + unit.link - 1
    while d >= 0:
        linear = plus(linear, scaled(tree.acceleration[d], three(speeds[d].linear)))
        angular = plus(angular, scaled(tree.acceleration[d], three(speeds[d].angular)))
        d = speeds[d].parent
    turning = three(link.turning)
    f = plus(plus(linear, cross(angular, place)), cross(turning, velocity_of(link, place)))
    axes = product(nine(link.axes), nine(unit.rotation))
    put(turned_back(axes, f), reading[:3])
    put(turned_back(axes, turning), reading[3:])
    for k in range(6):
        reading[k] += unit.bias[k]
        if unit.sigma[k] != 0.0:
            reading[k] += unit.sigma[k] * normal(unit.key, step, k)
