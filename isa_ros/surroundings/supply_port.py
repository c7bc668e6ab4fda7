"""
The supply's port: what an actuator knows of its supply, so that the pressure moves in its tick.

A supply with little oil behind many chambers does not hold its pressure over a tick: the chambers
behind open valves take more oil than there is. Each actuator then integrates the capacity of its
supply, with what the others do at a pressure that moves, and the supply advances over the same
tick with the volumes drawn. Flows into the supply's node are positive. Equation C15.
"""

from typing import NamedTuple, Protocol


class FedNode(NamedTuple):
    """
    What a supply or a circuit says of a node that feeds actuators, at the start of a tick.

    ``inflow`` is that of all else at the node than its actuators: pump less relief and leak, and
    of lines and accumulators. Relief and lines that the pressure itself changes within a tick
    have their ``slope``, what changes by itself its ``trend``.
    """

    pressure: float
    """P at the start of the tick, Pa gauge."""
    capacity: float
    """C of the oil and gas right at the node, dV/dP, m3/Pa."""
    inflow: float
    """Net flow of all else into the node at that pressure, m3/s."""
    slope: float
    """By how much the inflow falls with the pressure of the node, -dq/dP >= 0, m3/s/Pa."""
    trend: float = 0.0
    """Slope of the inflow over time at a constant pressure, m3/s2: inertance, lag of a pump."""


class PortedSupply(Protocol):
    """A supply or circuit that has a port; its nodes in the order of what it feeds."""

    def nodes(self) -> list[FedNode]:
        """Return its nodes at the start of the next tick."""
        ...

    def advance_nodes(self, drawn: list[float], paid: list[float], returned: list[float]) -> None:
        """
        Advance by one tick in which these volumes were drawn at its nodes, m3.

        ``paid`` is the energy that the actuators counted for them, J: the integral of P q over
        the tick. ``returned`` are the volumes given to the return, m3.
        """
        ...
