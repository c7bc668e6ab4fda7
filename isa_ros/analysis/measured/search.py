"""
The parameters with which a simulation comes closest to measured signals, and their intervals.

With residuals r_k of signal k at n instants the cost is ``sum_k log(mean(r_k^2))``, by likelihood
for noise of unknown variances: each signal counts by what is left of it, one with more for less.
Its minimum is that of least squares with the weights ``1 / rms(r_k)``.

A simulation is rough: a nearby parameter changes where friction sticks and what a converter
rounds. Slopes are differences over `DIFFERENCE`, and their roughness e would count as information:
``(S + e)^T (S + e)`` is too large, steps too short and intervals too narrow. Hence the instruments
are slopes over `WIDER`, whose roughness is another. What slopes over `NARROW` leave over, half of
``r(theta + h) - 2 r(theta) + r(theta - h)``, is an error of the residuals beside their noise.
"""

from collections.abc import Callable
from typing import NamedTuple

from isa_ros.analysis.identification.estimation import half_widths, Linearised
from isa_ros.analysis.identification.long_run import cosines
from isa_ros.analysis.measured.fit import Floats
import numpy as np
from scipy.optimize import least_squares
from scipy.stats import chi2

Residuals = Callable[[Floats], Floats]
"""
Of parameters (n_parameters,) the residuals (n_signals, n) over the signals' standard deviations;
infinite for parameters that are refused.
"""

DIFFERENCE = 0.1        # of a parameter, or of its size where it may be 0
WIDER = 0.2             # the same, of the instruments
NARROW = 0.02           # the same, where roughness is more than curvature
LEAST_LEFT = 1e-3       # of a signal's standard deviation: nothing counts as measured better
_DISPLACED = 1.5        # factor of the other starts; half a size where a parameter may be 0
_REFINEMENTS = 5        # steps with instruments, at most
_SMALL_STEP = 0.005     # of a parameter's size: less is not taken further
_SMALL_SHARE = 0.2      # of half an interval: the same
_MOST_STEPS = 15        # of the first search


class ScaledBox(NamedTuple):
    """Bounds of the parameters over their sizes, each (n_parameters,)."""

    low: Floats
    high: Floats

    def moved(self, theta: Floats, k: int, share: float) -> Floats:
        """Return theta with parameter k moved by a share of it, or of its size, within bounds."""
        moved = theta.copy()
        moved[k] += share * (abs(theta[k]) if self.low[k] > 0.0 else 1.0)
        return np.clip(moved, self.low, self.high)


class Minimum(NamedTuple):
    """Where a search ended."""

    theta: Floats
    half_widths: Floats
    """Of 95 % intervals."""
    cost: float


def searched(residuals: Residuals, start: Floats, box: ScaledBox, lags: int) -> Minimum:
    """
    Return the best minimum of several starts; its intervals reach to the others as good as it.

    Residuals hang together over ``lags`` instants.
    """
    residuals = _remembered(residuals)
    first = _refined(residuals, _descended(residuals, start, box), box, lags)
    others = [_refined(residuals, displaced, box, lags)
              for displaced in _displaced(first.theta, box)]
    best = min([first, *others], key=lambda own: own.cost)
    n_independent = residuals(best.theta).shape[1] / (lags + 1.0)
    margin = float(chi2.ppf(0.95, len(start))) / n_independent
    reach = np.max([np.abs(own.theta - best.theta) for own in (first, *others)
                    if own.cost < best.cost + margin], axis=0)
    return Minimum(best.theta, np.maximum(best.half_widths, reach), best.cost)


def _remembered(residuals: Residuals) -> Residuals:
    """Return the residuals, each computed once."""
    known: dict[bytes, Floats] = {}

    def of(theta: Floats) -> Floats:
        key = theta.tobytes()
        if key not in known:
            known[key] = residuals(theta)
        return known[key]
    return of


def _displaced(theta: Floats, box: ScaledBox) -> list[Floats]:
    """Return two starts on either side of theta in every parameter."""
    found = []
    for side in (0, 1):
        other = theta
        for k in range(len(theta)):
            above = (k + side) % 2 == 0
            other = box.moved(other, k, _DISPLACED - 1.0 if above else 1.0 / _DISPLACED - 1.0)
        found.append(other)
    return found


def left_of(found: Floats) -> Floats:
    """Return what is left of each signal, root mean square of its residuals, (n_signals, 1)."""
    left: Floats = np.sqrt(np.mean(found ** 2, axis=1, keepdims=True) + LEAST_LEFT ** 2)
    return left


def cost_of(found: Floats) -> float:
    """Return -2/n of the log-likelihood of residuals (n_signals, n), without a constant."""
    return 2.0 * float(np.sum(np.log(left_of(found))))


def _descended(residuals: Residuals, start: Floats, box: ScaledBox) -> Floats:
    """Return theta near the minimum of the squares, weighted by what is left at the start."""
    left = left_of(residuals(start))
    found = least_squares(
        lambda theta: (residuals(theta) / left).ravel(), start,
        jac=lambda theta: _slopes(residuals, theta, box, DIFFERENCE, left),
        x_scale=1.0, bounds=box, ftol=1e-2, xtol=1e-2, max_nfev=_MOST_STEPS)
    theta: Floats = found.x
    return theta


def _slopes(
        residuals: Residuals, theta: Floats, box: ScaledBox, share: float, left: Floats) -> Floats:
    """Return the derivatives (n_residuals, n_parameters) of weighted residuals, by differences."""
    return np.stack([(_slope(residuals, theta, box, share, k) / left).ravel()
                     for k in range(len(theta))], axis=1)


def _slope(residuals: Residuals, theta: Floats, box: ScaledBox, share: float, k: int) -> Floats:
    """
    Return the derivative by one parameter, (n_signals, n); 0 where no side of theta is allowed.

    Beside a bound or refused values both points are on the other side: theta itself would bring
    the roughness of the residuals into the slopes.
    """
    for least, most in ((-1.0, 1.0), (-1.5, -0.5), (0.5, 1.5)):
        below, above = box.moved(theta, k, least * share), box.moved(theta, k, most * share)
        if below[k] < above[k] and theta[k] not in (below[k], above[k]):
            up, down = residuals(above), residuals(below)
            if np.isfinite(up).all() and np.isfinite(down).all():
                slope: Floats = (up - down) / (above[k] - below[k])
                return slope
    return np.zeros_like(residuals(theta))


def _bend(residuals: Residuals, theta: Floats, box: ScaledBox, k: int) -> Floats:
    """Return what a slope leaves over on both sides of theta, (n_signals, n); 0 beside a bound."""
    below, above = box.moved(theta, k, -NARROW), box.moved(theta, k, NARROW)
    here = residuals(theta)
    bend: Floats = 0.5 * (residuals(above) - 2.0 * here + residuals(below))
    is_inside = below[k] < theta[k] < above[k] and np.isfinite(bend).all()
    return bend if is_inside else np.zeros_like(here)


def _refined(residuals: Residuals, theta: Floats, box: ScaledBox, lags: int) -> Minimum:
    """Return the minimum near theta by steps with instruments, as long as they lower the cost."""
    here = residuals(theta)
    if not np.isfinite(here).all():
        return Minimum(theta, np.full(len(theta), np.inf), np.inf)
    groups = np.tile(np.arange(here.shape[1]), len(here))
    for _ in range(_REFINEMENTS):
        left = left_of(here)
        near = Linearised(
            (here / left).ravel(), -_slopes(residuals, theta, box, DIFFERENCE, left),
            -_slopes(residuals, theta, box, WIDER, left))
        step = _step(near)
        widths = half_widths(near, groups, lags, estimator=cosines)
        better = np.clip(theta + step, box.low, box.high)
        there = residuals(better)
        if cost_of(there) >= cost_of(here):
            break
        theta, here = better, there
        if np.all(np.abs(step) < np.maximum(_SMALL_STEP, _SMALL_SHARE * _finite(widths))):
            break
    rough = [(_bend(residuals, theta, box, k) / left).ravel() for k in range(len(theta))]
    return Minimum(theta, half_widths(near, groups, lags, rough, estimator=cosines),
                   cost_of(here))


def _finite(widths: Floats) -> Floats:
    """Return half-widths, 0 for those that the data do not bound."""
    return np.where(np.isfinite(widths), widths, 0.0)


def _step(near: Linearised) -> Floats:
    """Return the step (n_parameters,) to where the instruments leave nothing."""
    matrix = near.instruments.T @ near.jacobian
    step: Floats = np.linalg.lstsq(matrix, near.instruments.T @ near.residuals, rcond=1e-10)[0]
    return step
