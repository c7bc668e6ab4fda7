"""
Position loop: the impedance that makes the force reference, and the speed estimate.

Runs at 1 kHz on the encoder. Reference in, force reference out (N or Nm).
"""

from dataclasses import dataclass

from isa_ros.kernel import kernel
from isa_ros.parameter import parameter, Parameters
from isa_ros.reu.filters import low_pass, low_pass_coefficient
import numpy as np


@dataclass(frozen=True, kw_only=True)
class PositionLoop(Parameters):
    """Impedance gains in force before the first setpoint, and the limits of the reference."""

    rate_hz: float = parameter('loop rate', 'Hz', gt=0.0, le=50e3)
    stiffness: float = parameter('impedance stiffness', 'N/m | Nm/rad', ge=0.0, le=1e7)
    damping: float = parameter('impedance damping', 'Ns/m | Nms/rad', ge=0.0, le=1e6)
    velocity_filter_hz: float = parameter(
        'low-pass on the differenced encoder', 'Hz', gt=0.0, le=5e3)
    force_out: float = parameter('largest reference, pushing out', 'N | Nm', gt=0.0, le=1e6)
    force_in: float = parameter('largest reference, pulling in', 'N | Nm', gt=0.0, le=1e6)


POSITION_LOOP = np.dtype([
    ('rate', 'f8'), ('velocity_alpha', 'f8'), ('force_out', 'f8'), ('force_in', 'f8')])
SETPOINT = np.dtype([
    ('position', 'f8'), ('velocity', 'f8'), ('effort', 'f8'),
    ('stiffness', 'f8'), ('damping', 'f8'), ('is_enabled', 'f8')])
POSITION_STATE = np.dtype([
    ('position', 'f8'), ('velocity', 'f8'), ('force_reference', 'f8')])


def position_loop_record(sheet: PositionLoop) -> tuple[float, ...]:
    """Return the `POSITION_LOOP` record of a sheet."""
    return (sheet.rate_hz, low_pass_coefficient(sheet.velocity_filter_hz, sheet.rate_hz),
            sheet.force_out, sheet.force_in)


@kernel
def impedance(setpoint, position, velocity):
    """Return stiffness (x_d - x) + damping (v_d - v) + effort  (R2), in N or Nm."""
    return (setpoint.stiffness * (setpoint.position - position)
            + setpoint.damping * (setpoint.velocity - velocity) + setpoint.effort)


@kernel
def position_loop_step(measured_position, setpoint, loop, state):
    """Run one period: estimate the speed, write the force reference clipped at stall."""
    difference = (measured_position - state.position) * loop.rate
    state.velocity = low_pass(state.velocity, difference, loop.velocity_alpha)
    state.position = measured_position
    reference = impedance(setpoint, measured_position, state.velocity)
    state.force_reference = max(-loop.force_in, min(loop.force_out, reference))
