"""Ripple and its frequency."""

import math

from isa_ros.analysis.signals.frequency import ripple, ripple_frequency
import numpy as np
import pytest

RATE = 10_000.0


def test_ripple_and_frequency_of_a_known_sine():
    """On a drift of a tenth of its amplitude, twenty whole periods."""
    t = np.arange(4000) / 1e4
    sine = 3.0 * np.sin(2.0 * math.pi * 50.0 * t)
    assert ripple(sine) == pytest.approx(3.0, rel=1e-9)     # 200 samples a period: on the peak
    assert ripple_frequency(sine + 0.3 * t / t[-1], RATE) == 50.0
