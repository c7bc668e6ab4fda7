"""The supplies of a run as they are made: one supply or circuit, and the actuators it feeds."""

from collections.abc import Sequence
from typing import NamedTuple

from isa_ros.surroundings.circuits.circuit import Circuit
from isa_ros.surroundings.circuits.fed import Fed
from isa_ros.surroundings.circuits.sheet import CircuitSupply
from isa_ros.surroundings.supply import Supply, SupplySheet
import numpy as np


class SupplyCircuit(NamedTuple):
    """One supply and the actuators it feeds."""

    name: str
    """Name of the supply for controllers and in errors."""
    sheet: SupplySheet
    rows: Sequence[int]
    """Rows of the fed actuators."""
    flow_slope: float
    """Sum of their valves' largest dQ/dP, m3/s/Pa."""
    fed: Sequence[Fed] = ()
    """Of a circuit its manifolds that feed them."""

    @property
    def groups(self) -> Sequence[Sequence[int]]:
        """Return the rows that each of its nodes feeds."""
        return [own.rows for own in self.fed] or [self.rows]


def n_samples(sheet: SupplySheet) -> int:
    """Return the number of samples of a supply: its own, of a circuit also those of its parts."""
    return 1 + len(sheet.by_name) if isinstance(sheet, CircuitSupply) else 1


def made(own: SupplyCircuit, step_ns: int, samples: np.ndarray) -> Supply | Circuit:
    """Return a supply or circuit over a run, whose samples are these rows."""
    if isinstance(own.sheet, CircuitSupply):
        return Circuit(own.sheet, step_ns, own.fed, samples, own.name)
    return Supply(own.sheet, step_ns, own.flow_slope, samples, own.name, own.rows)
