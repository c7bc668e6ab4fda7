"""Sharing of a wrench among the feet that stand."""

import math
from typing import NamedTuple

from isa_ros.core.kernel import kernel
import numpy as np

REGULARISATION = 1e-3
"""Of the least squares: a force costs this times its square."""
WEIGHTS = np.array([1.0, 1.0, 2.0, 4.0, 4.0, 2.0])
"""Of errors of force (N) along x, y, z and of moment (Nm) about them."""


class Equations(NamedTuple):
    """Memory of `share_wrench` for f feet."""

    maps: np.ndarray
    """(f, 6, 3)."""
    square: np.ndarray
    """(6, 6)."""
    solution: np.ndarray
    """(6,)."""


def equations(feet: int) -> Equations:
    """Return the memory for so many feet."""
    return Equations(np.zeros((feet, 6, 3)), np.zeros((6, 6)), np.zeros(6))


@kernel
def share_wrench(wrench, arms, is_standing, weights, regularisation, own, forces):
    """
    Fill the forces of the ground on the feet, (f, 3), which together give a wrench, (6,).

    They minimise |W (A f - w)|^2 + e |f|^2 with A f = (sum f_i, sum r_i x f_i); the six equations
    of f = A' W (W A A' W + e)^-1 W w are solved by Cholesky. ``arms`` r_i lead from the point of
    the wrench, (f, 3). A foot that swings has none. ``own`` are `Equations`.
    """
    n = len(arms)
    maps, square, solution = own.maps, own.square, own.solution
    maps.fill(0.0)
    square.fill(0.0)
    for i in range(n):
        if not is_standing[i]:
            continue
        x, y, z = arms[i, 0], arms[i, 1], arms[i, 2]
        foot = maps[i]
        for a in range(3):
            foot[a, a] = weights[a]
        foot[3, 1], foot[3, 2] = -z * weights[3], y * weights[3]
        foot[4, 0], foot[4, 2] = z * weights[4], -x * weights[4]
        foot[5, 0], foot[5, 1] = -y * weights[5], x * weights[5]
        for a in range(6):
            for b in range(a + 1):
                for c in range(3):
                    square[a, b] += foot[a, c] * foot[b, c]
    for a in range(6):
        square[a, a] += regularisation
        for b in range(a + 1):
            for c in range(b):
                square[a, b] -= square[a, c] * square[b, c]
            square[a, b] = (
                math.sqrt(square[a, a]) if a == b else square[a, b] / square[b, b])
        solution[a] = weights[a] * wrench[a]
        for c in range(a):
            solution[a] -= square[a, c] * solution[c]
        solution[a] /= square[a, a]
    for a in range(5, -1, -1):
        for c in range(a + 1, 6):
            solution[a] -= square[c, a] * solution[c]
        solution[a] /= square[a, a]
    for i in range(n):
        for c in range(3):
            forces[i, c] = 0.0
            for a in range(6):
                forces[i, c] += maps[i, a, c] * solution[a]


@kernel
def limit_forces(is_standing, least, most, friction, forces):
    """Bring the forces of standing feet within ``least`` to ``most``, N, and the friction cone."""
    for i in range(len(forces)):
        if not is_standing[i]:
            continue
        normal = min(max(forces[i, 2], least), most)
        forces[i, 2] = normal
        sideways = math.sqrt(forces[i, 0] * forces[i, 0] + forces[i, 1] * forces[i, 1])
        if sideways > friction * normal:
            forces[i, 0] *= friction * normal / sideways
            forces[i, 1] *= friction * normal / sideways


class Sharing(NamedTuple):
    """Memory of `share`."""

    wrench: np.ndarray
    """Of the ground, about the centre of mass, (6,)."""
    arms: np.ndarray
    """Of the feet, (f, 3)."""
    is_standing: np.ndarray
    """(f,)."""
    weights: np.ndarray
    """`WEIGHTS`."""
    limits: np.ndarray
    """Least and most force, N, and friction, (3,)."""
    equations: Equations
    forces: np.ndarray
    """Of the feet on the ground, (f, 3)."""


@kernel
def share(own):
    """Fill the forces that feet which stand exert on the ground, within their limits; return 0."""
    forces = own.forces
    share_wrench(own.wrench, own.arms, own.is_standing, own.weights, REGULARISATION,
                 own.equations, forces)
    limit_forces(own.is_standing, own.limits[0], own.limits[1], own.limits[2], forces)
    for i in range(len(forces)):
        for c in range(3):
            forces[i, c] = -forces[i, c]
    return 0
