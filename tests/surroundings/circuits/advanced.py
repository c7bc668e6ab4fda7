"""A circuit by itself, advanced by what actuators would draw at its nodes."""

from collections.abc import Sequence
from functools import cache

from isa_ros.core.bound import Bound
from isa_ros.core.signals import LOAD_REPLY, SUPPLY_REPLY
from isa_ros.surroundings.circuits import ticking
from isa_ros.surroundings.circuits.circuit import Circuit
import numpy as np


def advance(circuit: Circuit, drawn: Sequence[float], returned: Sequence[float],
            paid: Sequence[float] | None = None) -> None:
    """
    Advance by one tick in which these volumes were drawn at its nodes and returned, m3.

    ``paid`` is the energy that the actuators counted for them, J: the integral of P q over the
    tick; None: they paid the pressures of its start.
    """
    replies, answers, held, moved = _alone(circuit)
    replies['supply_volume'], replies['return_volume'] = drawn, returned
    if paid is None:
        held.run()
    else:
        answers['paid'] = paid
        moved.run()
    circuit.settle()


@cache
def _alone(circuit: Circuit) -> tuple[np.ndarray, np.ndarray, Bound, Bound]:
    """Return a row for each node, and what advances with them, held or paid."""
    n = len(circuit._fed)
    replies, answers = np.zeros(n, LOAD_REPLY), np.zeros(n, SUPPLY_REPLY)
    groups = circuit._groups([[k] for k in range(n)], [()] * n)
    held, moved = (Bound(ticking.advance, ticking.CircuitTick(
        circuit._shown, groups, circuit._is_due, replies, own)) for own in (answers[:0], answers))
    return replies, answers, held, moved
