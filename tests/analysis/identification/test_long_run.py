"""Covariances of sums of scores: white and correlated ones, against their true value."""

from isa_ros.analysis.identification.long_run import cosines, newey_west
import numpy as np
import pytest
from scipy.signal import lfilter

N, LAGS, TIMES = 1200, 29, 400
PHI = np.exp(-1.0 / 20.0)


def scores(seed: int, phi: float) -> np.ndarray:
    """Return two columns of scores of first order, of variance 1 and 9, (N, 2)."""
    noise = np.random.default_rng(seed).normal(0.0, [1.0, 3.0], (N + 500, 2))
    found: np.ndarray = lfilter([np.sqrt(1.0 - phi * phi)], [1.0, -phi], noise, axis=0)[500:]
    return found


@pytest.mark.parametrize('estimator', [newey_west, cosines])
def test_white_scores_have_the_sum_of_their_variances(estimator) -> None:
    """Of 400 the mean is known within 2 % (some 20 to 60 degrees of freedom each)."""
    mean = np.mean([estimator(scores(k, 0.0), LAGS)[0] for k in range(TIMES)], axis=0)
    assert np.diag(mean) == pytest.approx([N, 9 * N], rel=0.05)
    assert abs(mean[0, 1]) < 0.05 * 3 * N


def test_correlated_scores_are_counted_with_what_hangs_together() -> None:
    """(1 + phi) / (1 - phi) = 40 times the variance; weights of Newey and West lose a third."""
    true = N * (1.0 + PHI) / (1.0 - PHI)
    assert true / N == pytest.approx(40.0, rel=0.01)
    own, weighted = (np.mean([estimator(scores(k, PHI), LAGS)[0][0, 0] for k in range(TIMES)])
                     for estimator in (cosines, newey_west))
    assert 0.7 * true < own < 0.95 * true and 0.4 * true < weighted < 0.65 * true


def test_a_cosine_is_one_degree_of_freedom() -> None:
    """Half of one for each independent score; of rows without a score none."""
    white = scores(3, 0.0)
    assert cosines(white, LAGS).freedom == 20
    white[::2] = 0.0
    assert cosines(white, LAGS).freedom == 10
    assert newey_west(white, LAGS).freedom == pytest.approx(20.0 - 2.0 / 30.0)
    assert cosines(white[:100], LAGS).freedom == 0


def test_an_instant_counts_if_one_parameter_has_a_score_there() -> None:
    white = scores(5, 0.0)
    white[::3, 1] = 0.0
    assert cosines(white, LAGS).freedom == 20


def test_weights_fall_to_0_one_lag_beyond_the_last() -> None:
    """Squares, and twice half of the products of neighbours."""
    own = newey_west(np.array([[1.0], [2.0], [4.0]]), 1)
    assert own.covariance == pytest.approx(1.0 + 4.0 + 16.0 + 2.0 * 0.5 * (2.0 + 8.0))


def test_a_constant_score_is_no_spread() -> None:
    """At the minimum their sum is 0: the mean is not among the cosines."""
    assert cosines(np.full((N, 1), 7.0), LAGS).covariance[0, 0] == pytest.approx(0.0, abs=1e-18)


def test_cosines_of_the_lowest_frequencies_count() -> None:
    """The first, the last and the one behind it; each has the power n / 2."""
    t = (np.arange(N) + 0.5) / N
    found = [float(cosines(np.cos(np.pi * j * t)[:, None], LAGS).covariance[0, 0])
             for j in (1, 20, 21)]
    assert found == pytest.approx([N * N / 40, N * N / 40, 0.0], abs=1e-12 * N * N)
