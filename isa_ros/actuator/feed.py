"""
The pressure of the supply as an actuator integrates it over a tick  (C15).

The supply gives its node's capacity and inflow in a `SUPPLY_PORT`. Of the other actuators an
actuator knows only what they drew last and how far their valves are open, and assumes that they
move as it does: a pressure that falls takes from their flows what it takes from its own, by the
conductances of their valves. The supply itself then advances with the volumes drawn.

Neglected: what the others do by themselves within the tick.
"""

from isa_ros.core.kernel import kernel
import numpy as np

FEED_STATE = np.dtype([('pressure', 'f8')])     # of the supply, Pa gauge
VARIED = 3e5
"""Pa above and below the pressure at which a conductance is measured: about what it moves in a
tick, so that a land without a drop is no wide-open door."""


@kernel
def pressure_rate(tau, risen, flow, feed):
    """
    Return P' = E (q_in + q_in' tau - (P - P_0)/R - sum q_last - N (q - q_last))  (C15), in Pa/s.

    ``tau`` (s) counts from the tick, ``risen`` is P - P_0 in Pa and ``flow`` q, what the actuator
    draws, in m3/s. The port's inflow is q_in less the flows of all actuators.
    """
    inflow = feed.inflow + feed.trend * tau - feed.slope * risen
    return feed.elastance * (inflow - feed.share * (flow - feed.flow))


@kernel
def conductance(above, below):
    """Return dq/dP of a valve from its flows at two pressures, `VARIED` above and below."""
    return max(0.0, 0.5 * (above - below) / VARIED)


@kernel
def write_feed(flow, slope, paid, reply):
    """Fill a `SUPPLY_REPLY`: flow (m3/s) and conductance (m3/s/Pa) at the tick's end, J paid."""
    reply.flow, reply.conductance, reply.paid = flow, slope, paid
