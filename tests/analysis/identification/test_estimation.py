"""Moment conditions, and intervals with the stated coverage."""

from isa_ros.analysis.identification.estimation import Box, half_widths, Linearised, solve
import numpy as np
import pytest

WIDE = Box(np.full(2, -1e3), np.full(2, 1e3), np.ones(2))


def line(x: np.ndarray, y: np.ndarray, instrument: np.ndarray):
    """Return the model y = theta_0 + theta_1 x with an instrument for x."""
    def model(theta: np.ndarray) -> Linearised:
        ones = np.ones_like(x)
        return Linearised(y - theta[0] - theta[1] * x, np.column_stack([ones, x]),
                          np.column_stack([ones, instrument]))
    return model


def test_a_curved_model_is_solved() -> None:
    """An exponential from a poor start: without noise the error left is the square of 1e-4."""
    x = np.linspace(0.0, 2.0, 50)
    y = 3.0 * np.exp(-1.7 * x)

    def model(theta: np.ndarray) -> Linearised:
        shape = np.exp(-theta[1] * x)
        jacobian = np.column_stack([shape, -theta[0] * x * shape])
        return Linearised(y - theta[0] * shape, jacobian, jacobian)

    assert solve(model, np.array([1.0, 0.3]), WIDE) == pytest.approx([3.0, 1.7], abs=1e-7)


def test_bounds_are_kept() -> None:
    x = np.linspace(0.0, 1.0, 20)
    box = Box(np.array([-1e3, -1e3]), np.array([1e3, 1.5]), np.ones(2))
    assert solve(line(x, 2.0 * x, x), np.zeros(2), box)[1] == 1.5


def test_an_instrument_takes_away_the_bias_of_a_noisy_regressor() -> None:
    """
    Noise of half the signal's variance attenuates the slope by 1/(1 + 1/2).

    A second measurement with noise of its own as instrument does not; its standard error is
    sqrt(var(error) var(instrument)/n)/var(signal) < 0.02 for n = 10000.
    """
    random = np.random.default_rng(1)
    true = random.normal(size=10_000)
    x, second = (true + np.sqrt(0.5) * random.normal(size=len(true)) for _ in range(2))
    least_squares = solve(line(x, true, x), np.zeros(2), WIDE)[1]
    instrumented = solve(line(x, true, second), np.zeros(2), WIDE)[1]
    assert least_squares == pytest.approx(1.0 / 1.5, abs=0.03)
    assert instrumented == pytest.approx(1.0, abs=0.06)


def test_intervals_of_correlated_residuals_hold_the_truth() -> None:
    """
    Errors of an autoregression with a memory of 10 samples.

    A 95 % interval misses more than 19 of 200 times in 0.4 % of the cases; one that takes the
    samples as independent is 4 times too narrow and misses more than half of the time.
    """
    random = np.random.default_rng(2)
    x = np.linspace(-1.0, 1.0, 2000)
    held = dependent = 0
    for _ in range(200):
        error = np.zeros_like(x)
        kicks = random.normal(size=len(x))
        for k in range(1, len(x)):
            error[k] = 0.9 * error[k - 1] + kicks[k]
        model = line(x, error, x)
        here = model(solve(model, np.ones(2), WIDE))
        slope = solve(model, np.ones(2), WIDE)[1]
        groups = np.arange(len(x))
        held += abs(slope) <= half_widths(here, groups, 60)[1]
        dependent += abs(slope) <= half_widths(here, groups, 0)[1]
    assert held >= 200 - 19
    assert dependent < 100


def test_a_shared_error_widens_the_interval_by_what_it_moves() -> None:
    """An offset of all residuals by 0.5 moves theta_0 by 0.5: t sqrt(s^2 + 0.5^2)."""
    random = np.random.default_rng(3)
    x = np.linspace(-1.0, 1.0, 400)
    model = line(x, 0.01 * random.normal(size=len(x)), x)
    here = model(solve(model, np.zeros(2), WIDE))
    groups = np.arange(len(x))
    alone, shared = (half_widths(here, groups, 3, errors) for errors in (
        [], [np.full(len(x), 0.5)]))
    # Student's t of 99 degrees of freedom is 1.984.
    assert shared[0] == pytest.approx(np.hypot(alone[0], 0.5 * 1.984), rel=1e-3)
    assert shared[1] == pytest.approx(alone[1], rel=1e-6)


def test_what_nothing_tells_apart_has_no_interval() -> None:
    """Two equal columns, or fewer samples than the length of their correlation."""
    x = np.linspace(0.0, 1.0, 50)
    twice = Linearised(x, np.column_stack([x, x]), np.column_stack([x, x]))
    assert np.all(np.isinf(half_widths(twice, np.arange(50), 2)))
    model = line(x, x * x, x)
    assert np.all(np.isinf(half_widths(model(np.zeros(2)), np.arange(50), 60)))
