"""What goes up and down in turn, as the output of a loop that hunts: how far, and how often."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

_HALVES = 3         # whole half periods from which on a signal swings


class Swing(NamedTuple):
    """Half of peak to peak, in the unit of the signal, and Hz; 0.0: none."""

    size: float
    hertz: float


def swing(t: NDArray[np.float64], values: NDArray[np.float64], least: float) -> Swing:
    """
    Return the swing of a signal, (n,), over its times in s.

    It swings where it goes up and down in turn to the end, by more than twice ``least`` > 0. Its
    height is that of the ways between the extremes, the mean of the medians of those up and those
    down, after those of less than a limit are left out, the largest one that leaves a swing: so
    what is faster and smaller does not count, nor a drift, a step or a pulse beside it. NaN was
    not measured.
    """
    is_there = np.isfinite(values)
    t, values = t[is_there], values[is_there]
    found, limit = Swing(0.0, 0.0), 2.0 * least
    while len(extremes := _extremes(values.tolist(), limit)) > _HALVES:
        at = t[extremes]
        half = (at[-1] - at[0]) / (len(at) - 1)
        if t[-1] - at[-1] <= 2.0 * half:
            ways = np.abs(np.diff(values[extremes]))
            found = Swing(0.25 * float(np.median(ways[::2]) + np.median(ways[1::2])),
                          0.5 / float(half))
        limit *= 2.0
    return found


def _extremes(values: Sequence[float], limit: float) -> list[int]:
    """Return the places of the extremes between ways that are longer than ``limit``."""
    low = high = way = 0        # places since the last extreme, and whether it goes up or down
    found: list[int] = []
    for place, value in enumerate(values):
        low = place if value < values[low] else low
        high = place if value > values[high] else high
        if way >= 0 and values[high] - value > limit:
            found += [high] if high else []     # the begin is none
            way, low, high = -1, place, place
        elif way <= 0 and value - values[low] > limit:
            found += [low] if low else []
            way, low, high = 1, place, place
    return found
