"""Stepped sines and chirps as they are sent."""

import math

from isa_ros.analysis.response.sweep import excitation, FrequencySweep
from isa_ros.errors import ConfigError
import numpy as np
import pytest

RATE_HZ = 10_000.0


def test_a_stepped_sine_fills_whole_milliseconds_without_a_jump():
    sweep = FrequencySweep(low=3.0, high=300.0, points=20)
    given = excitation(sweep, RATE_HZ)
    for window in given.answer.windows:
        n = window.end - window.start
        assert n % 10 == 0
        assert window.frequency * n / RATE_HZ == pytest.approx(
            round(window.frequency * n / RATE_HZ), abs=1e-9)
    # a sine of 300 Hz (and half a ms of 0.2 s more) moves by at most 2 pi f / rate a sample
    assert np.abs(np.diff(given.values)).max() < 2.0 * math.pi * 301.0 / RATE_HZ
    # half a millisecond of the shortest window, 0.2 s
    got = [window.frequency for window in given.answer.windows]
    assert got == pytest.approx(sweep.frequencies, rel=2.5e-3)


def test_a_chirp_goes_beyond_its_band_at_both_ends():
    given = excitation(FrequencySweep(low=4.0, high=100.0, points=5, is_chirp=True), RATE_HZ)
    crossings = np.flatnonzero(np.diff(np.signbit(given.values)))
    # half periods: the first longer than at 4 Hz, the last shorter than at 100 Hz
    assert np.diff(crossings)[0] > 0.5 * RATE_HZ / 4.0
    assert np.diff(crossings)[-1] < 0.5 * RATE_HZ / 100.0


@pytest.mark.parametrize('is_chirp', [False, True])
def test_rates_are_the_derivatives_of_the_values(is_chirp):
    given = excitation(FrequencySweep(low=4.0, high=40.0, points=5, is_chirp=is_chirp), RATE_HZ)
    slope = (given.values[2:] - given.values[:-2]) * 0.5 * RATE_HZ
    kinks = np.abs(np.diff(given.rates)) > (2.0 * math.pi * 50.0) ** 2 / RATE_HZ
    smooth = ~(kinks[1:] | kinks[:-1])
    assert smooth.mean() > 0.99
    # central differences: w^3 / 6 / rate^2, w at most 2 pi 50
    assert np.abs(slope - given.rates[1:-1])[smooth].max() < (
        2.0 * math.pi * 50.0) ** 3 / 6.0 / RATE_HZ ** 2 * 1.01


def test_a_band_is_refused_at_the_rate_of_what_takes_it():
    with pytest.raises(ConfigError, match=r'--to = 410 Hz, must be <= 400 Hz: nodes at 1000 Hz'):
        FrequencySweep(low=1.0, high=410.0, points=5).check(1000.0, 'nodes')
