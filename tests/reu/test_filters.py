"""Sampled low-pass, and the speed estimate with one."""

import math

from isa_ros.core.record import rows_of
from isa_ros.reu.filters import (
    low_pass, low_pass_coefficient, speed_record, SPEED_STATE, speed_step)
import pytest
from tests.sheets import actuator_sheet


def test_step_response_is_the_sampled_exponential():
    """R1: after n samples of a unit step 1 - exp(-2 pi f_c n / f_s)."""
    alpha, y = low_pass_coefficient(100.0, 1000.0), 0.0
    for n in range(1, 20):
        y = low_pass(y, 1.0, alpha)
        assert y == pytest.approx(
            1.0 - math.exp(-2.0 * math.pi * 0.1 * n), rel=1e-12, abs=0.0)


def test_the_speed_estimate_follows_a_ramp_through_its_filter():
    """R1: a ramp's difference through 100 Hz at 1 kHz settles exponentially to its slope."""
    row = speed_record(actuator_sheet('isa_v5').reu.speed)
    state = rows_of(1, SPEED_STATE)[0]
    for n in range(1, 30):
        speed_step(0.3e-3 * n, row, state)
        expected = 0.3 * (1.0 - math.exp(-2.0 * math.pi * 0.1 * n))
        assert state.velocity == pytest.approx(expected, rel=1e-9)


def test_at_rest_the_estimate_becomes_zero():
    """Not the smallest double, at which a decay ends by rounding; above 1e-30 nothing is cut."""
    row = speed_record(actuator_sheet('isa_v5').reu.speed)
    state = rows_of(1, SPEED_STATE)[0]
    state.velocity = before = 1.0
    share = math.exp(-2.0 * math.pi * 0.1)
    for _ in range(200):
        speed_step(0.0, row, state)
        if state.velocity == 0.0:
            break
        assert state.velocity == pytest.approx(before * share, rel=1e-15, abs=0.0)
        before = float(state.velocity)
    assert state.velocity == 0.0 and before * share < 1e-30 <= before
