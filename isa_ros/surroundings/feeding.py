"""The supplies of a run as they are made: one supply or circuit, and the actuators it feeds."""

from collections.abc import Sequence
from typing import NamedTuple

from isa_ros.core.signals import Records
from isa_ros.surroundings.circuits.circuit import Circuit
from isa_ros.surroundings.circuits.fed import Fed, OwnHeat
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


def advance_circuit(
        supply: Circuit, groups: Sequence[Sequence[int]], replies: Records,
        answers: Records | None) -> None:
    """
    Advance a circuit by a tick with the `LOAD_REPLY` of all actuators, those it feeds by node.

    ``answers`` are their `SUPPLY_REPLY`; None: they held the pressures.
    """
    drawn, returned = (replies[name].tolist() for name in ('supply_volume', 'return_volume'))
    oil = ([summed(drawn, rows) for rows in groups], [summed(returned, rows) for rows in groups])
    if answers is None:
        supply.advance_held(*oil)
        return
    paid, heat = answers['paid'].tolist(), answers['heat'].tolist()
    supply.advance_nodes(
        oil[0], [summed(paid, rows) for rows in groups], oil[1],
        [OwnHeat(*(summed(values, own.heated) for values in (paid, returned, heat)))
         for own in supply.fed])


def summed(values: Sequence[float], rows: Sequence[int]) -> float:
    """Return the sum in the order of the rows; `sum` of Python 3.12 rounds differently."""
    total = 0.0
    for row in rows:
        total += values[row]
    return total
