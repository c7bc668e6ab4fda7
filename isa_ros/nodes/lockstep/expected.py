"""The participants that the coordinator expects, from the configuration of a run."""

from collections.abc import Sequence
from typing import NamedTuple

from isa_ros.core.signals import Records
from isa_ros.run.wire.roster import Roster


class Expected(NamedTuple):
    """One participant of the configuration."""

    name: str
    digest: str
    """Empty: not compared."""


class Limits(NamedTuple):
    """Longest waits for participants, s of host time."""

    join_s: float
    tick_s: float


class Participants(NamedTuple):
    """The participants of a run, and the initial state of the actuators."""

    expected: Sequence[Expected]
    """The actuators first, in file order, then the controllers."""
    roster: Roster
    starts: Records
    """`START` rows of the actuators, (n_actuators,)."""
    step_ns: int
    first_remote: int = 0
    """Index of the first participant in another process."""

    @property
    def has_controllers(self) -> bool:
        """Return whether there are others than actuators."""
        return len(self.expected) > len(self.starts)

    @property
    def remote(self) -> frozenset[int]:
        """Return the indices of those in other processes."""
        return frozenset(range(self.first_remote, len(self.expected)))
