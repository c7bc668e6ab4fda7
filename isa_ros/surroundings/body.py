"""Interface of the body that several actuators move: a leg, a robot, another simulator."""

from collections.abc import Mapping
from typing import Any, Protocol, runtime_checkable

from isa_ros.core.bound import Rebound
from isa_ros.core.parameter import Parameters
import numpy as np
from numpy.typing import NDArray

Records = NDArray[np.void]
"""Rows of a record type, by default one per actuator of the run."""


class Body(Protocol):
    """
    A body that several actuators move: the other side of the load port (equation L1).

    One exchange per tick: the body fills the ports of its actuators, they advance by the tick,
    and the body advances over the same interval with their mean forces. Rows of actuators that
    do not move the body are left unchanged.
    """

    @property
    def rows(self) -> NDArray[np.int64]:
        """Return the rows of the actuators that move the body, (k,)."""
        ...

    @property
    def sample(self) -> Records:
        """
        Return the sample at the end of the last tick, (1,), a record of floats.

        Each kind of body has its own record type; the same memory is overwritten at every tick.
        """
        ...

    @property
    def units(self) -> Mapping[str, str]:
        """Return the unit of each field of the sample."""
        ...

    def starts(self, starts: Records) -> None:
        """
        Fill position and force of its actuators' `START` rows, (n_actuators,).

        The position is that of the load's side of the force sensor, m or rad; the force is that
        of the actuator at rest, N or Nm.
        """
        ...

    def ports(self, ports: Records) -> None:
        """Fill its actuators' `LOAD_PORT` rows for the next tick, except the pressures."""
        ...

    def advance(self, replies: Records) -> None:
        """
        Advance by one tick with the `LOAD_REPLY` rows of all actuators, (n_actuators,).

        Raises
        ------
        SimulationDiverged
            A state is no longer finite.

        """
        ...

    def snapshot(self) -> bytes:
        """Return the complete state; `restore` continues from it byte for byte."""
        ...

    def restore(self, snapshot: bytes) -> None:
        """Continue from a `snapshot` of a body of the same configuration."""
        ...


@runtime_checkable
class BoundBody(Protocol):
    """A body of kernels: what a compiled loop of ticks calls instead of `Body`."""

    @property
    def filling(self) -> Rebound:
        """Return what fills its rows of given ports for the next tick."""
        ...

    @property
    def advancing(self) -> Rebound:
        """Return what advances by one tick with given replies."""
        ...

    def refuse(self, found: int) -> None:
        """
        Take what `advancing` has returned; 0: nothing was found.

        Raises
        ------
        SimulationDiverged
            A state is no longer finite.
        RunError
            The body ends the run.

        """
        ...


@runtime_checkable
class SizedBody(Protocol):
    """A body whose snapshots say their size, which is not that of its own at present."""

    def saved_size(self, snapshot: bytes) -> int:
        """Return how many bytes of a snapshot, which begins with this body's, are its own."""
        ...


@runtime_checkable
class ChangingBody(Protocol):
    """A body with values that may change during a run, as a push."""

    @property
    def changing(self) -> Parameters:
        """Return the values as they are at its start."""
        ...

    def change(self, values: Any) -> None:
        """Take other values of the same set from the next tick on."""
        ...
