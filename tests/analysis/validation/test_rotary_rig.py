"""Results of the torque checks of the rotary rig from signals and gains."""

from isa_ros.analysis.validation.rotary_rig import ideal_overshoot, relative_error, ripple
from isa_ros.analysis.validation.sheets import model_sheet
import numpy as np
import pytest
from scipy.signal import lti, step


def test_the_overshoot_of_the_gains_is_that_of_their_transfer_function():
    """
    Against scipy's step response of (s/K_f + w^2) / (s^2 + s/K_f + w^2).

    Sampled every 1/3000 of 15/w a peak is missed by less than (w dt)^2/2 = 1.3e-5 of the step.
    """
    force = model_sheet('smart_manifold').reu.force
    slope, square = 1.0 / force.kf, force.ki / (force.kp * force.kf)
    t = np.linspace(0.0, 15.0 / np.sqrt(square), 3001)
    _, y = step(lti([slope, square], [1.0, slope, square]), T=t)
    assert ideal_overshoot(force) == pytest.approx(100.0 * (y.max() - 1.0), abs=1.3e-3)


def test_the_error_is_relative_to_the_peak_of_the_reference():
    """A lag of a small angle a in a sine: rms a/sqrt(2) of the peak, to a^2/24 of itself."""
    phase = 2.0 * np.pi * np.arange(1000) / 1000
    lag = 0.01
    error = relative_error(-40.0 * np.sin(phase), -40.0 * np.sin(phase - lag))
    assert error == pytest.approx(100.0 * lag / np.sqrt(2.0), rel=1e-5)


def test_overrides_reach_the_blocked_actuator():
    """Five times the proportional gain is beyond any margin of the torque loop."""
    force = model_sheet('smart_manifold').reu.force
    assert ripple(50.0, {'reu.force.kp': 5.0 * force.kp}) > 100.0 * ripple(50.0, {}) > 0.0
