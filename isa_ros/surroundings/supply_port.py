"""
The supply's port: what an actuator knows of its supply, so that the pressure moves in its tick.

A supply with little oil behind many chambers does not hold its pressure over a tick: the chambers
behind open valves take more oil than there is. Each actuator then integrates the capacity of its
supply, with what the others do at a pressure that moves, and the supply advances over the same
tick with the volumes drawn. Flows into the supply's node are positive. Equations C15 and C16.
"""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

from isa_ros.core.bound import Rebound
from isa_ros.core.frozen import frozen
from isa_ros.core.kernel import kernel_function
from isa_ros.core.parameter import Parameters
from isa_ros.core.signals import Records, SUPPLY_REPLY
import numpy as np
from numpy.typing import NDArray

PORT_STEPS = 4.0
"""Shortest time constant of a node behind wide-open valves, in plant steps  (C16)."""
ANSWER = np.dtype(SUPPLY_REPLY.descr[:-1])
"""What a saved state has of a `SUPPLY_REPLY`: the heat is used up in its tick."""


@frozen(kw_only=True)
class HeldPort(Parameters):
    """Actuators hold the pressure of the tick's start."""


@frozen(kw_only=True)
class MovingPort(Parameters):
    """The pressure moves within a tick: actuators integrate the capacity of the line."""


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


@kernel_function
def fill_feeds(node, rows, last, feeds):
    """
    Fill the `SUPPLY_PORT` of the actuators at a `FedNode`, by their ``rows``  (C15).

    ``last`` are the `SUPPLY_REPLY` of all actuators at the end of the last tick, zeros at t = 0.
    Each assumes that the others move as it does, by the conductances of their valves  (C16): N is
    the sum of all over its own, and at most their number, which is also what a shut valve gets.
    """
    drawn, total, most = 0.0, 0.0, float(len(rows))
    for row in rows:
        drawn += last[row]['flow']
        total += last[row]['conductance']
    for row in rows:
        own, feed = last[row]['conductance'], feeds[row]
        feed['elastance'] = 1.0 / node.capacity
        feed['inflow'] = node.inflow - drawn
        feed['trend'], feed['slope'] = node.trend, node.slope
        feed['share'] = total / own if total < most * own else most
        feed['flow'] = last[row]['flow']


class FeedingSupply(Protocol):
    """A supply or circuit that has a port."""

    @property
    def feeding(self) -> Rebound:
        """Return what fills its rows of the ports, given last answers and ports."""
        ...


class SupplyPorts:
    """The ports of the ``supplies`` of a run that have one; ``n_actuators`` are all its rows."""

    def __init__(self, n_actuators: int, supplies: Sequence[FeedingSupply]) -> None:
        self._supplies = supplies
        self.are_there = bool(supplies)
        """Whether a supply has one."""
        self.answers: Records = np.zeros(n_actuators if supplies else 0, SUPPLY_REPLY)
        """`SUPPLY_REPLY` of all actuators at the end of the last tick, (n_actuators,), or (0,)."""

    def fill(self, feeds: Records) -> None:
        """Fill the `SUPPLY_PORT` of the fed actuators for the next tick, (n_actuators,)."""
        for supply in self._supplies:
            supply.feeding.to(self.answers, feeds).run()

    def take(self, fed: Records | None) -> bool:
        """
        Keep the answers of a tick; return whether the pressures have moved in it.

        They were held where there are no ports, or they were not used.
        """
        if fed is None or not self.are_there:
            return False
        self.answers[:] = fed
        return True

    @property
    def nbytes(self) -> int:
        """Return the size of a `snapshot`."""
        return len(self.answers) * ANSWER.itemsize

    def snapshot(self) -> bytes:
        """Return the answers as `ANSWER`."""
        return self._numbers[:, :-1].tobytes()

    def restore(self, answers: Records) -> None:
        """Continue from the `ANSWER` of a `snapshot`, (n_actuators,) or (0,)."""
        self._numbers[:, :-1] = answers.view(np.float64).reshape(
            len(answers), ANSWER.itemsize // 8)

    @property
    def _numbers(self) -> NDArray[np.float64]:
        return self.answers.view(np.float64).reshape(-1, SUPPLY_REPLY.itemsize // 8)
