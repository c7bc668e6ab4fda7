"""
The moving part of the actuator: piston or rotor, force sensor and own end stops.

The sensor is the spring between the actuator and its load and reads the force it transmits;
force > 0 pushes the load out. Units N, m, kg (linear) or Nm, rad, kg m2 (rotary).
"""

from isa_ros.core.contact import one_sided
from isa_ros.core.elementary import tanh
from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel
from isa_ros.core.parameter import parameter, Parameters
from isa_ros.core.record import record
import numpy as np


@frozen(kw_only=True)
class Mechanics(Parameters):
    """Inertia, force sensor and end stops."""

    inertia: float = parameter('moving mass or rotor inertia', 'kg | kg m2', gt=0.0, le=2e4)
    sensor_stiffness: float = parameter('K_s', 'N/m | Nm/rad', gt=0.0, le=1e11)
    sensor_damping: float = parameter('D_s', 'Ns/m | Nms/rad', ge=0.0, le=1e8)
    backlash: float = parameter(
        'half play j between sensor and load; 0: none', 'm | rad', ge=0.0, le=0.01)
    stop_stiffness: float = parameter('end-stop stiffness', 'N/m | Nm/rad', gt=0.0, le=1e11)
    stop_damping: float = parameter('end-stop damping', 'Ns/m | Nms/rad', ge=0.0, le=1e8)


MECHANICS = np.dtype([
    ('inertia', 'f8'), ('k_s', 'f8'), ('d_s', 'f8'), ('backlash', 'f8'),
    ('k_stop', 'f8'), ('d_stop', 'f8')])
MECHANICS_STATE = np.dtype([('position', 'f8'), ('velocity', 'f8')])


def mechanics_record(sheet: Mechanics) -> np.record:
    """Return the `MECHANICS` record of a sheet."""
    return record(
        MECHANICS, inertia=sheet.inertia, k_s=sheet.sensor_stiffness, d_s=sheet.sensor_damping,
        backlash=sheet.backlash, k_stop=sheet.stop_stiffness, d_stop=sheet.stop_damping)


@kernel
def play(d, backlash):
    """Return phi(d) = d - j tanh(d/j), the stretch behind a play of 2 j  (M1)."""
    if backlash <= 0.0:
        return d
    return d - backlash * tanh(d / backlash)


@kernel
def sensor_force(s, v, x, x_rate, mechanics):
    """
    Return K_s phi(s - x) + D_s (s' - x')  (M2), in N or Nm.

    ``s`` is the actuator's and ``x`` the load's side (equations 20 and 21 of the paper).
    """
    return mechanics.k_s * play(s - x, mechanics.backlash) + mechanics.d_s * (v - x_rate)


@kernel
def stop_force(s, v, stroke, mechanics):
    """Return the force of the actuator's own end stops at 0 and ``stroke``  (M3), in N or Nm."""
    return (one_sided(-s, -v, mechanics.k_stop, mechanics.d_stop)
            - one_sided(s - stroke, v, mechanics.k_stop, mechanics.d_stop))
