"""Discrete first-order filters; coefficients are computed once, at configuration."""

import math

from isa_ros.core.elementary import exp
from isa_ros.core.kernel import kernel


def low_pass_coefficient(cutoff_hz: float, rate_hz: float) -> float:
    """Return alpha = 1 - exp(-2 pi f_c / f_s) of a sampled first-order low-pass  (R1)."""
    return 1.0 - exp(-2.0 * math.pi * cutoff_hz / rate_hz)


@kernel
def low_pass(previous, value, alpha):
    """Return y + alpha (u - y)  (R1)."""
    return previous + alpha * (value - previous)
