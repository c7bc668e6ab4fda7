"""The ripple of a loop without excitation: its size, its frequency, and what counts as hunting."""

from isa_ros.analysis.response.at_rest import HUNTS, rest_of, ticks_at_rest
import numpy as np
import pytest

RATE = 10_000.0
T = np.arange(round(1.5 * RATE)) / RATE


def test_a_ripple_is_half_of_peak_to_peak_at_its_frequency():
    """3 sin(2 pi 40 t) around any offset."""
    found = rest_of(7.0 + 3.0 * np.sin(2.0 * np.pi * 40.0 * T), 100.0, RATE)
    # Removing the drift of 20 whole cycles: a line fitted to a sine has the slope
    # 6 / (pi 20) of its amplitude over the recording, half of it at an end: 5 %
    assert found.ripple == pytest.approx(3.0, rel=0.05)
    # the bins of half a second
    assert found.frequency == pytest.approx(40.0, abs=2.0)
    assert found.share == pytest.approx(0.03, rel=0.05) and found.hunts


def test_a_drift_is_no_ripple():
    """An integral that still settles moves along a line."""
    found = rest_of(50.0 * T, 100.0, RATE)
    # rounding of numbers up to 75
    assert found.ripple < 75.0 * 1e-12 and not found.hunts


@pytest.mark.parametrize(('size', 'hunts'), [(0.9, False), (1.1, True)])
def test_hunting_begins_at_a_share_of_the_excitation(size, hunts):
    values = size * HUNTS * 100.0 * np.sign(np.sin(2.0 * np.pi * 40.0 * T + 0.1))
    # A square wave has no extremes that a line could miss: the slope of its drift is 3 / (2 20)
    # of the amplitude at most, half of it at an end: 4 %
    assert rest_of(values, 100.0, RATE).hunts is hunts


def test_only_the_end_is_recorded():
    """The push and what follows it have decayed by then."""
    n_push, n_still = ticks_at_rest(RATE)
    values = np.zeros(n_push + n_still)
    values[:-round(0.5 * RATE)] = 100.0
    assert rest_of(values, 100.0, RATE).ripple == 0.0
