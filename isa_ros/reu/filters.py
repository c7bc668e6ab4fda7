"""
Discrete first-order filters; coefficients are computed once, at configuration.

The speed estimate is the encoder differenced and smoothed by one.
"""

import math

from isa_ros.core.elementary import exp
from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.record import record
import numpy as np


def low_pass_coefficient(cutoff_hz: float, rate_hz: float) -> float:
    """Return alpha = 1 - exp(-2 pi f_c / f_s) of a sampled first-order low-pass  (R1)."""
    return 1.0 - exp(-2.0 * math.pi * cutoff_hz / rate_hz)


@kernel
def low_pass(previous, value, alpha):
    """Return y + alpha (u - y)  (R1)."""
    return previous + alpha * (value - previous)


@frozen(kw_only=True)
class SpeedEstimate(Parameters):
    """Rate and smoothing of the speed that damping and compensation use."""

    rate_hz: float = parameter('rate of the differences', 'Hz', gt=0.0, le=50e3)
    filter_hz: float = parameter('low-pass on them', 'Hz', ge=1e-3, le=5e3)


SMALLEST_SPEED = 1e-30
"""m/s or rad/s: at rest the estimate decays, and would stay at the smallest double, 5e-324."""

SPEED = np.dtype([('rate', 'f8'), ('alpha', 'f8')])
SPEED_STATE = np.dtype([('position', 'f8'), ('velocity', 'f8')])


def speed_record(sheet: SpeedEstimate) -> np.record:
    """Return the `SPEED` record of a sheet."""
    return record(
        SPEED, rate=sheet.rate_hz, alpha=low_pass_coefficient(sheet.filter_hz, sheet.rate_hz))


@kernel
def speed_step(measured_position, speed, state):
    """Run one period: difference the encoder, smooth it  (R1); 0 below `SMALLEST_SPEED`."""
    difference = (measured_position - state.position) * speed.rate
    velocity = low_pass(state.velocity, difference, speed.alpha)
    state.velocity = velocity if abs(velocity) >= SMALLEST_SPEED else 0.0
    state.position = measured_position
