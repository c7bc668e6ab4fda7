"""Vectors (3,) and matrices (9,), row by row, as tuples in kernels, and their products."""

import math

from isa_ros.core.kernel import kernel

ZERO = (0.0, 0.0, 0.0)


@kernel
def three(values):
    """Return the vector in an array of three."""
    return values[0], values[1], values[2]


@kernel
def nine(values):
    """Return the matrix in an array of nine."""
    return (values[0], values[1], values[2], values[3], values[4], values[5], values[6],
            values[7], values[8])


@kernel
def put(values, to):
    """Write a vector or a matrix into an array."""
    for i in range(len(values)):
        to[i] = values[i]


@kernel
def plus(a, b):
    """Return a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@kernel
def minus(a, b):
    """Return a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@kernel
def scaled(factor, a):
    """Return the product of a number and a vector."""
    return factor * a[0], factor * a[1], factor * a[2]


@kernel
def first_broken(y):
    """Return the place of the first number that is not finite, or -1."""
    for i in range(len(y)):
        if not math.isfinite(y[i]):
            return i
    return -1


@kernel
def dot(a, b):
    """Return the scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def cross(a, b):
    """Return a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@kernel
def turned(r, a):
    """Return R a."""
    return (r[0] * a[0] + r[1] * a[1] + r[2] * a[2],
            r[3] * a[0] + r[4] * a[1] + r[5] * a[2],
            r[6] * a[0] + r[7] * a[1] + r[8] * a[2])


@kernel
def turned_back(r, a):
    """Return R^T a."""
    return (r[0] * a[0] + r[3] * a[1] + r[6] * a[2],
            r[1] * a[0] + r[4] * a[1] + r[7] * a[2],
            r[2] * a[0] + r[5] * a[1] + r[8] * a[2])


@kernel
def product(p, q):
    """Return the matrix P Q."""
    return (p[0] * q[0] + p[1] * q[3] + p[2] * q[6],
            p[0] * q[1] + p[1] * q[4] + p[2] * q[7],
            p[0] * q[2] + p[1] * q[5] + p[2] * q[8],
            p[3] * q[0] + p[4] * q[3] + p[5] * q[6],
            p[3] * q[1] + p[4] * q[4] + p[5] * q[7],
            p[3] * q[2] + p[4] * q[5] + p[5] * q[8],
            p[6] * q[0] + p[7] * q[3] + p[8] * q[6],
            p[6] * q[1] + p[7] * q[4] + p[8] * q[7],
            p[6] * q[2] + p[7] * q[5] + p[8] * q[8])


@kernel
def symmetric(i, a):
    """Return S a of a symmetric matrix S, given as xx, yy, zz, xy, xz, yz."""
    return (i[0] * a[0] + i[3] * a[1] + i[4] * a[2],
            i[3] * a[0] + i[1] * a[1] + i[5] * a[2],
            i[4] * a[0] + i[5] * a[1] + i[2] * a[2])
