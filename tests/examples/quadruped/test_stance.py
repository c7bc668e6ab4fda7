"""Sharing of a wrench among the feet that stand."""

from isa_ros.core.bound import Bound
from isa_ros.examples.quadruped.stance import (
    equations, limit_forces, REGULARISATION, share, share_wrench, Sharing, WEIGHTS)
import numpy as np
import pytest

ARMS = np.array([[0.45, 0.26, -0.56], [0.45, -0.25, -0.55], [-0.44, 0.26, -0.56],
                 [-0.45, -0.27, -0.57]])
WRENCH = np.array([30.0, -20.0, 1055.0, 12.0, -25.0, 8.0])
ALL = np.ones(4, bool)
DIAGONAL = np.array([True, False, False, True])
USED = equations(4)
for each in USED:
    each[:] = 7.0   # as a call before has left them


def shared(is_standing: np.ndarray, wrench: np.ndarray = WRENCH) -> np.ndarray:
    forces = np.full((4, 3), np.nan)
    share_wrench(wrench, ARMS, is_standing, WEIGHTS, REGULARISATION, USED, forces)
    return forces


def given(forces: np.ndarray) -> np.ndarray:
    """Return force and moment of forces at the feet."""
    return np.concatenate([forces.sum(axis=0), np.cross(ARMS, forces).sum(axis=0)])


def test_four_feet_give_the_whole_wrench():
    """Twelve forces for six equations; the regularisation costs 1e-3 of the least singular."""
    assert given(shared(ALL)) == pytest.approx(WRENCH, rel=5e-3, abs=0.05)


@pytest.mark.parametrize('is_standing', [ALL, DIAGONAL, ~DIAGONAL])
def test_it_is_the_least_squares_solution(is_standing):
    """Of |W (A f - w)|^2 + e |f|^2, by numpy's normal equations over the standing feet."""
    standing = np.flatnonzero(is_standing)
    maps = np.zeros((6, 3 * len(standing)))
    for k, foot in enumerate(standing):
        x, y, z = ARMS[foot]
        maps[:, 3 * k:3 * k + 3] = np.vstack(
            [np.eye(3), [[0, -z, y], [z, 0, -x], [-y, x, 0]]])
    weighted = WEIGHTS[:, None] * maps
    wanted = np.linalg.solve(
        weighted.T @ weighted + REGULARISATION * np.eye(maps.shape[1]),
        weighted.T @ (WEIGHTS * WRENCH)).reshape(-1, 3)
    found = shared(is_standing)
    # Condition of the normal equations: 1e5 at most, times the rounding of doubles.
    assert found[standing] == pytest.approx(wanted, rel=1e-8, abs=1e-6)
    assert not found[~is_standing].any()


def test_compiled_and_plain_are_equal():
    plain = np.zeros((4, 3))
    share_wrench.py_func(WRENCH, ARMS, ALL, WEIGHTS, REGULARISATION, USED, plain)
    assert plain.tobytes() == shared(ALL).tobytes()


def test_forces_stay_in_the_friction_cone_and_press():
    forces = np.array([[100.0, 0.0, 100.0], [3.0, 4.0, -50.0], [0.0, -900.0, 2000.0],
                       [7.0, 8.0, -9.0]])
    standing = np.array([True, True, True, False])
    limit_forces(standing, 10.0, 1500.0, 0.6, forces)
    assert forces == pytest.approx(np.array([
        [60.0, 0.0, 100.0], [3.0, 4.0, 10.0], [0.0, -900.0, 1500.0], [7.0, 8.0, -9.0]]), abs=1e-9)


def test_the_forces_of_a_tick_are_those_on_the_ground_within_their_limits():
    own = Sharing(WRENCH.copy(), ARMS.copy(), DIAGONAL.copy(), WEIGHTS,
                  np.array([10.0, 500.0, 0.02]), equations(4), np.full((4, 3), 7.0))
    expected = shared(DIAGONAL)
    free = expected.copy()
    limit_forces(DIAGONAL, 10.0, 500.0, 0.02, expected)
    assert Bound(share, own).run() == 0
    assert own.forces.tobytes() == (-expected).tobytes()
    assert abs(free[0, 2] - expected[0, 2]) > 1.0 and own.forces[0, 2] == -500.0
