"""
Curves of straight lines between points, constant beyond the last one.

A curve begins at x = 0 and is continuous; the points are on it, whatever their distances.
"""

from collections.abc import Sequence

from isa_ros.core.kernel import kernel
from isa_ros.core.record import record
import numpy as np

POINTS = 16
"""Most points of a curve."""

LINES = np.dtype([
    ('x', 'f8', (POINTS + 1,)), ('y', 'f8', (POINTS + 1,)),  # behind the last point: _NEVER
    ('slope', 'f8', (POINTS,))])                             # from each point to the next one
_NEVER = 1e300  # any unit: no argument reaches it


def lines_record(x: Sequence[float], y: Sequence[float]) -> np.record:
    """Return the `LINES` record of at most `POINTS` points; ``x`` rises from 0."""
    n = len(x)
    xs, ys, slopes = np.full(POINTS + 1, _NEVER), np.full(POINTS + 1, _NEVER), np.zeros(POINTS)
    xs[:n], ys[:n] = x, y
    slopes[:n - 1] = np.diff(ys[:n]) / np.diff(xs[:n])
    return record(LINES, x=xs, y=ys, slope=slopes)


@kernel
def y_on_lines(x, lines):
    """Return y_k + slope_k (x - x_k) of the last point with x_k <= x; ``x`` >= 0  (V15)."""
    k = 0
    while x >= lines.x[k + 1]:
        k += 1
    return lines.y[k] + lines.slope[k] * (x - lines.x[k])


@kernel
def x_on_lines(y, lines):
    """Return the x of a curve that rises from 0 at which it reaches ``y`` >= 0  (R11)."""
    k = 0
    while y >= lines.y[k + 1]:
        k += 1
    if lines.slope[k] <= 0.0:
        return lines.x[k]
    return lines.x[k] + (y - lines.y[k]) / lines.slope[k]
