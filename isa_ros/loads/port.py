"""
The load port: the copy of its load that an actuator integrates during one tick.

``x`` is the load's side of the force sensor in the actuator's coordinate (m or rad),
``force`` the force that the sensor transmits, > 0 pushing out. A shared load (a body) is
linearised anew every tick; the load of a single actuator is the same equation with constant
coefficients plus the forces of `isa_ros.loads.forces`.
"""

from isa_ros.core.kernel import kernel


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
