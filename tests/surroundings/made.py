"""Surroundings of a run whose actuators stand still."""

from isa_ros.config.assembly import surroundings_of
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY
from isa_ros.surroundings.surroundings import Surroundings
import numpy as np


class Standing(Surroundings):
    """Surroundings that are advanced without any oil drawn."""

    def tick(self) -> float:
        """Advance one tick; return the supply pressure that the first actuator had, Pa."""
        n = sum(len(own.rows) for own in self.circuits)
        ports = np.zeros(n, LOAD_PORT)
        self.ports(ports)
        self.advance(np.zeros(n, LOAD_REPLY))
        return float(ports['supply_pressure'][0])


def surroundings_with(run: RunConfig) -> Standing:
    """Return the surroundings of a run."""
    made = surroundings_of(run)
    made.__class__ = Standing
    assert isinstance(made, Standing)
    return made
