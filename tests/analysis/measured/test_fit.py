"""The fit of two signals finds the delay and the gain that were put in."""

from isa_ros.analysis.measured.fit import fit
from isa_ros.analysis.signals.signals import Signal
from isa_ros.errors import AnalysisError
import numpy as np
import pytest

T = np.arange(0.0, 4.0, 0.002)
X = np.sin(2.0 * np.pi * 1.3 * T) + 0.4 * np.sin(2.0 * np.pi * 3.1 * T)


def late(t: np.ndarray, delay: float) -> np.ndarray:
    return np.sin(2.0 * np.pi * 1.3 * (t - delay)) + 0.4 * np.sin(2.0 * np.pi * 3.1 * (t - delay))


@pytest.mark.parametrize('delay, gain', [(0.0117, 0.8), (-0.032, 1.7), (0.0, -0.5)])
def test_delay_and_gain_are_found(delay: float, gain: float) -> None:
    """On another grid; linear interpolation of 2.5 ms samples errs by (w dt)^2 / 8, 4e-4 here."""
    t = np.arange(-1.0, 5.0, 0.0025)
    found = fit(Signal(T, X), Signal(t, 7.0 + gain * late(t, delay)))
    if gain > 0.0:
        assert found.delay == pytest.approx(delay, abs=1e-4)
        assert found.gain == pytest.approx(gain, rel=1e-3)
    assert found.left < 1e-3 * abs(gain) + (gain < 0.0)
    assert found.n == len(T)


def test_equal_signals_have_no_error_and_a_constant_one_has_all() -> None:
    """NRMSE of the mean is 1."""
    same = fit(Signal(T, X), Signal(T, X))
    assert (same.nrmse, same.delay) == (0.0, pytest.approx(0.0, abs=1e-12))
    mean = fit(Signal(T, X), Signal(T, np.full(len(T), X.mean())))
    assert mean.nrmse == pytest.approx(1.0, rel=1e-11) and abs(mean.gain) < 1e-12


def test_what_is_left_is_relative_to_the_expected_signal() -> None:
    """
    A sine of 40 Hz, which no delay or gain makes: its root mean square is 1 / sqrt 2.

    Interpolated between two samples it has cos(pi 40 Hz 2 ms) of that, 3 % less, at the least.
    """
    more = 5.0 * X + np.sin(2.0 * np.pi * 40.0 * T)
    found = fit(Signal(T, 5.0 * X), Signal(T, more))
    assert found.left == pytest.approx(np.sqrt(0.5) / np.std(5.0 * X), rel=0.035)
    assert found.nrmse == pytest.approx(np.sqrt(0.5) / np.std(5.0 * X), rel=0.001)


def test_only_the_common_time_counts() -> None:
    half = T < 2.0
    assert fit(Signal(T, X), Signal(T[half], X[half])).n == half.sum()


@pytest.mark.parametrize('expected, actual, problem', [
    (Signal(T, X), Signal(T + 9.0, X), '0 samples in common, must be at least 20'),
    (Signal(T, np.ones(len(T))), Signal(T, X), 'the expected signal does not change')])
def test_what_cannot_be_fitted_is_refused(
        expected: Signal, actual: Signal, problem: str) -> None:
    with pytest.raises(AnalysisError, match=problem):
        fit(expected, actual)


@pytest.mark.parametrize('duration, delay, is_at_end', [
    (0.4, 0.13, True), (0.4, -0.13, True), (0.4, 0.09, False), (4.0, 0.3, True),
    (4.0, -0.3, True), (4.0, 0.13, False), (4.0, 0.0, False)])
def test_a_delay_beyond_its_search_is_at_the_end(
        duration: float, delay: float, is_at_end: bool) -> None:
    """A quarter of the common time, 0.1 s of 0.4 s, or 0.25 s; a ramp that eases in and out."""
    long = np.arange(-1.0, duration + 1.0, 0.002)
    t = long[(long >= 0.0) & (long < duration)]
    found = fit(*(Signal(own, np.tanh(4.0 * (own - 0.5 * duration - late)))
                  for own, late in ((t, 0.0), (long, delay))))
    assert found.is_at_end is is_at_end
    longest = min(0.25, 0.25 * (duration - 0.002))
    # the last of delays in steps of 2 ms is up to half a step beyond
    assert abs(found.delay) == pytest.approx(longest if is_at_end else abs(delay), abs=1.1e-3)


def test_a_signal_that_rests_matches_nowhere() -> None:
    """No delay of it is better than another."""
    assert fit(Signal(T, X), Signal(T, np.zeros(len(T)))).is_at_end
