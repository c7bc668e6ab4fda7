"""A circuit's part of a tick, bound to its memory: its ports, the tick, and what it shows."""

from typing import NamedTuple

from isa_ros.core.kernel import kernel
from isa_ros.surroundings.circuits.network import circuit_advance, circuit_rates
from isa_ros.surroundings.circuits.nodes import feeding_capacity
from isa_ros.surroundings.circuits.rows import show
from isa_ros.surroundings.circuits.slopes import inflow_slope, inflow_trend
from isa_ros.surroundings.supply_port import FedNode
import numpy as np


class Flowing(NamedTuple):
    """Memory of a circuit with n nodes, m elements and a state of s numbers."""

    nodes: np.ndarray
    """`NODE`, (n,)."""
    elements: np.ndarray
    """`ELEMENT`, (m,)."""
    state: np.ndarray
    """(s,)."""
    rates: np.ndarray
    """d(state)/dt at the end of the last tick, without what actuators draw, (s,)."""
    work: np.ndarray
    """Room for `circuit_advance`; its first row has the pressures after it."""
    held: np.ndarray
    """Pressures of the nodes at the start of the tick, Pa, (n,)."""
    flows: np.ndarray
    """What actuators draw from each node, mean over the tick, m3/s, (n,)."""
    steps: np.ndarray
    """Steps of a tick, int64, (1,)."""
    step: np.ndarray
    """The tick in s, (1,)."""


class Ports(NamedTuple):
    """Memory of `fill_nodes`."""

    flowing: Flowing
    places: np.ndarray
    """Nodes that feed actuators, int64, (f,)."""
    fed: np.ndarray
    """The numbers of a `FedNode` of each, (f, 5)."""


class Shown(NamedTuple):
    """Memory of `show_rows`; the arrays as `isa_ros.surroundings.circuits.rows.show` has them."""

    flowing: Flowing
    none: np.ndarray
    """Zeros, (n,)."""
    rows: np.ndarray
    is_return: np.ndarray
    at_rest: np.ndarray
    gas: np.ndarray
    oil: np.ndarray
    samples: np.ndarray


@kernel
def advance(own):
    """Advance by one tick; return 0."""
    circuit_advance(own.steps[0], own.step[0] / own.steps[0], own.flows, own.nodes, own.elements,
                    own.state, own.work)
    return 0


@kernel
def fill_nodes(own):
    """Fill what the circuit says of its nodes that feed actuators; return 0."""
    of = own.flowing
    n = len(of.nodes)
    for i in range(len(own.places)):
        k, fed = own.places[i], own.fed[i]
        fed[0] = of.held[k]
        fed[1] = feeding_capacity(of.held[k], of.state[n + k], of.nodes[k])
        fed[2] = of.rates[k]
        fed[3] = inflow_slope(k, of.state, of.held, of.elements)
        fed[4] = inflow_trend(k, of.state, of.rates, of.held, of.nodes, of.elements)
    return 0


@kernel
def show_rows(own):
    """Write the rates and the samples at the end of a tick; return 0."""
    of = own.flowing
    circuit_rates(of.state, own.none, of.nodes, of.elements, of.work[0], of.rates)
    show(own.rows, of.state, of.rates, of.nodes, of.elements, own.is_return, own.at_rest, own.gas,
         own.oil, own.samples)
    return 0


FED = len(FedNode._fields)
"""Numbers of a `FedNode`."""
