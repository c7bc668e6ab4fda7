"""
How well one signal follows another: y(t) = gain x(t - delay) + offset, and what is left.

NRMSE is the root mean square of the difference, without any fit, over the standard deviation of
the expected signal: 0 for equal signals, about 1 for one that knows the mean only. The delay is
that of the smallest difference after gain and offset, which are least squares at each delay. It is
searched up to `LONGEST_DELAY` or a quarter of the common time, whichever is less, either way.
"""

from typing import NamedTuple

from isa_ros.analysis.signals.signals import Signal
from isa_ros.errors import AnalysisError
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

LONGEST_DELAY = 0.25    # s, either way
LEAST_SAMPLES = 20
_FINE = 21              # delays between two of those before
_SEARCHES = 3           # each around the best delay of the one before


class Fit(NamedTuple):
    """How an actual signal follows an expected one."""

    nrmse: float
    delay: float
    """s; > 0: the actual one is later."""
    gain: float
    left: float
    """NRMSE that is left after delay, gain and offset."""
    n: int
    """Samples in which both have values."""
    is_at_end: bool = False
    """Whether no delay of the search is better than its last one, so that there is no match."""


def fit(expected: Signal, actual: Signal, longest: float = LONGEST_DELAY) -> Fit:
    """
    Return the fit at the times of the expected signal, over the time that both have.

    Raises
    ------
    AnalysisError
        They have less than `LEAST_SAMPLES` in common, or the expected one does not change.

    """
    inside = (expected.t >= actual.t[0]) & (expected.t <= actual.t[-1])
    t, x = expected.t[inside], expected.values[inside]
    if len(t) < LEAST_SAMPLES:
        raise AnalysisError(f'{len(t)} samples in common, must be at least {LEAST_SAMPLES}')
    spread = float(np.std(x))
    if spread == 0.0:
        raise AnalysisError('the expected signal does not change')
    difference = np.interp(t, actual.t, actual.values) - x
    longest = min(longest, 0.25 * float(t[-1] - t[0]))
    step = max(float(np.median(np.diff(t))), longest / 200.0)
    delays = np.arange(-longest, longest + 0.5 * step, step)
    ends = float(delays[0]), float(delays[-1])
    for _ in range(_SEARCHES):
        lefts = [_left(t, x, actual, delay)[0] for delay in delays]
        best = int(np.argmin(lefts))
        low, high = delays[max(best - 1, 0)], delays[min(best + 1, len(delays) - 1)]
        at = float(delays[best])
        delays = np.linspace(low, high, _FINE)
    left, gain = _left(t, x, actual, at)
    return Fit(float(np.sqrt(np.mean(difference ** 2))) / spread, at, gain, left / spread, len(t),
               at in ends)


def _left(t: Floats, x: Floats, actual: Signal, delay: float) -> tuple[float, float]:
    """Return root mean square and gain of the best line through both at a delay."""
    y = np.interp(t + delay, actual.t, actual.values)
    centred = x - x.mean()
    gain = float(centred @ y) / float(centred @ centred)
    rest = y - y.mean() - gain * centred
    return float(np.sqrt(np.mean(rest ** 2))), gain
