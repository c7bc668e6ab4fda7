"""The arrays of a circuit's network, from its sheet: nodes, elements, and whose they are."""

from collections.abc import Sequence
from typing import NamedTuple

from isa_ros.core.units import LITRE, LPM, MPA
from isa_ros.surroundings.circuits.accumulator import AccumulatorPart, gas_fields
from isa_ros.surroundings.circuits.check import check_fields, CheckPart
from isa_ros.surroundings.circuits.line import capacity, LinePart, lump_fields, tear_fields
from isa_ros.surroundings.circuits.manifold import ManifoldPart, TankPart
from isa_ros.surroundings.circuits.network import (
    ELEMENT, OF_CHECK, OF_LINE, OF_ORIFICE, OF_PUMP, OF_RELIEF)
from isa_ros.surroundings.circuits.nodes import NODE
from isa_ros.surroundings.circuits.oil import oil_at_sheet, OilNow
from isa_ros.surroundings.circuits.orifice import orifice_fields
from isa_ros.surroundings.circuits.pump import pump_fields, PumpPart
from isa_ros.surroundings.circuits.relief import filter_fields, FilterPart, relief_fields
from isa_ros.surroundings.circuits.relief import ReliefPart
from isa_ros.surroundings.circuits.sheet import Between, CircuitSupply
import numpy as np

OUTSIDE = 0
"""Node of what has left the circuit."""


class Network(NamedTuple):
    """The network of a circuit; the same sheet with other values has the same places."""

    places: Sequence[str]
    """Of each node the name of its manifold or tank, or of the line that it is in; (n,)."""
    nodes: np.ndarray
    """`NODE`, (n,)."""
    owners: Sequence[str]
    """Of each element the name of its part, (m,)."""
    elements: np.ndarray
    """`ELEMENT`, (m,)."""

    def node(self, place: str) -> int:
        """Return the node of a manifold or the tank."""
        return self.places.index(place)

    def inner(self, part: str) -> list[int]:
        """Return the nodes within a line, or the one of a manifold or tank."""
        return [k for k, place in enumerate(self.places) if place == part]

    def of(self, part: str) -> list[int]:
        """Return the elements of a part, in the direction of its flow."""
        return [k for k, owner in enumerate(self.owners) if owner == part]


class _Drawing:
    """A network while it is drawn."""

    def __init__(self, sheet: CircuitSupply, oil: OilNow) -> None:
        self.sheet, self.oil = sheet, oil
        self.places: list[str] = ['']
        self.nodes: list[np.ndarray] = [_held(0.0)]
        self.owners: list[str] = []
        self.elements: list[np.ndarray] = []

    def add_node(self, place: str, c: float) -> int:
        node = np.zeros(1, NODE)
        node['c'] = c
        self.places.append(place)
        self.nodes.append(node)
        return len(self.nodes) - 1

    def add(self, owner: str, law: int, inlet: int, outlet: int, own: str,
            values: tuple[float, ...], senses: int = OUTSIDE) -> None:
        element = np.zeros(1, ELEMENT)
        element['law'], element['inlet'], element['outlet'] = law, inlet, outlet
        element['senses'] = senses
        element[own] = values
        self.owners.append(owner)
        self.elements.append(element)

    def add_line(self, name: str, part: LinePart, inlet: int, outlet: int) -> None:
        n, c = int(part.lumps), capacity(part, self.oil) / part.lumps
        for end in (inlet, outlet):
            self.nodes[end]['c'] += 0.5 * c
        ends = [inlet, *(self.add_node(name, c) for _ in range(n - 1)), outlet]
        for before, after in zip(ends, ends[1:]):
            self.add(name, OF_LINE, before, after, 'line', lump_fields(part, self.oil))

    def add_tear(self, name: str, part: LinePart) -> None:
        """Add where the wall of a line may tear: at its outlet, or the last node before a tank."""
        lumps = [k for k, owner in enumerate(self.owners) if owner == name]
        last = self.elements[lumps[-1]]
        at = int(last['outlet'][0])
        if self.nodes[at]['is_held'][0]:
            at = int(last['inlet'][0])
        c = float(self.nodes[at]['c'][0]) or 1.0      # of a line from tank to tank it is nothing
        self.add(name, OF_ORIFICE, at, OUTSIDE, 'orifice', tear_fields(
            part, self.oil, c))

    def add_between(self, name: str, part: Between) -> None:
        """Add a part between two places."""
        has_current = not self.sheet.dump.opened
        inlet, outlet = self.places.index(part.inlet), self.places.index(part.outlet)
        if isinstance(part, LinePart):
            self.add_line(name, part, inlet, outlet)
        elif isinstance(part, PumpPart):
            self.add(name, OF_PUMP, inlet, outlet, 'pump', pump_fields(
                part, has_current, self.oil.thickness))
        elif isinstance(part, CheckPart):
            self.add(name, OF_CHECK, inlet, outlet, 'check', check_fields(part))
        elif isinstance(part, ReliefPart):
            self.add(name, OF_RELIEF, inlet, outlet, 'relief', relief_fields(part))
        elif isinstance(part, FilterPart):
            self.add(name, OF_RELIEF, inlet, outlet, 'relief', filter_fields(part))
        else:
            senses = getattr(part, 'senses', None)
            self.add(name, OF_ORIFICE, inlet, outlet, 'orifice',
                     orifice_fields(part, has_current),
                     OUTSIDE if senses is None else self.places.index(senses))


def network_of(sheet: CircuitSupply, oil: OilNow | None = None) -> Network:
    """Return the network of a circuit with its oil at a temperature; None: as its section."""
    oil = oil_at_sheet(sheet.oil) if oil is None else oil
    drawing = _Drawing(sheet, oil)
    parts = sheet.by_name
    for name, part in parts.items():
        if isinstance(part, TankPart):
            drawing.places.append(name)
            drawing.nodes.append(_held(part.pressure_mpa * MPA))
        elif isinstance(part, ManifoldPart):
            drawing.add_node(name, part.oil_volume_l * LITRE / oil.bulk_modulus)
    for name, part in parts.items():
        if isinstance(part, Between):
            drawing.add_between(name, part)
        elif isinstance(part, AccumulatorPart):
            drawing.nodes[drawing.places.index(part.at)]['gas'] = gas_fields(part)
    for name, part in parts.items():
        if isinstance(part, LinePart):
            drawing.add_tear(name, part)
        elif isinstance(part, ManifoldPart):
            drawing.add(name, OF_RELIEF, drawing.places.index(name), OUTSIDE, 'relief', (
                part.leakage_lpm_per_mpa * LPM / MPA, 0.0, 0.0))
    return Network(drawing.places, np.concatenate(drawing.nodes), drawing.owners,
                   np.concatenate(drawing.elements))


def _held(pressure: float) -> np.ndarray:
    node = np.zeros(1, NODE)
    node['is_held'], node['p_held'], node['c'] = 1.0, pressure, 0.0
    return node
