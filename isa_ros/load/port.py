"""
The load port: the copy of its load that an actuator integrates during one tick.

``x`` is the load's side of the force sensor in the actuator's coordinate (m or rad),
``force`` what the sensor transmits, > 0 pushing out. A shared load (the leg) is linearised
anew every tick; a load of one actuator alone is the same equation with constants and,
where it has one, an end stop.
"""

from isa_ros.contact import one_sided
from isa_ros.kernel import kernel
import numpy as np

LOAD_STATE = np.dtype([('position', 'f8'), ('velocity', 'f8')])
LOAD_STOPS = np.dtype([
    ('low', 'f8'), ('high', 'f8'),              # m | rad
    ('stiffness', 'f8'), ('damping', 'f8'),     # N/m | Nm/rad, Ns/m | Nms/rad
])
"""The end stops of an actuator's own load; zero stiffness: none."""


@kernel
def load_acceleration(tau, x, v, force, port):
    """
    Return a_bias + jerk tau + F/m_eff - k (x - x_r) - d (v - v_r)  (L1), in m/s2 or rad/s2.

    ``tau`` (s) counts from the tick; x_r(tau) = x0 + v0 tau + a0 tau^2/2 and v_r its derivative.
    """
    x_r = port.x0 + tau * (port.v0 + 0.5 * tau * port.a0)
    v_r = port.v0 + tau * port.a0
    return (port.a_bias + port.jerk * tau + force * port.inverse_mass
            - port.stiffness * (x - x_r) - port.damping * (v - v_r))


@kernel
def load_stop_force(x, v, stops):
    """Return the force of the load's own end stops  (M3), in N or Nm; 0 where it has none."""
    return (one_sided(stops.low - x, -v, stops.stiffness, stops.damping)
            - one_sided(x - stops.high, v, stops.stiffness, stops.damping))
