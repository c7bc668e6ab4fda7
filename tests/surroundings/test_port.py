"""What quiet ports of any number of actuators share, against the plain formulas  (L15, L16)."""

from functools import partial
import math

from isa_ros.core.record import rows_of
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY
from isa_ros.core.timebase import FORCE_WINDOWS
from isa_ros.surroundings import port
import numpy as np
import pytest
from tests.surroundings.port_copy import end_of_copy

TICK = 1e-3  # s
MIDDLES = (np.arange(FORCE_WINDOWS) + 0.5) * TICK / FORCE_WINDOWS
COUNTS = (1, 2, 5)


def state_of(k: int) -> np.void:
    """Return kept forces of k actuators, all different."""
    state = rows_of(1, np.dtype(port.kept_forces(k)))[0]
    for n, name in enumerate(state.dtype.names or ()):
        state[name] = 100.0 * (n + 1) + 7.0 * np.arange(k)
    return state


def rows_for(k: int) -> np.ndarray:
    """Return k rows among 2 k + 1, backwards and not neighbours."""
    return np.arange(2 * k - 1, 0, -2)


@pytest.mark.parametrize('k', COUNTS)
def test_kept_forces_of_k_rows_are_those_of_l16(k: int) -> None:
    """
    F' = R^4 F'_line + (1 - R^4) (mean - mean two ticks ago)/(2 H), F = mean + F' H/2.

    R and the line by numpy; sums of five forces below 1 kN: 1e-11 of the slopes.
    """
    state, rows, random = state_of(k), rows_for(k), np.random.default_rng(k)
    replies = rows_of(2 * k + 1, LOAD_REPLY)
    means = [state['older_mean'].copy(), state['mean_force'].copy()]
    for _ in range(3):
        replies['mean_forces'] = random.uniform(-1e3, 1e3, (2 * k + 1, FORCE_WINDOWS))
        windows = replies['mean_forces'][rows]
        port.keep_forces(state, TICK, rows, replies)
        means.append(windows.mean(axis=1))
        for j in range(k):
            line = np.polyfit(MIDDLES, windows[j], 1)[0]
            trust = np.corrcoef(MIDDLES, windows[j])[0, 1] ** 4
            slope = trust * line + (1.0 - trust) * (means[-1][j] - means[-3][j]) / (2.0 * TICK)
            assert state['slope'][j] == pytest.approx(slope, rel=1e-9)
            assert state['force'][j] == pytest.approx(means[-1][j] + 0.5 * TICK * slope, rel=1e-9)
        assert state['mean_force'] == pytest.approx(means[-1], rel=1e-12)
        assert state['older_mean'] == pytest.approx(means[-2], rel=1e-12)


def test_equal_forces_are_kept_without_a_slope() -> None:
    """Their line is flat, and its correlation, 0/0, counts as none."""
    state, replies = rows_of(1, np.dtype(port.kept_forces(2)))[0], rows_of(2, LOAD_REPLY)
    replies['mean_forces'] = 50.0
    for _ in range(3):
        port.keep_forces(state, TICK, np.arange(2), replies)
    assert state['slope'].tolist() == [0.0, 0.0] and state['force'].tolist() == [50.0, 50.0]


@pytest.mark.parametrize('k', COUNTS)
def test_the_copies_of_k_rows_end_the_tick_where_the_body_does(k: int) -> None:
    """
    L1 with the matched coefficients, integrated by its own definition, meets place and speed.

    The force of the actuator is the assumed one, F + F' t. 1e-5 of what a constant acceleration
    would miss, the error of the copy's own 50 Runge-Kutta steps (h d = 0.4, (h d)^5/120).
    """
    state, rows, random = state_of(k), rows_for(k), np.random.default_rng(k)
    ports = rows_of(2 * k + 1, LOAD_PORT)
    for name, bound in (('x0', 0.1), ('v0', 1.0), ('a0', 50.0)):
        ports[name] = random.uniform(-bound, bound, 2 * k + 1)
    ports['inverse_mass'] = random.uniform(0.01, 1.0, 2 * k + 1)
    ports['stiffness'] = random.uniform(0.0, 1e5, 2 * k + 1)
    ports['damping'] = random.uniform(0.0, 1e3, 2 * k + 1)
    before = ports.copy()
    missed, missed_speed = random.uniform(1e-6, 1e-5, k), random.uniform(0.01, 0.1, k)
    place = ports['x0'][rows] + TICK * (ports['v0'] + 0.5 * TICK * ports['a0'])[rows] + missed
    speed = (ports['v0'] + TICK * ports['a0'])[rows] + missed_speed
    port.match_ports(ports, rows, TICK, state, place, speed)
    for j, row in enumerate(rows):
        x, v = end_of_copy(ports[row], partial(
            port.assumed_force, state['force'][j], state['slope'][j]), TICK, 2000)
        assert x == pytest.approx(place[j], abs=1e-5 * missed[j])
        assert v == pytest.approx(speed[j], abs=1e-5 * missed_speed[j])
    filled = ['a_bias', 'jerk']
    for name in set(LOAD_PORT.names or ()) - set(filled):
        assert (ports[name] == before[name]).all()
    others = np.delete(np.arange(2 * k + 1), rows)
    assert (ports[others] == before[others]).all()


def test_the_assumed_force_of_arrays_is_that_of_each_number() -> None:
    """It takes k rows at once too: F + F' t."""
    force, slope = np.array([1.0, 2.0]), np.array([10.0, -10.0])
    assert port.assumed_force.py_func(force, slope, 0.1).tolist() == [2.0, 1.0]
    assert port.assumed_force(2.0, -10.0, 0.1) == 1.0


@pytest.mark.parametrize('k', COUNTS)
def test_compiled_kernels_equal_their_python_source(k: int) -> None:
    """Bit for bit."""
    rows, random = rows_for(k), np.random.default_rng(k)
    replies = rows_of(2 * k + 1, LOAD_REPLY)
    replies['mean_forces'] = random.uniform(-1e3, 1e3, (2 * k + 1, FORCE_WINDOWS))
    ports = rows_of(2 * k + 1, LOAD_PORT)
    for name in ('x0', 'v0', 'a0', 'inverse_mass', 'stiffness', 'damping'):
        ports[name] = random.uniform(0.0, 10.0, 2 * k + 1)
    place, speed = random.uniform(-1.0, 1.0, (2, k))
    found = []
    for keep, match in ((port.keep_forces, port.match_ports),
                        (port.keep_forces.py_func, port.match_ports.py_func)):
        state, filled = state_of(k), ports.copy()
        keep(state, TICK, rows, replies.view(np.recarray))
        match(filled.view(np.recarray), rows, TICK, state, place, speed)
        found.append(state.tobytes() + filled.tobytes())
    assert found[0] == found[1]


@pytest.mark.parametrize(('k', 'd'), [
    (0.0, 0.0), (1e5, 50.0), (9.8e6, 0.0), (0.0, 2e4), (-1e5, -20.0)])
def test_matched_coefficients_meet_place_and_speed(k: float, d: float) -> None:
    """The answer of e'' = a + b t - k e - d e' to (a, b) is the sum of those to 1 and t."""
    a, b = port.matched(1e-5, 0.02, TICK, k, d)
    e, v, h = 0.0, 0.0, TICK / 20_000
    for i in range(20_000):
        acceleration = a + b * (i + 0.5) * h - k * (e + 0.5 * h * v) - d * v
        e, v = e + h * (v + 0.5 * h * acceleration), v + h * acceleration
    # Steps of 50 ns: the midpoint's error is below h d/2 = 5e-4 of the speed.
    assert e == pytest.approx(1e-5, rel=1e-3)
    assert v == pytest.approx(0.02, rel=1e-3)


def test_a_copy_swings_no_faster_than_once_in_two_ticks() -> None:
    """The stiffness of a port is cut where a and b could not be told apart: k H^2 = pi^2."""
    assert port.resolved(1e6, TICK) == 1e6
    assert port.resolved(1e9, TICK) == pytest.approx((math.pi / TICK) ** 2)
