"""
The state of a circuit at t = 0.

What stands between where actuators return their oil and the tank is at the tank's pressure; all
else is at the least of what pumps hold (the greatest of them), and relief and unloading valves.
"""

from isa_ros.core.units import MPA
from isa_ros.surroundings.circuits.network import OF_ORIFICE, PER_ELEMENT, PER_NODE
from isa_ros.surroundings.circuits.nodes import node_content
from isa_ros.surroundings.circuits.plan import Network
from isa_ros.surroundings.circuits.sheet import CircuitSupply
import numpy as np
from numpy.typing import NDArray


def at_rest(sheet: CircuitSupply, network: Network) -> NDArray[np.float64]:
    """Return the state of a circuit at t = 0."""
    n, m = len(network.nodes), len(network.elements)
    state = np.zeros(PER_NODE * n + PER_ELEMENT * m)
    low = sheet.with_return() | {sheet.tank}
    tank, high = sheet.return_pressure_mpa * MPA, sheet.rest_pressure
    for k, place in enumerate(network.places):
        node = network.nodes[k]
        if node['is_held']:
            continue
        part = sheet.between.get(place)
        ends = {place} if part is None else {part.inlet, part.outlet}
        pressure = tank if ends <= low else high
        state[n + k] = node['gas']['theta_a']
        state[k] = node_content(pressure, state[n + k], node)
    for j, element in enumerate(network.elements):
        if element['law'] == OF_ORIFICE:
            state[PER_NODE * n + j] = element['orifice']['target']
    return state


def of_return(sheet: CircuitSupply, network: Network) -> NDArray[np.int64]:
    """Return of each element whether it is of the return side, (m,)."""
    low = sheet.with_return()
    between = sheet.between
    return np.array([
        int(owner in low or owner in between and between[owner].inlet in low)
        for owner in network.owners], np.int64)
