"""
Forces on the load of a single actuator: its end stops, a pad, a weight on a rope.

``x`` is the load's position in the actuator's coordinate (m or rad), ``x_0`` that at t = 0;
forces > 0 push out. Units N, m or Nm, rad. A record of zeros is a load without these forces.
"""

from isa_ros.core.contact import normal_force, one_sided
from isa_ros.core.kernel import kernel
from isa_ros.loads.drop_rig import ROPE, weight_rates, WEIGHT_STATE
import numpy as np

LOAD_STATE = np.dtype([('position', 'f8'), ('velocity', 'f8'), ('weight', WEIGHT_STATE)])
STOPS = np.dtype([
    ('low', 'f8'), ('high', 'f8'),              # m | rad
    ('stiffness', 'f8'), ('damping', 'f8'),     # N/m | Nm/rad, Ns/m | Nms/rad
])
PAD = np.dtype([
    ('gap', 'f8'),                              # free travel to the pad, m | rad
    ('radius', 'f8'),                           # of the contact, m/m | m/rad
    ('stiffness', 'f8'), ('damping', 'f8'),     # N/m^1.5 and s/m of the law of the ground
])
OWN_LOAD = np.dtype([('stops', STOPS), ('pad', PAD), ('rope', ROPE)])


@kernel
def stop_force(x, v, stops):
    """Return the force of the load's own end stops  (M3), in N or Nm; 0 for a load without."""
    return (one_sided(stops.low - x, -v, stops.stiffness, stops.damping)
            - one_sided(x - stops.high, v, stops.stiffness, stops.damping))


@kernel
def pad_force(turn, v, pad):
    """
    Return -R N(d), d = R (x - x_0 - gap)  (L21), in N or Nm: a pad never pulls.

    N is the law of the ground (L9); ``turn`` is x - x_0.
    """
    return -pad.radius * normal_force(pad.radius * (pad.gap - turn), -pad.radius * v, pad)


@kernel
def own_load_force(y, x_0, own, rates):
    """Return the sum of these forces on one `LOAD_STATE`; write the weight's ``rates``."""
    force = 0.0
    if own.stops.stiffness > 0.0:
        force += stop_force(y.position, y.velocity, own.stops)
    if own.pad.stiffness > 0.0:
        force += pad_force(y.position - x_0, y.velocity, own.pad)
    if own.rope.stiffness > 0.0:
        force += weight_rates(y.position - x_0, y.velocity, y.weight, own.rope, rates.weight)
    return force
