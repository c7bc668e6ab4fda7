"""The forces with which actuators hold a robot at t = 0."""

from collections.abc import Sequence
import math

from isa_ros.core.kernel import kernel
from isa_ros.errors import ConfigError
from isa_ros.surroundings.bodies.robot.motion import move, tree_of
from isa_ros.surroundings.bodies.robot.port_kernel import DEAD_CENTRE, fill_response
from isa_ros.surroundings.bodies.robot.reach import along
from isa_ros.surroundings.bodies.robot.records import RobotRecords
import numpy as np
from numpy.typing import NDArray

ROUNDS = 4              # each leaves this part of what the last one left, at most:
REGULAR = 1e-6          # added to the diagonal of A, scaled to 1, so that drives may share a joint


@kernel
def pushes(y, records, by, free):
    """
    Fill A = J M^-1 J^T and x'' without forces of the actuators, everything held that may be.

    A (k, k) is how all actuators accelerate by a unit force of each  (L13).
    """
    k = len(records.drives)
    tree = tree_of(records, len(y))
    for j in range(k):
        tree.forces[j] = 0.0
    move(y, tree.forces, True, tree)
    for j in range(k):
        free[j] = along(tree.drives[j], tree.levers, tree.acceleration) + tree.drives[j].curvature
    for j in range(k):
        inverse_mass = fill_response(tree.drives[j], True, tree)
        for i in range(k):
            by[i, j] = inverse_mass * along(tree.drives[i], tree.levers, tree.response)


@kernel
def factor_symmetric(a):
    """Replace the lower triangle of a positive definite matrix by its Cholesky factor."""
    for i in range(len(a)):
        for j in range(i + 1):
            value = a[i, j]
            for m in range(j):
                value -= a[i, m] * a[j, m]
            a[i, j] = math.sqrt(value) if i == j else value / a[j, j]


@kernel
def solve_symmetric(a, x):
    """Replace x by A^-1 x, with what `factor_symmetric` left of A."""
    for i in range(len(x)):
        for m in range(i):
            x[i] -= a[i, m] * x[m]
        x[i] /= a[i, i]
    for i in range(len(x) - 1, -1, -1):
        for m in range(i + 1, len(x)):
            x[i] -= a[m, i] * x[m]
        x[i] /= a[i, i]


def hold(a, free, forces):
    """
    Fill the forces F with A F = -free; of several the smallest, scaled by the diagonal of A.

    Tikhonov's regularisation, repeated on what is left.
    """
    k = len(free)
    regular, left, scale = a.copy(), free.copy(), free.copy()
    for i in range(k):
        scale[i], forces[i] = 1.0 / math.sqrt(a[i, i]), 0.0
    for i in range(k):
        for j in range(k):
            regular[i, j] = a[i, j] * scale[i] * scale[j] + (REGULAR if i == j else 0.0)
    factor_symmetric(regular)
    for _ in range(ROUNDS):
        for i in range(k):
            left[i] = -free[i]
            for j in range(k):
                left[i] -= a[i, j] * forces[j]
            left[i] *= scale[i]
        solve_symmetric(regular, left)
        for i in range(k):
            forces[i] += left[i] * scale[i]


def holding_forces(y: NDArray[np.float64], records: RobotRecords,
                   names: Sequence[str]) -> NDArray[np.float64]:
    """
    Return the forces (k,) under which the actuators do not accelerate, N | Nm.

    ``names`` are those of the robot's actuators.

    Raises
    ------
    ConfigError
        An actuator has no lever.

    """
    k = len(names)
    by, free, forces = np.zeros((k, k)), np.zeros(k), np.zeros(k)
    pushes(y, records, by, free)
    for name, own in zip(names, by.diagonal()):
        if not own > DEAD_CENTRE:
            raise ConfigError(
                f'{name}: moves nothing at the start, 1/m = {own:.3g} 1/kg, must be > '
                f'{DEAD_CENTRE:g} 1/kg: it is at its dead centre, or what it moves is held')
    hold(by, free, forces)
    return forces
