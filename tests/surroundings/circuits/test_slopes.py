"""Slope and trend of a node's inflow against differences of the flows themselves."""

from collections.abc import Callable

from isa_ros.surroundings.circuits.network import (
    circuit_rates, element_flow, OF_CHECK, OF_LINE, OF_ORIFICE, OF_PUMP, OF_RELIEF)
from isa_ros.surroundings.circuits.nodes import node_capacity
from isa_ros.surroundings.circuits.slopes import flow_slope, inflow_slope, inflow_trend
import numpy as np
import pytest
from tests.surroundings.circuits.sheets import Bench
from tests.surroundings.circuits.station import STATION

LEAKING = STATION.replace(
    'rated_lpm: 60.0}\nstored', 'rated_lpm: 60.0, leakage_lpm_per_mpa: 0.5}\nstored').replace(
    'rated_lpm: 30.0}\nhose', 'rated_lpm: 30.0, leakage_lpm_per_mpa: 0.3}\nhose').replace(
    'lpm_per_mpa: 30.0}', 'lpm_per_mpa: 30.0, leakage_lpm_per_mpa: 0.2}')
STUCK = LEAKING.replace('leakage_lpm_per_mpa: 0.5}', 'leakage_lpm_per_mpa: 0.5, stuck_open: 1}')
HIGH = {'gallery': 22.7e6, 'stored': 21.1e6, 'left': 18.3e6, 'right': 16.9e6, 'drain': 0.9e6}
LOW = {'gallery': 15.2e6, 'stored': 16.4e6, 'left': 17.1e6, 'right': 19.7e6, 'drain': 0.3e6}
STEP = 10.0     # Pa: 1e-6 of the curvature of S at 20 kPa is below 1e-6


class Moment:
    """The flows of a circuit at some pressures, with openings between shut and open."""

    def __init__(self, parts: str, pressures: dict[str, float]) -> None:
        self.bench = Bench(parts)
        self.nodes, self.elements = self.bench.network.nodes, self.bench.network.elements
        for place, pressure in pressures.items():
            self.bench.put(place, pressure)
        n = self.bench.n
        self.own = slice(4 * n, 4 * n + self.bench.m)
        for j, element in enumerate(self.elements):
            scale = 1.0 if element['law'] == OF_ORIFICE else 2e-4
            self.state[4 * n + j] = scale * (0.2 + 0.03 * j)
        self.pressures, self.rates = np.zeros(n), np.zeros(len(self.state))
        circuit_rates(
            self.state, self.bench.drawn, self.nodes, self.elements, self.pressures, self.rates)

    @property
    def state(self) -> np.ndarray:
        return self.bench.state

    def inflow(self, node: int, pressures: np.ndarray, own: np.ndarray) -> float:
        """Return what flows into a node, m3/s."""
        total = 0.0
        for element, value in zip(self.elements, own):
            flow = element_flow(
                pressures[element['inlet']] - pressures[element['outlet']], value, element)
            total += flow * (float(element['outlet'] == node) - float(element['inlet'] == node))
        return total


CASES = [(LEAKING, HIGH), (LEAKING, LOW), (STUCK, LOW)]


@pytest.fixture(scope='module', params=CASES, ids=['high', 'low', 'stuck'])
def moment(request: pytest.FixtureRequest) -> Moment:
    return Moment(*request.param)


def central(function: Callable[[float], float], step: float) -> float:
    return (function(step) - function(-step)) / (2.0 * step)


def test_the_slope_of_a_part_is_that_of_its_flow(moment: Moment) -> None:
    """Of every law at the drop and the state that it has."""
    seen = set()
    for element, own in zip(moment.elements, moment.state[moment.own]):
        drop = moment.pressures[element['inlet']] - moment.pressures[element['outlet']]
        slope = flow_slope(drop, own, element)
        assert slope == pytest.approx(
            central(lambda e: element_flow(drop + e, own, element), STEP), rel=1e-5, abs=1e-18)
        seen.add((int(element['law']), slope > 0.0))
    assert {(OF_LINE, False), (OF_PUMP, True), (OF_ORIFICE, True), (OF_CHECK, True),
            (OF_RELIEF, True)} <= seen


def test_the_inflow_of_a_node_falls_by_its_slope(moment: Moment) -> None:
    own, largest = moment.state[moment.own], 0.0
    for node in range(moment.bench.n):
        at = np.arange(moment.bench.n) == node
        found = inflow_slope(node, moment.state, moment.pressures, moment.elements)
        assert found == pytest.approx(
            -central(lambda e: moment.inflow(node, moment.pressures + e * at, own), STEP),
            rel=1e-5, abs=1e-17)
        largest = max(largest, found)
    assert largest > 1e-11


def test_the_trend_of_an_inflow_is_that_at_a_constant_pressure(moment: Moment) -> None:
    """Others' pressures, lines and pumps move on; openings stand, as at the end of their way."""
    own, n, largest = moment.state[moment.own], moment.bench.n, 0.0
    moves = np.isin(moment.elements['law'], (OF_LINE, OF_PUMP))
    speed = np.where(moves, moment.rates[moment.own], 0.0)
    rise = np.array([0.0 if node['is_held'] > 0.0 else moment.rates[k] / node_capacity(
        moment.pressures[k], moment.state[n + k], node) for k, node in enumerate(moment.nodes)])
    for node in range(n):
        others = np.where(np.arange(n) == node, 0.0, rise)
        expected = central(
            lambda t: moment.inflow(node, moment.pressures + t * others, own + t * speed), 1e-9)
        found = inflow_trend(node, moment.state, moment.rates, moment.pressures, moment.nodes,
                             moment.elements)
        assert found == pytest.approx(expected, rel=1e-4, abs=1e-6)
        largest = max(largest, abs(found))
    assert largest > 1e-3
