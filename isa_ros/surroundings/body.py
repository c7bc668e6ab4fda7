"""The body that actuators move together, as a run knows it: a leg, a robot, another simulator."""

from collections.abc import Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Records = NDArray[np.void]
"""Rows of a record type, one per actuator of the run where nothing else is said."""


class Body(Protocol):
    """
    A body that several actuators move, on the body's side of the load port (equation L1).

    One exchange a tick: the body fills the ports of its actuators, they advance by the tick,
    and the body advances over the same interval under their mean forces. Rows of actuators that
    do not move the body are left as they are.
    """

    @property
    def rows(self) -> NDArray[np.int64]:
        """Return the rows of the actuators that move it, (k,)."""
        ...

    @property
    def sample(self) -> Records:
        """
        Return what the body shows at the end of the last tick, (1,), a record of floats.

        The record type is the body's own; the memory stays the same and is overwritten.
        """
        ...

    @property
    def units(self) -> Mapping[str, str]:
        """Return the unit of each field of the sample."""
        ...

    def starts(self, starts: Records) -> None:
        """
        Fill position and force of its actuators' `START` rows, (n_actuators,).

        The position is that of the load's side of the force sensor, m or rad; the force is what
        the actuator carries at rest, N or Nm.
        """
        ...

    def ports(self, ports: Records) -> None:
        """Fill its actuators' `LOAD_PORT` rows for the next tick but for the pressures."""
        ...

    def advance(self, replies: Records) -> None:
        """
        Advance by one tick under the `LOAD_REPLY` rows of all actuators, (n_actuators,).

        Raises
        ------
        SimulationDiverged
            A state is no longer finite.

        """
        ...

    def snapshot(self) -> bytes:
        """Return the whole state; `restore` continues from it byte for byte."""
        ...

    def restore(self, snapshot: bytes) -> None:
        """Continue from a `snapshot` of a body of the same configuration."""
        ...
