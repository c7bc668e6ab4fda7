"""
The position block as an impedance: its output is the reference of the force or torque block.

Reference in m or rad, output in N or Nm. The gains in force come with the setpoint.
"""

from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter, Parameters, tunable
from isa_ros.core.record import record
import numpy as np


@frozen(kw_only=True)
class Impedance(Parameters):
    """Impedance gains in force before the first setpoint, and the limits of the output."""

    rate_hz: float = parameter('loop rate', 'Hz', gt=0.0, le=50e3)
    stiffness: float = tunable('impedance stiffness', 'N/m | Nm/rad', ge=0.0, le=1e9)
    damping: float = tunable('impedance damping', 'Ns/m | Nms/rad', ge=0.0, le=1e8)
    force_out: float = tunable('largest reference, pushing out', 'N | Nm', gt=0.0, le=2e7)
    force_in: float = tunable('largest reference, pulling in', 'N | Nm', gt=0.0, le=2e7)


IMPEDANCE = np.dtype([('force_out', 'f8'), ('force_in', 'f8')])
SETPOINT = np.dtype([
    ('position', 'f8'), ('velocity', 'f8'), ('effort', 'f8'),
    ('stiffness', 'f8'), ('damping', 'f8'),
    ('reference', 'f8'),      # of the modes current, spool and pressure: A, m, Pa
    ('is_reference', 'f8')])  # 1: it is their setpoint; 0: the effort is


def impedance_record(sheet: Impedance) -> np.record:
    """Return the `IMPEDANCE` record of a sheet."""
    return record(IMPEDANCE, force_out=sheet.force_out, force_in=sheet.force_in)


@kernel
def impedance(setpoint, position, velocity):
    """Return stiffness (x_d - x) + damping (v_d - v) + effort  (R2), in N or Nm."""
    return (setpoint.stiffness * (setpoint.position - position)
            + setpoint.damping * (setpoint.velocity - velocity) + setpoint.effort)


@kernel
def force_reference(setpoint, position, velocity, limits):
    """Return the impedance's force clipped at stall  (R2), in N or Nm."""
    return max(-limits.force_in, min(limits.force_out, impedance(setpoint, position, velocity)))
