"""The speed estimate: the encoder differenced and smoothed."""

from dataclasses import dataclass

from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.record import record
from isa_ros.reu.filters import low_pass, low_pass_coefficient
import numpy as np


@dataclass(frozen=True, kw_only=True)
class SpeedEstimate(Parameters):
    """Rate and smoothing of the speed that damping and compensation use."""

    rate_hz: float = parameter('rate of the differences', 'Hz', gt=0.0, le=50e3)
    filter_hz: float = parameter('low-pass on them', 'Hz', gt=0.0, le=5e3)


SPEED = np.dtype([('rate', 'f8'), ('alpha', 'f8')])
SPEED_STATE = np.dtype([('position', 'f8'), ('velocity', 'f8')])


def speed_record(sheet: SpeedEstimate) -> np.record:
    """Return the `SPEED` record of a sheet."""
    return record(
        SPEED, rate=sheet.rate_hz, alpha=low_pass_coefficient(sheet.filter_hz, sheet.rate_hz))


@kernel
def speed_step(measured_position, speed, state):
    """Run one period: difference the encoder, smooth the difference  (R1)."""
    difference = (measured_position - state.position) * speed.rate
    state.velocity = low_pass(state.velocity, difference, speed.alpha)
    state.position = measured_position
