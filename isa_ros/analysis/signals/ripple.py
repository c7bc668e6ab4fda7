"""Ripple of a signal that should stand still: its size, and the frequency it has."""

import numpy as np
from scipy import signal


def ripple(values: np.ndarray) -> float:
    """Return half of peak to peak."""
    return 0.5 * float(np.ptp(values))


def ripple_frequency(values: np.ndarray, rate: float) -> float:
    """Return the frequency of the largest peak in the spectrum without the drift, in Hz."""
    window = signal.windows.hann(len(values), sym=False)
    found = np.abs(np.fft.rfft(window * signal.detrend(values)))
    return float((1 + int(np.argmax(found[1:]))) * rate / len(values))
