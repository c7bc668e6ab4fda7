"""Circuits from the text that a run file would have."""

from isa_ros.config.text.parameter_sets import build_one_of
from isa_ros.config.text.sections import Place, written
from isa_ros.config.text.yaml_text import parse
from isa_ros.surroundings.circuits.circuit import Circuit
from isa_ros.surroundings.circuits.fed import Fed
from isa_ros.surroundings.circuits.network import circuit_advance, WORK_ROWS
from isa_ros.surroundings.circuits.nodes import node_content, node_pressure
from isa_ros.surroundings.circuits.plan import Network, network_of
from isa_ros.surroundings.circuits.sheet import CircuitSupply
from isa_ros.surroundings.supply import SupplySheet
import numpy as np

MS = 1_000_000
SLOPE = 1e-12       # m3/s/Pa, of a small valve
PLACE = Place('station.yaml')
SIMPLE = """
tank: {kind: tank}
pump: {kind: pump, inlet: tank, outlet: main, pressure_mpa: 20.0, displacement_ml: 10.0,
       speed_rpm: 1500.0, leakage_lpm_per_mpa: 0.1}
main: {kind: manifold, oil_volume_l: 0.5}
"""


def sheet_of(parts: str, **values: object) -> CircuitSupply:
    """Return the sheet of a circuit with these parts, and other sections."""
    tree = {'kind': 'circuit', 'parts': parse(parts, PLACE.file), **values}
    sheet = build_one_of(SupplySheet, written(tree, PLACE), PLACE)
    assert isinstance(sheet, CircuitSupply)
    return sheet


def circuit_of(parts: str, *fed: str, **values: object) -> Circuit:
    """Return a circuit that feeds manifolds, on ticks of a millisecond."""
    return Circuit(sheet_of(parts, **values), MS, [Fed(place, SLOPE) for place in fed])


class Bench:
    """The network of a circuit alone, with any flows from its places."""

    def __init__(self, parts: str, **values: object) -> None:
        self.network: Network = network_of(sheet_of(parts, **values))
        n, m = len(self.network.nodes), len(self.network.elements)
        self.n, self.m = n, m
        self.state = np.zeros(4 * n + 4 * m)
        self.state[n:2 * n] = self.network.nodes['gas']['theta_a']
        self.drawn = np.zeros(n)
        self._work = np.zeros((WORK_ROWS, len(self.state)))

    def put(self, place: str, pressure: float) -> None:
        """Put a place, and the nodes within a line of this name, at a pressure."""
        for k in self.network.inner(place):
            self.state[k] = node_content(
                pressure, self.state[self.n + k], self.network.nodes[k])

    def pressure(self, place: str) -> float:
        """Return the pressure of a place."""
        k = self.network.node(place)
        return float(node_pressure(self.state[k], self.state[self.n + k], self.network.nodes[k]))

    def own(self, part: str) -> slice:
        """Return where the own states of a part are."""
        of = self.network.of(part)
        return slice(4 * self.n + of[0], 4 * self.n + of[-1] + 1)

    def advance(self, steps: int, h: float) -> None:
        """Advance by steps of h s."""
        circuit_advance(steps, h, self.drawn, self.network.nodes, self.network.elements,
                        self.state, self._work)
