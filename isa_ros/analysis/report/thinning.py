"""Choice of the samples that are drawn of very many: no peak is lost, and none near an event."""

from collections.abc import Sequence
from typing import NamedTuple

from isa_ros.analysis.report.panels import Floats
from isa_ros.analysis.signals.signals import Signal
import numpy as np
from numpy.typing import NDArray

AROUND = 0.25       # s before and after an event, in which all samples are kept
MOST_EVENTS = 40
_FEWEST = 1000      # parts, however many signals there are


class SignalThinning(NamedTuple):
    """What is kept of signals that are too many for a page."""

    parts: int
    """Each signal has its least and greatest value in each of so many parts."""
    events: Sequence[float]
    """Times, s, around which it has all samples."""

    def thinned(self, signal: Signal) -> Signal:
        """Return the samples of a signal that are kept."""
        kept = extreme_places(signal.values, self.parts)
        for t_s in self.events:
            begin, end = np.searchsorted(signal.t, [t_s - AROUND, t_s + AROUND])
            kept = np.union1d(kept, np.arange(begin, end))
        return Signal(signal.t[kept], signal.values[kept])


def thinning_for(n_samples: int, n_signals: int, most: int,
                 events: Sequence[float]) -> SignalThinning | None:
    """Return how ``n_samples`` of all signals become about ``most``; None: all are kept."""
    if n_samples <= most:
        return None
    return SignalThinning(max(_FEWEST, most // (2 * n_signals)), events[:MOST_EVENTS])


def extreme_places(values: Floats, parts: int) -> NDArray[np.int64]:
    """
    Return where the least and greatest value of each part are, and the last one, ascending.

    Of few values all are returned.
    """
    n = len(values)
    size = -(-n // parts)
    if size <= 2:
        return np.arange(n)
    rows = np.pad(values, (0, -n % size), constant_values=np.nan).reshape(-1, size)
    is_gap = np.isnan(rows)
    least = np.where(is_gap, np.inf, rows).argmin(axis=1)
    greatest = np.where(is_gap, -np.inf, rows).argmax(axis=1)
    kept = np.sort([least, greatest], axis=0).T + size * np.arange(len(rows))[:, None]
    return np.unique(np.append(kept.ravel(), n - 1))
