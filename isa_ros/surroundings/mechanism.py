"""Any simulator as two functions of a state: how it moves now, and its state after a tick."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol, runtime_checkable

from isa_ros.core.timebase import NS_PER_SECOND
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Mounting(NamedTuple):
    """What a factory of bodies is called with: the k actuators of the body, and the run's tick."""

    names: Sequence[str]
    """Of the actuators, in the order of the run file's list; so are all arrays of k."""
    rows: NDArray[np.int64]
    """Their places among the actuators of the run, (k,)."""
    positions: Floats
    """Where pistons or rotors are at t = 0, ``initial_position_mm`` or ``_deg``: m | rad, (k,)."""
    are_rotary: Sequence[bool]
    step: float
    """The tick, s."""
    seed: int
    """Of the run's noise."""

    @property
    def step_ns(self) -> int:
        """Return the tick in ns."""
        return round(self.step * NS_PER_SECOND)


class Motion(NamedTuple):
    """How a mechanism with k actuators and n speeds moves at one instant."""

    position: Floats
    """Of the load's side of each force sensor, m | rad, (k,)."""
    velocity: Floats
    """m/s | rad/s, (k,)."""
    acceleration: Floats
    """x'' = J q'' + J' q', m/s2 | rad/s2, (k,)."""
    generalised: Floats | None = None
    """q'' in the mechanism's own speeds, (n,); only for stiffness and damping."""


@runtime_checkable
class Mechanism(Protocol):
    """
    Any simulator as functions of a state; no call changes it.

    A state is an array of floats with all that the next step depends on, the warm start of a
    solver too. A force pushes its actuator out if it is > 0, N | Nm.
    """

    @property
    def state(self) -> Floats:
        """Return the state at t = 0, (s,)."""
        ...

    def motion(self, state: Floats, forces: Floats) -> Motion:
        """Return how it moves under constant forces (k,)."""
        ...

    def stepped(self, state: Floats, forces: Floats, seconds: float) -> Floats:
        """
        Return the state after ``seconds``, one tick, in any number of own steps.

        ``forces`` are (5, k): each row for a fifth of the tick; a simulator whose own step is
        the tick takes their mean.
        """
        ...


class DisplaceableMechanism(Mechanism, Protocol):
    """A mechanism whose stiffness and damping are asked for."""

    def displaced(self, state: Floats, dq: Floats, dv: Floats) -> Floats:
        """Return the state moved by dq and made faster by dv, (n,) in its own coordinates."""
        ...
