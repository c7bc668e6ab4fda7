"""
The ripple of a loop whose reference stands still, measured after its excitation.

A limit cycle is hidden by an excitation: a sine of its size suppresses it, or lets it explain a
percent of the variance only, and the response looks like that of a stable loop. So the reference
is pushed once, which starts a cycle that needs a push, and then stands still at the operating
point of the excitation until what remains is ripple.
"""

import math
from typing import NamedTuple

from isa_ros.analysis.signals.frequency import ripple, ripple_frequency
import numpy as np

PUSH_S = 0.1        # the reference at its amplitude
SETTLE_S = 1.0      # from the end of the push to the recording
RECORDED_S = 0.5
HUNTS = 0.02        # largest ripple of a quiet loop over the amplitude: three quanta of its sensor


class LoopAtRest(NamedTuple):
    """A loop without excitation."""

    ripple: float
    """Half of peak to peak of the output without its drift, SI; NaN: not recorded."""
    frequency: float
    """Of the largest part of the ripple, Hz."""
    amplitude: float
    """Of the excitation, SI."""

    @property
    def is_known(self) -> bool:
        """Return whether the loop was recorded at rest."""
        return not math.isnan(self.ripple)

    @property
    def share(self) -> float:
        """Return the ripple as a share of the excitation."""
        return self.ripple / self.amplitude

    @property
    def hunts(self) -> bool:
        """Return whether the ripple is a limit cycle: more than `HUNTS` of the excitation."""
        return self.share > HUNTS


def ticks_at_rest(rate: float) -> tuple[int, int]:
    """Return the number of samples of the push, and of all after it."""
    return round(PUSH_S * rate), round((SETTLE_S + RECORDED_S) * rate)


def rest_of(output: np.ndarray, amplitude: float, rate: float) -> LoopAtRest:
    """Return the ripple in the last `RECORDED_S` of an output, (n,)."""
    from scipy.signal import detrend    # half a second, which steps do not need
    values = detrend(output[-round(RECORDED_S * rate):])
    return LoopAtRest(ripple(values), ripple_frequency(values, rate), amplitude)
