"""All actuators of a run in this process."""

from collections.abc import Sequence
import time
from typing import Protocol

from isa_ros.actuator.group import ActuatorGroup
from isa_ros.core.bound import Part
from isa_ros.core.signals import Records
from isa_ros.errors import ConfigError
from isa_ros.tick.exchange import Ends, IDLE_S, Rows


class Input(Protocol):
    """Input of setpoints and requests of one actuator: its node."""

    def serve(self) -> None:
        """Process the setpoints and requests that have arrived; do not wait."""
        ...

    @property
    def is_commanded(self) -> bool:
        """Return whether somebody is there who may send setpoints."""
        ...


class GroupEnds:
    """The actuators of a group in quiet ticks."""

    def __init__(self, group: ActuatorGroup) -> None:
        self._group = group
        self.parts = (Part(group.tick, group.refuse),)

    @property
    def is_settled(self) -> bool:
        """Return whether no parameter changed at the last tick, or changes at the next."""
        return self._group.is_settled

    def begin_quiet(self, tick: int) -> None:
        """Set the clock of the actuators."""
        self._group.set_clock()

    def end_quiet(self, tick: int, n_ticks: int, place: int) -> bool:
        """Move the time of the actuators on; a tick that they have begun has passed."""
        self._group.pass_ticks(n_ticks + (place >= 0))
        return False


class InProcess:
    """
    A `Transport` to the actuators of a group, which advance together.

    ``starts`` are their `START` rows, (n,); ``inputs`` has one entry per actuator, or none. The
    rows of the run are those of the group.
    """

    def __init__(
            self, group: ActuatorGroup, starts: Records, inputs: Sequence[Input] = ()) -> None:
        self.group = group
        self.ends: Ends | None = GroupEnds(group)
        self._starts = starts
        self._inputs = inputs

    @property
    def is_quiet(self) -> bool:
        """Return whether nobody is there who may send setpoints."""
        return not any(own.is_commanded for own in self._inputs)

    def join(self, rows: Rows) -> None:
        """Start all at t = 0."""
        self.group.start(self._starts)
        rows.tuned = {}

    def restore(self, tick: int, snapshots: Sequence[bytes], rows: Rows) -> None:
        """Restore all actuators from their snapshots."""
        if len(snapshots) != len(self.group.actuators):
            raise ConfigError(
                f'the saved state has {len(snapshots)} participants, the run has '
                f'{len(self.group.actuators)}')
        for actuator, own in zip(self.group.actuators, snapshots):
            actuator.restore(own)
        rows.tuned = self.group.tuned

    def begin(self) -> None:
        """Do nothing: a sink of the rows publishes for all actuators."""

    def send(self, tick: int, rows: Rows) -> None:
        """Do nothing: the actuators advance in `receive`."""

    def receive(self, rows: Rows) -> None:
        """Process the inputs of each actuator and the tick's changes, then advance all."""
        group = self.group
        for own in self._inputs:
            own.serve()
        for row, values in rows.changes.items():
            group.actuators[row].tune(values)
        group.advance(rows.ports, rows.commands)
        rows.tuned = group.tuned

    def idle(self, seconds: float = IDLE_S) -> None:
        """Process the inputs of each actuator, then wait."""
        for own in self._inputs:
            own.serve()
        time.sleep(seconds)

    def snapshots(self) -> list[bytes]:
        """Return the state of every actuator."""
        return [actuator.snapshot() for actuator in self.group.actuators]
