"""Figures of step responses with known results."""

import math

from isa_ros.analysis.signals.step_response import step_figures
from isa_ros.errors import AnalysisError
import numpy as np
import pytest

T = np.arange(0.0, 2.0, 1e-4)
# Straight lines between samples 1e-4 s apart: off by at most dt^2 / 8 times curvature over
# slope, below 1e-4 s * 1e-4 * 60 for every system here.
LINE = 1e-6


@pytest.mark.parametrize(('start', 'target'), [(0.0, 1.0), (5.0, -3.0)])
def test_a_first_order_lag_rises_in_its_time_constant_times_ln_9(start, target):
    """Rise in tau ln 9, settled after -tau ln 0.05, no overshoot, for steps up and down."""
    tau = 0.05
    got = step_figures(T, start + (target - start) * (1.0 - np.exp(-T / tau)), start, target)
    assert got.rise_time == pytest.approx(tau * math.log(9.0), abs=LINE)
    assert got.settling_time == pytest.approx(-tau * math.log(0.05), abs=LINE)
    assert got.overshoot == 0.0
    # exp(-1.8 / 0.05) is left
    assert got.steady_error == pytest.approx(0.0, abs=1e-14)
    assert got.ripple == pytest.approx(0.0, abs=1e-14)


def test_a_second_order_system_overshoots_by_its_damping():
    """exp(-pi zeta / sqrt(1 - zeta^2)), zeta = 0.3; it leaves the band of 5 % three times."""
    zeta, w = 0.3, 2.0 * math.pi * 10.0
    damped = w * math.sqrt(1.0 - zeta * zeta)
    y = 1.0 - np.exp(-zeta * w * T) * (
        np.cos(damped * T) + zeta * w / damped * np.sin(damped * T))
    got = step_figures(T, y, 0.0, 1.0)
    # a sample within dt / 2 of the peak: w^2 (dt / 2)^2 / 2
    assert got.overshoot == pytest.approx(
        math.exp(-math.pi * zeta / math.sqrt(1.0 - zeta * zeta)), abs=1e-5)
    assert got.settling_time is not None
    assert np.abs(y[got.settling_time < T] - 1.0).max() < 0.05
    # it stays in the band: shortly before it is still outside
    assert abs(y[np.searchsorted(T, got.settling_time) - 1] - 1.0) > 0.05


def test_the_steady_error_is_what_is_missing_at_the_end():
    got = step_figures(T, 0.9 * (1.0 - np.exp(-T / 0.01)), 0.0, 1.0)
    # exp(-180) is left
    assert got.steady_error == pytest.approx(0.1, abs=1e-14)
    assert got.settling_time is None


def test_ripple_is_the_deviation_at_the_end():
    got = step_figures(T, 1.0 + 0.02 * np.sin(2.0 * math.pi * 100.0 * T), 0.0, 1.0)
    # whole cycles: amplitude / sqrt(2), 100 samples a cycle
    assert got.ripple == pytest.approx(0.02 / math.sqrt(2.0), rel=1e-9)


def test_what_never_gets_there_has_no_rise_time():
    got = step_figures(T, np.full(len(T), 0.5), 0.0, 1.0)
    assert got.rise_time is None and got.settling_time is None


@pytest.mark.parametrize(('n', 'target', 'band', 'expected'), [
    (100, 0.0, 0.05, 'step from 0 to 0'),
    (100, 1.0, 0.0, 'settling band = 0'),
    (100, 1.0, 1.0, 'settling band = 1'),
    (9, 1.0, 0.05, '9 times and 9 values'),
    (0, 1.0, 0.05, '0 times and 0 values')])
def test_what_is_no_step_is_refused(n, target, band, expected):
    with pytest.raises(AnalysisError, match=expected):
        step_figures(np.arange(n) * 1e-3, np.ones(n), 0.0, target, band)
