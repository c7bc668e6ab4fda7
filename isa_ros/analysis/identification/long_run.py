"""
Covariances of a sum of scores that hang together over some instants: S of ``sum_t s_t``.

A residual times its instruments is a score, (n_parameters,) at each instant. Both estimators give
the degrees of freedom of Student's t that belongs to them: a sum of n scores that hang together
over ``lags`` instants has about n / (lags + 1) independent ones.
"""

from collections.abc import Callable
import math
from typing import NamedTuple

import numpy as np


class LongRun(NamedTuple):
    """The covariance of a sum of scores."""

    covariance: np.ndarray
    """(n_parameters, n_parameters)."""
    freedom: float
    """Degrees of freedom; below 1 there are too few instants."""


Estimator = Callable[[np.ndarray, int], LongRun]
"""Of scores (n, n_parameters) and ``lags``."""


def newey_west(scores: np.ndarray, lags: int) -> LongRun:
    """
    Return ``sum_k w_k Gamma_k`` with the covariances at lags k up to ``lags``.

    Newey and West 1987, A Simple, Positive Semi-definite, Heteroskedasticity and Autocorrelation
    Consistent Covariance Matrix, Econometrica 55. The weights w_k fall to 0 at ``lags + 1``, so
    that of scores which hang together that long it is half too small.
    """
    covariance = scores.T @ scores
    for lag in range(1, lags + 1):
        product = scores[lag:].T @ scores[:-lag]
        covariance += (1.0 - lag / (lags + 1.0)) * (product + product.T)
    n_parameters = scores.shape[1]
    return LongRun(covariance, _blocks(scores, lags) - n_parameters / (lags + 1.0))


def cosines(scores: np.ndarray, lags: int) -> LongRun:
    """
    Return ``1/B sum_j L_j L_j^T``, ``L_j = sum_t sqrt(2) cos(pi j (t + 1/2) / n) s_t``, j = 1..B.

    Lazarus, Lewis, Stock and Watson 2018, HAR Inference: Recommendations for Practice, Journal of
    Business and Economic Statistics 36: of a sum of many scores the B values L_j are independent,
    so that Student's t with B degrees of freedom is exact. The last cosine has a period of
    4 (``lags`` + 1) instants: as far the spectrum of the scores is taken as that at frequency 0.
    """
    n = len(scores)
    number = int(0.5 * _blocks(scores, lags))
    angles = np.pi / n * (np.arange(n) + 0.5)
    sums = math.sqrt(2.0) * np.cos(np.outer(np.arange(1, number + 1), angles)) @ scores
    return LongRun(sums.T @ sums / max(number, 1), number)


def _blocks(scores: np.ndarray, lags: int) -> float:
    """Return the number of independent scores."""
    return float(np.count_nonzero(scores.any(axis=1)) / (lags + 1.0))
