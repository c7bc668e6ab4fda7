"""
Forward dynamics of a tree of joints on a free or a fixed root, in world axes about O.

Twists are (velocity of the link's point at O, angular velocity). In one frame bodies add up as
mass, m c and moment of inertia, without transforms between links (L25, L26); the mass matrix is
factored along the branches of the tree (L27). After Featherstone, Rigid Body Dynamics Algorithms
(2008), chapters 5, 6 and 8. ``links`` and ``speeds`` are rows of `LINK` and `SPEED`.

A state y begins with place and quaternion of a free root, coordinates of the joints, speeds of the
root and of the joints: (v of O, angular velocity, q').
"""

from isa_ros.core.constants import STANDARD_GRAVITY
from isa_ros.core.elementary import cos, sin
from isa_ros.core.kernel import kernel
from isa_ros.surroundings.vectors import (
    cross, dot, minus, nine, plus, product, put, scaled, symmetric, three, turned, ZERO)


@kernel
def rotation(w, x, y, z):
    """Return the rotation of a quaternion of length 1  (L28)."""
    return (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y),
            2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x),
            2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y))


@kernel
def root_speeds(links, speeds):
    """Return how many speeds the root has: 6 or 0."""
    return len(speeds) - len(links) + 1


@kernel
def coordinates(links, speeds):
    """Return where the speeds begin in a state: 7 of a free root, and the joints."""
    return len(links) - 1 + (7 if len(speeds) >= len(links) else 0)


@kernel
def place_root(y, links, speeds):
    """Fill the motion of the root; gravity is its acceleration upwards  (L25)."""
    root, v = links[0], coordinates(links, speeds)
    put((0.0, 0.0, STANDARD_GRAVITY), root.acceleration)
    if root_speeds(links, speeds) == 0:
        put(nine(root.rotation), root.axes)
        put(three(root.place), root.origin)
    else:
        put(rotation(y[3], y[4], y[5], y[6]), root.axes)
        velocity, turning = (y[v], y[v + 1], y[v + 2]), (y[v + 3], y[v + 4], y[v + 5])
        put(velocity, root.velocity)
        put(turning, root.turning)
        put(minus(three(root.acceleration), cross(turning, velocity)), root.acceleration)


@kernel
def place_link(q, rate, link, parent, speed):
    """Fill the motion of a link from that of its parent and the coordinate of its joint  (L25)."""
    outer = nine(parent.axes)
    axes = product(outer, nine(link.rotation))
    origin = plus(three(parent.origin), turned(outer, three(link.place)))
    z = (axes[2], axes[5], axes[8])
    if link.is_sliding:
        origin = plus(origin, scaled(q, z))
        linear, angular = z, ZERO
    else:
        s, c = sin(q), cos(q)
        axes = (axes[0] * c + axes[1] * s, axes[1] * c - axes[0] * s, axes[2],
                axes[3] * c + axes[4] * s, axes[4] * c - axes[3] * s, axes[5],
                axes[6] * c + axes[7] * s, axes[7] * c - axes[6] * s, axes[8])
        linear, angular = cross(origin, z), z
    put(axes, link.axes)
    put(origin, link.origin)
    put(linear, speed.linear)
    put(angular, speed.angular)
    linear, angular = scaled(rate, linear), scaled(rate, angular)
    velocity, turning = plus(three(parent.velocity), linear), plus(three(parent.turning), angular)
    put(velocity, link.velocity)
    put(turning, link.turning)
    put(plus(three(parent.acceleration), plus(cross(turning, linear), cross(velocity, angular))),
        link.acceleration)
    put(plus(three(parent.turning_rate), cross(turning, angular)), link.turning_rate)


@kernel
def weigh(link):
    """Fill a link's own inertia and bias force about O  (L26)."""
    axes, m = nine(link.axes), link.mass
    c = plus(three(link.origin), turned(axes, three(link.com)))
    h = scaled(m, c)
    # R I R^T by its rows, and Steiner's share.
    i = link.inertia
    x = symmetric(i, (axes[0], axes[1], axes[2]))
    y = symmetric(i, (axes[3], axes[4], axes[5]))
    z = symmetric(i, (axes[6], axes[7], axes[8]))
    second = (dot(x, (axes[0], axes[1], axes[2])) + h[1] * c[1] + h[2] * c[2],
              dot(y, (axes[3], axes[4], axes[5])) + h[0] * c[0] + h[2] * c[2],
              dot(z, (axes[6], axes[7], axes[8])) + h[0] * c[0] + h[1] * c[1],
              dot(x, (axes[3], axes[4], axes[5])) - h[0] * c[1],
              dot(x, (axes[6], axes[7], axes[8])) - h[0] * c[2],
              dot(y, (axes[6], axes[7], axes[8])) - h[1] * c[2])
    v, w = three(link.velocity), three(link.turning)
    a, b = three(link.acceleration), three(link.turning_rate)
    momentum = plus(scaled(m, v), cross(w, h))
    spin = plus(symmetric(second, w), cross(h, v))
    link.sum_mass = m
    put(h, link.sum_first)
    put(second, link.sum_second)
    put(plus(plus(scaled(m, a), cross(b, h)), cross(w, momentum)), link.sum_force)
    put(plus(plus(symmetric(second, b), cross(h, a)), plus(cross(w, spin), cross(v, momentum))),
        link.sum_moment)


@kernel
def sweep(y, links, speeds):
    """Fill motion, own inertia and bias force of every link at a state  (L25, L26)."""
    place_root(y, links, speeds)
    weigh(links[0])
    v = coordinates(links, speeds)
    first, n = root_speeds(links, speeds), len(links) - 1
    for i in range(1, len(links)):
        d = first + i - 1
        place_link(y[v - n + i - 1], y[v + d], links[i], links[links[i].parent], speeds[d])
        weigh(links[i])


@kernel
def carry(link, parent):
    """Add what a link carries to what its parent carries  (L26)."""
    parent.sum_mass += link.sum_mass
    for k in range(3):
        parent.sum_first[k] += link.sum_first[k]
        parent.sum_force[k] += link.sum_force[k]
        parent.sum_moment[k] += link.sum_moment[k]
    for k in range(6):
        parent.sum_second[k] += link.sum_second[k]


@kernel
def assemble(links, speeds, mass, bias):
    """Fill the lower triangle of M along the branches, and the bias forces  (L26)."""
    first = root_speeds(links, speeds)
    for i in range(len(links) - 1, 0, -1):
        link, d = links[i], first + i - 1
        linear, angular = three(speeds[d].linear), three(speeds[d].angular)
        bias[d] = dot(linear, three(link.sum_force)) + dot(angular, three(link.sum_moment))
        h = three(link.sum_first)
        force = plus(scaled(link.sum_mass, linear), cross(angular, h))
        moment = plus(symmetric(link.sum_second, angular), cross(h, linear))
        j = d
        while j >= first:
            mass[d, j] = dot(three(speeds[j].linear), force) + dot(
                three(speeds[j].angular), moment)
            j = speeds[j].parent
        for k in range(first // 2):
            mass[d, k], mass[d, 3 + k] = force[k], moment[k]
        carry(link, links[link.parent])
    if first > 0:
        assemble_root(links[0], mass, bias)


@kernel
def assemble_root(root, mass, bias):
    """Fill the rows of a free root: m, m c x, and the moment of inertia of the whole tree."""
    m, h, i = root.sum_mass, root.sum_first, root.sum_second
    for k in range(3):
        bias[k], bias[3 + k] = root.sum_force[k], root.sum_moment[k]
        for j in range(k):
            mass[k, j] = 0.0
        mass[k, k], mass[3 + k, k], mass[3 + k, 3 + k] = m, 0.0, i[k]
    mass[3, 1], mass[3, 2] = -h[2], h[1]
    mass[4, 0], mass[4, 2], mass[4, 3] = h[2], -h[0], i[3]
    mass[5, 0], mass[5, 1], mass[5, 3], mass[5, 4] = -h[1], h[0], i[4], i[5]


@kernel
def hold(speeds, mass):
    """Turn the rows and columns of held speeds into those of a unit mass on its own."""
    for d in range(len(speeds)):
        if speeds[d].is_held:
            mass[d, d] = 1.0
        j = speeds[d].parent
        while j >= 0:
            if speeds[d].is_held or speeds[j].is_held:
                mass[d, j] = 0.0
            j = speeds[j].parent


@kernel
def factor(speeds, mass):
    """
    Factor M = L^T D L in place, only along the branches  (L27); the diagonal becomes 1/D.

    D > 0 because M is positive definite: every joint moves some mass.
    """
    for k in range(len(speeds) - 1, -1, -1):
        inverse = 1.0 / mass[k, k]
        mass[k, k] = inverse
        i = speeds[k].parent
        while i >= 0:
            share = mass[k, i] * inverse
            j = i
            while j >= 0:
                mass[i, j] -= share * mass[k, j]
                j = speeds[j].parent
            mass[k, i] = share
            i = speeds[i].parent


@kernel
def solve(speeds, mass, x):
    """Replace x by M^-1 x, with the M that `factor` left  (L27)."""
    for i in range(len(x) - 1, -1, -1):
        j, value = speeds[i].parent, x[i]
        while j >= 0:
            x[j] -= mass[i, j] * value
            j = speeds[j].parent
    for i in range(len(x)):
        value, j = x[i] * mass[i, i], speeds[i].parent
        while j >= 0:
            value -= mass[i, j] * x[j]
            j = speeds[j].parent
        x[i] = value
