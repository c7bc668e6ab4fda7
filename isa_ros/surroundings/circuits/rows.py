"""
What a circuit shows of itself: one `SUPPLY_SAMPLE` for the whole and one for each part.

Of a manifold: its pressure, that of where its actuators return their oil, the net flow that the
rest of the circuit brings, and the energy of its actuators. Of what stands between two places:
both pressures, its flow, what it has lost (a pump: given) and stores. Of all of them the oil that
has entered and left: what flowed there and back through one connection counts as its difference;
a leak or a tear is a connection of the manifold that it is at. Equations E10 to E12.
"""

from isa_ros.core.kernel import kernel
from isa_ros.surroundings.circuits.accumulator import AccumulatorPart, gas_energy, ICE
from isa_ros.surroundings.circuits.heat import CoolerPart
from isa_ros.surroundings.circuits.line import LinePart
from isa_ros.surroundings.circuits.network import (
    element_flow, OF_LINE, OF_ORIFICE, OF_PUMP, PER_NODE)
from isa_ros.surroundings.circuits.nodes import gas_volume, node_energy, node_pressure
from isa_ros.surroundings.circuits.orifice import DumpPart
from isa_ros.surroundings.circuits.plan import Network
from isa_ros.surroundings.circuits.sheet import Between, CircuitSupply
import numpy as np

OF_WHOLE, OF_PLACE, OF_GAS, OF_WAY, OF_COOLER = range(5)

ROW = np.dtype((np.record, [
    ('kind', 'i8'),
    ('inlet', 'i8'), ('outlet', 'i8'),      # nodes of both pressures
    ('first', 'i8'), ('last', 'i8'),        # elements from the first to before the last,
    ('tear', 'i8'),                         # and another one, -1: none
    ('inner', 'i8'), ('inner_last', 'i8')]))    # nodes in it likewise


def rows_of_circuit(sheet: CircuitSupply, network: Network) -> np.ndarray:
    """Return the `ROW` of the whole, whose place is its first pump's outlet, and of each part."""
    tank = network.node(sheet.tank)
    pumps = [k for k, element in enumerate(network.elements) if element['law'] == OF_PUMP]
    dumps = [name for name, part in sheet.by_name.items() if isinstance(part, DumpPart)]
    dump = network.of(dumps[0]) if dumps else []
    found = [(OF_WHOLE, int(network.elements[pumps[0]]['outlet']), tank, *_span(dump), -1, 0, 0)]
    for name, part in sheet.by_name.items():
        if isinstance(part, Between):
            inner = network.inner(name)
            of = network.of(name)
            tear = of.pop() if isinstance(part, LinePart) else -1
            found.append((OF_WAY, network.node(part.inlet), network.node(part.outlet),
                          *_span(of), tear, *_span(inner)))
        elif isinstance(part, AccumulatorPart):
            node = network.node(part.at)
            found.append((OF_GAS, node, node, 0, 0, -1, 0, 0))
        elif isinstance(part, CoolerPart):
            found.append((OF_COOLER, tank, tank, 0, 0, -1, 0, 0))
        else:
            node = network.node(name)
            found.append((OF_PLACE, node, network.node(sheet.return_of(name)),
                          *_span(network.of(name)), -1, node, node + 1))
    return np.array(found, ROW)


def _span(indices: list[int]) -> tuple[int, int]:
    return (indices[0], indices[-1] + 1) if indices else (0, 0)


@kernel
def stored_in(state, nodes, elements):
    """Return what all nodes and lines of a circuit store, J  (E10)."""
    n = len(nodes)
    stored = 0.0
    for i in range(n):
        stored += node_energy(state[i], state[n + i], nodes[i])
    for j in range(len(elements)):
        if elements[j].law == OF_LINE:
            flow = state[PER_NODE * n + j]
            stored += 0.5 * elements[j].line.inertance * flow * flow
    return stored


@kernel
def _show_way(row, state, nodes, elements, sample):
    n, m = len(nodes), len(elements)
    own = PER_NODE * n
    sample.drawn = state[own + 2 * m + row.first]
    sample.returned = state[own + 2 * m + row.last - 1]
    first = elements[row.first]
    drop = node_pressure(state[first.inlet], state[n + first.inlet], nodes[first.inlet]) \
        - node_pressure(state[first.outlet], state[n + first.outlet], nodes[first.outlet])
    sample.pump_flow = element_flow(drop, state[own + row.first], first)
    stored = 0.0
    lost = state[own + m + row.tear] if row.tear >= 0 else 0.0
    for j in range(row.first, row.last):
        lost += state[own + m + j]
        if elements[j].law == OF_LINE:
            flow = state[own + j]
            stored += 0.5 * elements[j].line.inertance * flow * flow
    for i in range(row.inner, row.inner_last):
        stored += node_energy(state[i], state[n + i], nodes[i])
        lost -= state[3 * n + i]        # of oil whose compressibility has changed
    if first.law == OF_PUMP:
        sample.pump_energy = -lost
    else:
        sample.relief_energy = lost
    sample.stored_energy = stored
    if first.law == OF_ORIFICE:
        sample.dump_opening = state[own + row.first]


@kernel
def _show_place(row, state, rates, nodes, elements, sample):
    n, m = len(nodes), len(elements)
    i = row.inlet
    node, pressure = nodes[i], sample.pressure
    stored = node_energy(state[i], state[n + i], node)
    if node.gas.amount > 0.0:
        stored -= gas_energy(gas_volume(pressure, state[n + i], node), state[n + i], node.gas)
    lost = 0.0
    for j in range(row.first, row.last):
        lost += state[PER_NODE * n + m + j]
    if node.is_held <= 0.0 and node.gas.amount <= 0.0:
        lost -= state[3 * n + i]
    sample.pump_flow = rates[i]
    sample.relief_energy = lost
    sample.stored_energy = stored


@kernel
def _oil_of_place(node, state, oil, into_gas, elements, sample):
    """Write the oil that has come to a manifold or the tank, and gone."""
    m = len(elements)
    through = len(state) - 2 * m
    entered, left = oil[1, node] + max(0.0, -into_gas), oil[0, node] + max(0.0, into_gas)
    for j in range(m):
        flowed = state[through + j]
        if elements[j].inlet == node:
            entered, left = entered + max(0.0, -flowed), left + max(0.0, flowed)
        elif elements[j].outlet == node:
            entered, left = entered + max(0.0, flowed), left + max(0.0, -flowed)
    sample.drawn, sample.returned = entered, left


@kernel
def _show_whole(row, state, nodes, elements, is_return, whole):
    """Write flow of the pumps, energy given and lost, and the opening of the first dump valve."""
    n, m = len(nodes), len(elements)
    own = PER_NODE * n
    whole.pump_flow, whole.pump_energy, whole.relief_energy = 0.0, 0.0, 0.0
    whole.return_energy = 0.0
    for j in range(m):
        if elements[j].law == OF_PUMP:
            element = elements[j]
            whole.pump_flow += element_flow(
                node_pressure(state[element.inlet], state[n + element.inlet],
                              nodes[element.inlet])
                - node_pressure(state[element.outlet], state[n + element.outlet],
                                nodes[element.outlet]), state[own + j], element)
            whole.pump_energy -= state[own + m + j]
        elif is_return[j]:
            whole.return_energy += state[own + m + j]
        else:
            whole.relief_energy += state[own + m + j]
    for i in range(n):
        if nodes[i].is_held > 0.0:
            whole.return_energy += nodes[i].p_held * state[i] + state[3 * n + i]
        else:
            whole.relief_energy -= state[3 * n + i]
    if row.last > 0:
        whole.dump_opening = state[own + row.first]


@kernel
def show(own):
    """
    Write the samples of a circuit at the end of a tick; what concerns actuators is there.

    ``own`` is a `ShownRows` of `isa_ros.surroundings.circuits.ticking`.
    """
    rows, samples, of = own.rows, own.samples, own.flowing
    at_rest, gas, oil = own.at_rest, own.gas, own.oil
    state, nodes, elements = of.state, of.nodes, of.elements
    n = len(nodes)
    for k in range(len(rows)):
        row, sample = rows[k], samples[k]
        sample.pressure = node_pressure(state[row.inlet], state[n + row.inlet], nodes[row.inlet])
        sample.return_pressure = node_pressure(
            state[row.outlet], state[n + row.outlet], nodes[row.outlet])
        if row.kind == OF_WAY:
            _show_way(row, state, nodes, elements, sample)
        elif row.kind == OF_PLACE:
            _show_place(row, state, of.rates, nodes, elements, sample)
            i = row.inlet
            _oil_of_place(i, state, oil, gas[i] - gas_volume(
                sample.pressure, state[n + i], nodes[i]), elements, sample)
        elif row.kind == OF_GAS:
            node, theta = nodes[row.inlet], state[n + row.inlet]
            sample.gas_temperature = theta - ICE
            sample.relief_energy = -state[3 * n + row.inlet]
            volume = gas_volume(sample.pressure, theta, node)
            sample.drawn = max(0.0, gas[row.inlet] - volume)
            sample.returned = max(0.0, volume - gas[row.inlet])
            sample.stored_energy = gas_energy(volume, theta, node.gas)
    samples[0].stored_energy = stored_in(state, nodes, elements)
    for k in range(len(rows)):
        samples[k].stored_energy -= at_rest[k]
    _show_whole(rows[0], state, nodes, elements, own.is_return, samples[0])
