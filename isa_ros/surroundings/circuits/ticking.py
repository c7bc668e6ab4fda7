"""
A circuit's part of a tick, bound to its memory: before its actuators, and after them.

What actuators draw and return are volumes of the tick, as `LOAD_REPLY` has them; what they paid
for the oil is in their `SUPPLY_REPLY`, or follows from the pressures of the tick's start.
"""

from typing import NamedTuple

from isa_ros.core.kernel import kernel
from isa_ros.surroundings.circuits.network import circuit_advance, circuit_rates
from isa_ros.surroundings.circuits.nodes import feeding_capacity
from isa_ros.surroundings.circuits.rows import show
from isa_ros.surroundings.circuits.slopes import inflow_slope, inflow_trend
from isa_ros.surroundings.circuits.warmth import Heating, show_warmth, warm
from isa_ros.surroundings.supply_port import FedNode, fill_feeds
import numpy as np

FED = len(FedNode._fields)
"""Numbers of a `FedNode`."""


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


class Groups(NamedTuple):
    """The actuators of f manifolds that feed them, and where their oil goes."""

    nodes: np.ndarray
    """Of the manifolds, int64, (f,)."""
    returns: np.ndarray
    """Nodes that take the oil back, int64, (f,)."""
    samples: np.ndarray
    """Rows of the manifolds' samples, int64, (f,)."""
    rows: np.ndarray
    """Of the actuators, those of one manifold after the other, int64."""
    are_heated: np.ndarray
    """Of each of these rows whether the actuator has a temperature of its own, bool."""
    ends: np.ndarray
    """Where the rows of each begin, and the number of all, int64, (f + 1,)."""


class Pressures(NamedTuple):
    """Memory of `fill_pressures`."""

    held: np.ndarray
    """As in `Flowing`."""
    groups: Groups
    ports: np.ndarray
    """`LOAD_PORT` of all actuators."""


class Feeds(NamedTuple):
    """Memory of `fill_manifolds`."""

    flowing: Flowing
    groups: Groups
    oil: np.ndarray
    """`OIL_STATE`, as in a `Heating`."""
    answers: np.ndarray
    """`SUPPLY_REPLY` of all actuators at the end of the last tick."""
    feeds: np.ndarray
    """`SUPPLY_PORT` of all actuators."""


class Nodes(NamedTuple):
    """Memory of `fill_nodes`."""

    flowing: Flowing
    groups: Groups
    fed: np.ndarray
    """The numbers of a `FedNode` of each, (f, FED)."""


class ShownRows(NamedTuple):
    """Memory of `show_rows`."""

    flowing: Flowing
    none: np.ndarray
    """Zeros, (n,)."""
    rows: np.ndarray
    """What each sample shows, (k,)."""
    is_return: np.ndarray
    """Whether an element is of the return side, (m,)."""
    at_rest: np.ndarray
    """Stored energies at t = 0, (k,)."""
    gas: np.ndarray
    """Volumes of gas at t = 0, (n,)."""
    oil: np.ndarray
    """What actuators have drawn from each node and returned to it, (2, n)."""
    samples: np.ndarray
    """`SUPPLY_SAMPLE`, (k,)."""
    heating: Heating


class CircuitTick(NamedTuple):
    """Memory of `advance`."""

    shown: ShownRows
    groups: Groups
    is_due: np.ndarray
    """1 once the oil has properties of another temperature, which is for Python; int64, (1,)."""
    replies: np.ndarray
    """`LOAD_REPLY` of all actuators."""
    answers: np.ndarray
    """Their `SUPPLY_REPLY`, where the pressures moved in the tick, or none."""


class WarmthDue(NamedTuple):
    """Memory of `is_due`, as in `CircuitTick`."""

    is_due: np.ndarray


@kernel
def fill_pressures(own):
    """Fill both pressures of the actuators; return 0."""
    held, groups = own.held, own.groups
    for k in range(len(groups.nodes)):
        for i in range(groups.ends[k], groups.ends[k + 1]):
            port = own.ports[groups.rows[i]]
            port.supply_pressure = held[groups.nodes[k]]
            port.return_pressure = held[groups.returns[k]]
    return 0


@kernel
def fed_node(k, of):
    """Return the `FedNode` of node ``k`` of a `Flowing` at the start of a tick."""
    n = len(of.nodes)
    return FedNode(
        of.held[k], feeding_capacity(of.held[k], of.state[n + k], of.nodes[k]), of.rates[k],
        inflow_slope(k, of.state, of.held, of.elements),
        inflow_trend(k, of.state, of.rates, of.held, of.nodes, of.elements))


@kernel
def fill_nodes(own):
    """Fill what the circuit says of its nodes that feed actuators; return 0."""
    for k in range(len(own.groups.nodes)):
        node, fed = fed_node(own.groups.nodes[k], own.flowing), own.fed[k]
        fed[0], fed[1], fed[2] = node.pressure, node.capacity, node.inflow
        fed[3], fed[4] = node.slope, node.trend
    return 0


@kernel
def fill_manifolds(own):
    """Fill the `SUPPLY_PORT` of the actuators; return 0."""
    groups = own.groups
    for k in range(len(groups.nodes)):
        fill_feeds(fed_node(groups.nodes[k], own.flowing),
                   groups.rows[groups.ends[k]:groups.ends[k + 1]], own.answers, own.feeds)
    if len(own.oil) > 0:
        for row in groups.rows:
            own.feeds[row].is_warm, own.feeds[row].celsius = 1.0, own.oil[0].celsius
    return 0


@kernel
def oil_of(k, own):
    """Return what the actuators of manifold ``k`` drew and returned, m3, and paid, J."""
    groups, drawn, returned, paid = own.groups, 0.0, 0.0, 0.0
    for i in range(groups.ends[k], groups.ends[k + 1]):
        row = groups.rows[i]
        drawn += own.replies[row].supply_volume
        returned += own.replies[row].return_volume
        if len(own.answers) > 0:
            paid += own.answers[row].paid
    if len(own.answers) == 0:
        paid = own.shown.flowing.held[groups.nodes[k]] * drawn
    return drawn, returned, paid


@kernel
def own_heat(taken, own):
    """
    Return what is left of what all actuators took, J, without those that warm up by themselves.

    And the heat that the oil of these has carried to the tank, J  (T10).
    """
    groups, held, carried = own.groups, own.shown.flowing.held, 0.0
    if len(own.answers) == 0:
        return taken, carried
    for k in range(len(groups.nodes)):
        paid, returned, heat = 0.0, 0.0, 0.0
        for i in range(groups.ends[k], groups.ends[k + 1]):
            if groups.are_heated[i]:
                row = groups.rows[i]
                paid += own.answers[row].paid
                returned += own.replies[row].return_volume
                heat += own.answers[row].heat
        taken -= paid - held[groups.returns[k]] * returned
        carried += heat
    return taken, carried


@kernel
def flow(own):
    """Advance state and contents by one tick with the mean flows of the actuators."""
    of, groups, step = own.shown.flowing, own.groups, own.shown.flowing.step[0]
    n = len(of.nodes)
    for i in range(n):
        of.flows[i] = 0.0
        of.state[2 * n + i] = 0.0
    for k in range(len(groups.nodes)):
        drawn, returned, _ = oil_of(k, own)
        of.flows[groups.nodes[k]] += drawn / step
        of.flows[groups.returns[k]] -= returned / step
    circuit_advance(of.steps[0], step / of.steps[0], of.flows, of.nodes, of.elements, of.state,
                    of.work)


@kernel
def take_power(power, sample):
    """Write what the actuators of a tick took, W, to a sample."""
    sample.power = power
    if power > sample.peak_power:
        sample.peak_power = power


@kernel
def account(own):
    """Add oil and energy of the actuators to manifolds and the whole; return the energy, J."""
    of, groups, shown = own.shown.flowing, own.groups, own.shown
    n, step, total, whole = len(of.nodes), of.step[0], 0.0, shown.samples[0]
    for k in range(len(groups.nodes)):
        node, back = groups.nodes[k], groups.returns[k]
        drawn, returned, paid = oil_of(k, own)
        energy = paid - of.held[back] * returned
        given = (of.state[2 * n + node] / step * drawn
                 - of.state[2 * n + back] / step * returned)
        total += energy
        sample = shown.samples[groups.samples[k]]
        take_power(energy / step, sample)
        shown.oil[0, node] += drawn
        shown.oil[1, back] += returned
        whole.drawn += drawn
        whole.returned += returned
        sample.energy += energy
        whole.energy += energy
        sample.held_energy += energy - given
        whole.held_energy += energy - given
    take_power(total / step, whole)
    return total


@kernel
def advance(own):
    """Advance by one tick with the oil that the actuators drew and returned; return 0."""
    of = own.shown.flowing
    flow(own)
    taken, carried = own_heat(account(own), own)
    for i in range(len(of.nodes)):
        of.held[i] = of.work[0, i]
    if warm(of.step[0], taken, carried, of.state, of.nodes, of.elements, own.shown.heating):
        own.is_due[0] = 1
    else:
        show_rows(own.shown)
    return 0


@kernel
def is_due(own):
    """Return 1 if `advance` has found work for Python, else 0."""
    return own.is_due[0]


@kernel
def show_rows(own):
    """Write the rates and the samples at the end of a tick; return 0."""
    of = own.flowing
    circuit_rates(of.state, own.none, of.nodes, of.elements, of.work[0], of.rates)
    show(own)
    show_warmth(own.heating, own.samples)
    return 0
