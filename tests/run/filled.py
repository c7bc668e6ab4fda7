"""Rows of a run in which every number is another one."""

from collections.abc import Mapping

from isa_ros.surroundings.bodies.leg.port_kernel import LEG_SAMPLE
from isa_ros.surroundings.supply_sample import SUPPLY_SAMPLE
from isa_ros.tick.exchange import Rows
import numpy as np


def rows(dtype: np.dtype, n: int) -> np.ndarray:
    """Return rows whose bytes all differ."""
    return np.frombuffer(bytes(k % 251 for k in range(n * dtype.itemsize)), dtype).copy()


LEG = {'leg': LEG_SAMPLE}


class Shows:
    """A body of which only its sample matters."""

    def __init__(self, record: np.dtype) -> None:
        self.sample = rows(record, 1)


class Outside:
    """Surroundings of which only what they show matters."""

    def __init__(self, n_supplies: int, bodies: Mapping[str, np.dtype]) -> None:
        self.supplies = rows(SUPPLY_SAMPLE, n_supplies)
        self.has_supply_ports = False
        self.bodies = {name: Shows(record) for name, record in bodies.items()}
        for k, body in enumerate(self.bodies.values()):
            body.sample.view(np.uint8)[:] += np.uint8(97 * k)   # no two alike


def filled(n: int, n_supplies: int = 1, bodies: Mapping[str, np.dtype] = LEG) -> Rows:
    """Return an exchange of ``n`` actuators whose bytes all differ."""
    made = Rows(n, Outside(n_supplies, bodies))
    for name in ('ports', 'commands', 'samples'):
        getattr(made, name)[:] = rows(getattr(made, name).dtype, n)
    return made
