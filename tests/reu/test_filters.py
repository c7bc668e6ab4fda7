"""Sampled low-pass."""

import math

from isa_ros.reu.filters import low_pass, low_pass_coefficient
import pytest


def test_step_response_is_the_sampled_exponential():
    """R1: after n samples of a unit step 1 - exp(-2 pi f_c n / f_s)."""
    alpha, y = low_pass_coefficient(100.0, 1000.0), 0.0
    for n in range(1, 20):
        y = low_pass(y, 1.0, alpha)
        assert y == pytest.approx(
            1.0 - math.exp(-2.0 * math.pi * 0.1 * n), rel=1e-12, abs=0.0)
