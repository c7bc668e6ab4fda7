"""The kernels of a circuit's tick over its memory."""

from isa_ros.surroundings.circuits.network import circuit_advance, circuit_rates, WORK_ROWS
from isa_ros.surroundings.circuits.nodes import feeding_capacity
from isa_ros.surroundings.circuits.slopes import inflow_slope, inflow_trend
from isa_ros.surroundings.supply_port import FedNode
import numpy as np
import pytest
from tests.surroundings.circuits.advanced import advance
from tests.surroundings.circuits.sheets import circuit_of, sheet_of
from tests.surroundings.circuits.station import driven, LPM, STATION

FED = ('left', 'right')


def moved():
    """Return a circuit in motion."""
    circuit = circuit_of(STATION, *FED)
    driven(circuit, 7, np.random.default_rng(3))
    return circuit


def test_it_says_of_its_nodes_what_their_equations_are():
    circuit = moved()
    network, state, n = circuit._network, circuit.state, len(circuit._network.nodes)
    pressures, rates = np.zeros(len(state)), np.zeros(len(state))
    circuit_rates(state, np.zeros(n), network.nodes, network.elements, pressures, rates)
    pressures = pressures[:n].copy()
    expected = [FedNode(
        pressures[k], feeding_capacity(pressures[k], state[n + k], network.nodes[k]), rates[k],
        inflow_slope(k, state, pressures, network.elements),
        inflow_trend(k, state, rates, pressures, network.nodes, network.elements))
        for k in map(network.node, FED)]
    assert circuit.nodes() == expected
    assert len({value for own in expected for value in own}) == 10


def test_a_tick_is_that_many_steps_with_the_mean_flows():
    circuit = moved()
    network, state, n = circuit._network, circuit.state.copy(), len(circuit._network.nodes)
    flows = np.zeros(n)
    for place, flow in zip((*FED, 'drain'), (4.0 * LPM, 3.0 * LPM, -5.0 * LPM)):
        flows[network.node(place)] = flow
    state[2 * n:3 * n] = 0.0
    steps = circuit._steps
    circuit_advance(steps, 1e-3 / steps, flows, network.nodes, network.elements, state,
                    np.zeros((WORK_ROWS, len(state))))
    advance(circuit, [4e-3 * LPM, 3e-3 * LPM], [2e-3 * LPM, 3e-3 * LPM])
    # A division by the tick and a sum are rounded, which the gas repeats.
    assert circuit.state == pytest.approx(state, rel=1e-9, abs=1e-15)
    assert steps > 10


def test_a_change_takes_effect_at_once():
    """In what shows and advances it too."""
    circuit = moved()
    before, shown = circuit.nodes(), circuit.samples['pump_flow'].copy()
    circuit.change(sheet_of(STATION.replace(
        'oil_volume_l: 0.3', 'leakage_lpm_per_mpa: 0.1, oil_volume_l: 0.6')))
    left, right = circuit.nodes()
    assert left.capacity > 1.8 * before[0].capacity and right == before[1]
    at = circuit._row_of['left']
    assert circuit.samples['pump_flow'][at] < shown[at] - 0.5 * LPM
    other = moved()
    for each in (circuit, other):
        advance(each, [0.0, 0.0], [0.0, 0.0])
    assert abs(circuit.nodes()[0].pressure - other.nodes()[0].pressure) > 1e3
