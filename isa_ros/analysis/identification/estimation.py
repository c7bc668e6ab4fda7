"""
Estimates with confidence intervals from moment conditions, for identification.

A model gives residuals r(theta) of shape (n,) and their Jacobian -J; theta solves
``Z^T r = 0`` for instruments Z of J's shape. With Z = J these are least squares; if a column of
J has the same sensor noise as r, its instrument is the same column from neighbouring samples,
whose noise is not correlated with it and does not bias theta (errors in variables).
"""

from collections.abc import Callable, Sequence
import math

from isa_ros.analysis.identification.long_run import Estimator, newey_west
from isa_ros.core.frozen import frozen
import numpy as np
from scipy.stats import t as student_t

CONFIDENCE = 0.95
_TOLERANCE = 1e-4   # of a step against the parameters' size; the remaining error is its square
_MAX_STEPS = 30
_HALVINGS = 12


@frozen
class Linearised:
    """A model at one theta: residuals (n,), Jacobian and instruments (n, n_parameters)."""

    residuals: np.ndarray
    jacobian: np.ndarray
    instruments: np.ndarray


Model = Callable[[np.ndarray], Linearised]


@frozen
class Box:
    """Bounds of the parameters, and the scale of their steps; each (n_parameters,)."""

    least: np.ndarray
    most: np.ndarray
    size: np.ndarray

    def clip(self, theta: np.ndarray) -> np.ndarray:
        """Return the nearest point within the bounds."""
        nearest: np.ndarray = np.clip(theta, self.least, self.most)
        return nearest

    def is_small(self, step: np.ndarray) -> bool:
        """Return whether a step is negligible."""
        return bool(np.all(np.abs(step) < _TOLERANCE * self.size))


def solve(model: Model, start: np.ndarray, box: Box) -> np.ndarray:
    """
    Return theta near ``start`` within the box, shape (n_parameters,).

    Damped least-squares steps first, which find the minimum roughly, then full steps on the
    moment conditions. A parameter without any influence keeps its value.
    """
    theta = box.clip(start)
    here = model(theta)
    for _ in range(_MAX_STEPS):
        before = theta
        theta, here = _descend(model, theta, here, box)
        if box.is_small(theta - before):
            break
    for _ in range(_MAX_STEPS):
        before = theta
        theta = box.clip(theta + _step(here.instruments, here))
        here = model(theta)
        if box.is_small(theta - before):
            break
    return theta


def _descend(
        model: Model, theta: np.ndarray, here: Linearised, box: Box
        ) -> tuple[np.ndarray, Linearised]:
    """Take the first of the halved least-squares steps that lowers the sum of squares."""
    cost = float(here.residuals @ here.residuals)
    step = _step(here.jacobian, here)
    for _ in range(_HALVINGS):
        trial = box.clip(theta + step)
        there = model(trial)
        if float(there.residuals @ there.residuals) < cost:
            return trial, there
        step = 0.5 * step
    return theta, here


def _step(instruments: np.ndarray, here: Linearised) -> np.ndarray:
    scale = _scale(here.jacobian)
    matrix = (instruments / scale).T @ (here.jacobian / scale)
    moments = (instruments / scale).T @ here.residuals
    step: np.ndarray = np.linalg.lstsq(matrix, moments, rcond=1e-13)[0] / scale
    return step


def _scale(jacobian: np.ndarray) -> np.ndarray:
    norms = np.linalg.norm(jacobian, axis=0)
    return np.where(norms > 0.0, norms, 1.0)


def half_widths(
        here: Linearised, groups: np.ndarray, lags: int,
        systematic: Sequence[np.ndarray] = (), of: np.ndarray | None = None,
        estimator: Estimator = newey_west) -> np.ndarray:
    """
    Return half of the 95 % interval of every parameter, infinite if the data do not bound it.

    With ``of`` (m, n_parameters), of these sums of parameters instead.

    ``groups`` (n,) is the number of the instant a residual belongs to; residuals of one instant
    may be correlated, and those of instants up to ``lags`` apart too, as ``estimator`` has it,
    with its degrees of freedom of Student's t. Each of ``systematic`` (n,) is one standard
    deviation of an error common to all residuals.
    """
    scale = _scale(here.jacobian)
    matrix = (here.instruments / scale).T @ (here.jacobian / scale)
    scores = np.zeros((int(groups.max()) + 1, matrix.shape[0]))
    np.add.at(scores, groups, here.instruments / scale * here.residuals[:, None])
    spread, freedom = estimator(scores, lags)
    singular = np.linalg.svd(matrix, compute_uv=False)
    if freedom < 1.0 or singular[-1] <= 1e-13 * singular[0]:
        return np.full(matrix.shape[0] if of is None else len(of), math.inf)
    inverse = np.linalg.inv(matrix) / scale[:, None]
    inverse = inverse if of is None else of @ inverse
    variances = np.diag(inverse @ spread @ inverse.T)
    for error in systematic:
        variances = variances + (inverse @ ((here.instruments / scale).T @ error)) ** 2
    quantile = float(student_t.ppf(0.5 + 0.5 * CONFIDENCE, freedom))
    widths: np.ndarray = quantile * np.sqrt(np.maximum(variances, 0.0))
    return widths
