"""The valve-driven cylinder: its solution, the order of its steps, jit == Python, scipy."""

import os
import subprocess
import sys

from isa_ros.analysis.accuracy import cylinder
import numpy as np
import pytest
from scipy.integrate import solve_ivp

X, V, P_A, P_B = -1.30241237753e-3, 57.5180136914e-3, 5452872.548, 8386667.199
"""The solution at t = 1, 5 and 10 s, with the digits known (m, m/s, Pa)."""
SECONDS = (1000, 5000, 10000)  # ms
FINE = 16                      # steps a hold: the error of one step by 16^-8, 2e-10


@pytest.fixture(scope='module')
def fine() -> np.ndarray:
    """Return ten seconds in steps of 62.5 us."""
    return cylinder.simulate(10_000, FINE)


def test_fine_steps_give_every_digit_of_the_answer(fine):
    """Half a unit of the last digit given: 5e-15 m, 5e-14 m/s, 5e-4 Pa."""
    for x, v, p_a, p_b, *_ in fine[list(SECONDS)]:
        assert x == pytest.approx(X, rel=0.0, abs=5e-15)
        assert v == pytest.approx(V, rel=0.0, abs=5e-14)
        assert (p_a, p_b) == pytest.approx((P_A, P_B), rel=0.0, abs=5e-4)


def test_one_step_a_hold_stays_within_a_nanometre_and_a_pascal(fine):
    """The accuracy required for the speed in `isa bench`, at every hold of ten seconds."""
    apart = np.abs(cylinder.simulate(10_000) - fine).max(axis=0)
    assert apart[0] < 1e-9
    assert max(apart[2:4]) < 1.0


def test_steps_are_of_order_eight_across_null(fine):
    """Half the step, 2^-8 of the error, with the spool passing null four times in the second."""
    spool = fine[:1001, 4]
    assert np.count_nonzero(spool[1:] * spool[:-1] < 0.0) == 4
    errors = [np.abs(cylinder.simulate(1000, steps) - fine[:1001])[:, 0].max()
              for steps in (1, 2)]
    assert 2.0 ** 7 < errors[0] / errors[1] < 2.0 ** 9


def test_a_step_is_cut_where_the_spool_passes_null():
    """Without a cut the kink causes an error of order h^2, hundreds of times larger."""
    case = cylinder.cylinder_record()[0]
    states = cylinder.simulate(1000)
    before = int(np.flatnonzero(states[1:, 4] * states[:-1, 4] < 0.0)[0])
    y = tuple(states[before])
    r = command(case, before, y[0])
    exact = y
    for _ in range(1000):
        exact = cylinder.step(exact, 1e-6, r, case)
    uncut = cylinder.step(y, 1e-3, r, case)
    cut = cylinder.split_step(y, uncut, 1e-3, r, case)
    # the fine solution has the kink in a step of 1 us, with 1e-6 of the error of 1 ms
    assert abs(cut[2] - exact[2]) < 0.01 * abs(uncut[2] - exact[2])


def command(case: np.record, hold: int, x: float) -> float:
    """Return the spool command of one hold."""
    return float(case.gain * (case.amplitude * np.sin(case.omega * hold * 1e-3) - x))


@pytest.mark.parametrize(('method', 'holds'), [
    ('DOP853', 1000), pytest.param('Radau', 160, marks=pytest.mark.slow)])
def test_scipy_gives_the_same(fine, method, holds):
    """Adaptive steps restart at every hold; null is passed in both, the implicit one is slow."""
    case = cylinder.cylinder_record()[0]
    size = np.abs(fine).max(axis=0)
    states = [fine[0]]
    for k in range(holds):
        r = command(case, k, states[k][0])
        solved = solve_ivp(
            lambda t, y, r=r: cylinder.slope(tuple(y), r, case), (0.0, 1e-3), states[k],
            method=method, rtol=1e-12, atol=1e-12 * size)
        states.append(solved.y[:, -1])
    apart = np.abs(np.array(states) - fine[:holds + 1]).max(axis=0)
    # some fifty steps in a hold, some ten holds until an error has decayed in the loops
    assert (apart < 50 * 10 * 1e-12 * size).all()


SCRIPT = """
from isa_ros.analysis.accuracy import cylinder
print(cylinder.simulate(150).tobytes().hex())
"""


def run(disable_jit: str) -> str:
    """Return 150 ms of states, computed in a process of its own."""
    return subprocess.run(
        [sys.executable, '-W', 'ignore', '-c', SCRIPT], check=True, capture_output=True,
        text=True, env=dict(os.environ, NUMBA_DISABLE_JIT=disable_jit)).stdout


def test_compiled_run_equals_its_python_source():
    """Also with the equations built into the step, and across null at 0.13 s."""
    spool = cylinder.simulate(150)[:, 4]
    assert (spool[1:] * spool[:-1] < 0.0).any()
    assert run('0') == run('1')
