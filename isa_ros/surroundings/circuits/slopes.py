"""How the inflow of a node changes with its own pressure and over time, for its port (C15)."""

from isa_ros.core.kernel import kernel
from isa_ros.core.orifice import root_slope
from isa_ros.surroundings.circuits.network import (
    OF_CHECK, OF_LINE, OF_ORIFICE, OF_PUMP, PER_NODE)
from isa_ros.surroundings.circuits.nodes import node_capacity
from isa_ros.surroundings.circuits.orifice import SMOOTH


@kernel
def flow_slope(drop, own, element):
    """Return dQ/d(dP) of an element whose own state stays, m3/s/Pa."""
    if element.law == OF_LINE:
        return 0.0
    if element.law == OF_PUMP:
        return element.pump.g
    if element.law == OF_ORIFICE:
        orifice = element.orifice
        return own * orifice.k * root_slope(drop, orifice.delta) + orifice.g
    if element.law == OF_CHECK:
        check = element.check
        if check.is_open > 0.0:
            return check.k * root_slope(drop, SMOOTH) + check.g
        beyond = drop - check.p_open
        return check.g + (check.k * root_slope(beyond, SMOOTH) if beyond > 0.0 else 0.0)
    relief = element.relief
    return relief.g + (relief.k if drop > relief.p_open else 0.0)


@kernel
def inflow_slope(node, state, pressures, elements):
    """Return by how much the inflow of a node falls with its pressure, m3/s/Pa."""
    slope, own = 0.0, PER_NODE * len(pressures)
    for j in range(len(elements)):
        element = elements[j]
        if element.inlet == node or element.outlet == node:
            slope += flow_slope(
                pressures[element.inlet] - pressures[element.outlet], state[own + j], element)
    return slope


@kernel
def inflow_trend(node, state, rates, pressures, nodes, elements):
    """
    Return d(inflow)/dt at a constant pressure of the node, m3/s2.

    Lines and pumps change their flow, and valves follow the pressure at their other end.
    """
    trend, n = 0.0, len(nodes)
    own = PER_NODE * n
    for j in range(len(elements)):
        element = elements[j]
        if element.outlet == node:
            way, other = 1.0, element.inlet
        elif element.inlet == node:
            way, other = -1.0, element.outlet
        else:
            continue
        if element.law == OF_LINE or element.law == OF_PUMP:
            trend += way * rates[own + j]
        if nodes[other].is_held <= 0.0:
            drop = pressures[element.inlet] - pressures[element.outlet]
            rise = rates[other] / node_capacity(pressures[other], state[n + other], nodes[other])
            trend += flow_slope(drop, state[own + j], element) * rise
    return trend
