"""Results of the torque checks of the rotary rig from signals and gains."""

from isa_ros.analysis.signals.frequency import Response
from isa_ros.validation.actuators import SHIPPED
from isa_ros.validation.rotary_hunting import ripple
from isa_ros.validation.rotary_rig import relative_error
from isa_ros.validation.sheets import model_sheet
from isa_ros.validation.torque_step import crossing, quarter_turn
import numpy as np
import pytest


def test_a_level_is_crossed_between_two_samples():
    t, y = np.array([0.0, 1.0, 2.0]), np.array([0.0, 0.5, 1.5])
    assert crossing(t, y, 1.0) == 1.5
    assert crossing(t, y, 0.0) == 0.0
    assert np.isnan(crossing(t, y, 2.0))


def test_a_first_order_lag_turns_by_a_quarter_at_none_and_a_second_order_one_at_its_own():
    """1/(1 + j f/f0)^2 is at -90 deg at f0; interpolated between 1 % steps over log f."""
    hz = np.geomspace(5.0, 200.0, 372)
    lag = 1.0 / (1.0 + 1j * hz / 40.0)
    ones = np.ones(len(hz))
    assert np.isnan(quarter_turn(Response(hz, lag, ones, ones, ones)))
    # the phase bends by d2/dx2 = 1 rad at most over x = log f: (0.01)^2/8 of 1 rad per e-fold
    assert quarter_turn(Response(hz, lag * lag, ones, ones, ones)) == pytest.approx(40.0, rel=2e-5)


def test_the_error_is_relative_to_the_peak_of_the_reference():
    """A lag of a small angle a in a sine: rms a/sqrt(2) of the peak, to a^2/24 of itself."""
    phase = 2.0 * np.pi * np.arange(1000) / 1000
    lag = 0.01
    error = relative_error(-40.0 * np.sin(phase), -40.0 * np.sin(phase - lag))
    assert error == pytest.approx(100.0 * lag / np.sqrt(2.0), rel=1e-5)


def test_overrides_reach_the_blocked_actuator():
    """Five times the proportional gain is beyond any margin of the torque loop."""
    force = model_sheet('smart_manifold').reu.force
    assert (ripple(SHIPPED, 50.0, {'reu.force.kp': 5.0 * force.kp})
            > 100.0 * ripple(SHIPPED, 50.0, {}) > 0.0)
