"""
What the world does to a robot: the ground at its contacts, the actuators at their joints.

Records as in `isa_ros.surroundings.bodies.robot.records`, filled for the state that
`isa_ros.surroundings.bodies.robot.tree.sweep` was called with last.
"""

import math

from isa_ros.core.kernel import kernel
from isa_ros.surroundings.bodies.robot.tree import coordinates, root_speeds
from isa_ros.surroundings.ground import contact
from isa_ros.surroundings.linkage import actuator_coordinate
from isa_ros.surroundings.vectors import cross, dot, minus, plus, put, scaled, three, turned


@kernel
def place_of(link, point):
    """Return where a point of a link is, from O."""
    return plus(three(link.origin), turned(link.axes, three(point)))


@kernel
def velocity_of(link, place):
    """Return the velocity of a link at a place from O."""
    return plus(three(link.velocity), cross(three(link.turning), place))


@kernel
def acceleration_of(link, place):
    """Return the acceleration of a link's point at a place from O, as far as `sweep` has it."""
    return plus(plus(three(link.acceleration), cross(three(link.turning_rate), place)),
                cross(three(link.turning), velocity_of(link, place)))


@kernel
def motion_by(speed, place):
    """Return the velocity at a place from O of what a joint carries, by a unit of its speed."""
    return plus(three(speed.linear), cross(three(speed.angular), place))


@kernel
def touch(y, links, speeds, contacts):
    """Fill the contacts, and take the ground's forces off the links' bias forces  (L9-L11)."""
    z = coordinates(links, speeds) + len(speeds)
    height = y[2] if root_speeds(links, speeds) > 0 else 0.0
    for i in range(len(contacts)):
        own = contacts[i]
        link = links[own.link]
        place = place_of(link, own.point)
        velocity = velocity_of(link, place)
        f_x, f_y, f_z, rate_x, rate_y = contact(
            place[2] + height, velocity[0], velocity[1], velocity[2],
            y[z + 2 * i], y[z + 2 * i + 1], own.ground)
        force = (f_x, f_y, f_z)
        put(place, own.position)
        put(velocity, own.velocity)
        put(force, own.force)
        put((rate_x, rate_y), own.shear_rate)
        if f_z > 0.0:
            moment = cross(place, force)
            for k in range(3):
                link.sum_force[k] -= force[k]
                link.sum_moment[k] -= moment[k]


@kernel
def push(links):
    """Take the forces from outside off the links' bias forces, and return their power, W."""
    power = 0.0
    for i in range(len(links)):
        link = links[i]
        if link.is_pushed:
            place, force, moment = (
                three(link.origin), three(link.push_force), three(link.push_moment))
            power += dot(force, velocity_of(link, place)) + dot(moment, three(link.turning))
            moment = plus(moment, cross(place, force))
            for k in range(3):
                link.sum_force[k] -= force[k]
                link.sum_moment[k] -= moment[k]
    return power


@kernel
def pull_between(drive, links, speeds, levers):
    """
    Fill a cylinder between two points p_a and p_b of two links  (L23).

    d = p_b - p_a, L = |d|, n = d/L: x = L - L_0, dx/dq = n . (dp_b/dq - dp_a/dq),
    x' = n . d', J' q' = n . d'' + (d' . d' - x'^2)/L with the d'' that q'' = 0 leaves.
    L > 0: the points are apart over the whole range of the joints.
    """
    a, b = links[drive.link_a], links[drive.link_b]
    p_a, p_b = place_of(a, drive.point_a), place_of(b, drive.point_b)
    apart = minus(p_b, p_a)
    length = math.sqrt(dot(apart, apart))
    n = scaled(1.0 / length, apart)
    velocity = minus(velocity_of(b, p_b), velocity_of(a, p_a))
    bias = minus(acceleration_of(b, p_b), acceleration_of(a, p_a))
    drive.position, drive.velocity = length - drive.retracted_length, dot(n, velocity)
    drive.curvature = dot(n, bias) + (
        dot(velocity, velocity) - drive.velocity * drive.velocity) / length
    for e in range(drive.first, drive.end):
        own = levers[e]
        place = p_b if own.sense > 0.0 else p_a
        own.lever = own.sense * dot(n, motion_by(speeds[own.speed], place))


@kernel
def reach(y, links, speeds, drives, levers):
    """Fill coordinate, speed and levers of every drive  (L2, L23)."""
    v = coordinates(links, speeds)
    for j in range(len(drives)):
        drive = drives[j]
        if drive.is_between:
            pull_between(drive, links, speeds, levers)
        else:
            own = levers[drive.first]
            q = v + own.speed - len(speeds)
            rate = y[v + own.speed]
            drive.position, own.lever, bend = actuator_coordinate(y[q], drive.linkage)
            drive.velocity, drive.curvature = own.lever * rate, bend * rate * rate


@kernel
def add_drives(f, drives, levers, x):
    """Add J^T f of the actuators' forces to generalised forces x  (L2)."""
    for j in range(len(drives)):
        for e in range(drives[j].first, drives[j].end):
            x[levers[e].speed] += levers[e].lever * f[j]


@kernel
def along(drive, levers, x):
    """Return J x of one drive, without its curvature."""
    total = 0.0
    for e in range(drive.first, drive.end):
        total += levers[e].lever * x[levers[e].speed]
    return total
