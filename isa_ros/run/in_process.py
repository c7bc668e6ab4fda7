"""All actuators of a run in this process."""

from collections.abc import Sequence
import time
from typing import Protocol

from isa_ros.actuator.group import ActuatorGroup
from isa_ros.core.record import floats
from isa_ros.core.signals import Records
from isa_ros.errors import ConfigError
from isa_ros.run.exchange import IDLE_S, Rows


class Input(Protocol):
    """Input of setpoints and requests of one actuator: its node."""

    def serve(self) -> None:
        """Process the setpoints and requests that have arrived; do not wait."""
        ...


class InProcess:
    """
    A `Transport` to the actuators of a group, which advance together.

    ``starts`` are their `START` rows, (n,); ``inputs`` has one entry per actuator, or none.
    """

    def __init__(
            self, group: ActuatorGroup, starts: Records, inputs: Sequence[Input] = ()) -> None:
        self._group = group
        self._starts = starts
        self._inputs = inputs
        self._replies, self._samples = floats(group.replies), floats(group.observed)

    def join(self, rows: Rows) -> None:
        """Start all at t = 0."""
        self._group.start(self._starts)
        self._fill(rows)

    def restore(self, tick: int, snapshots: Sequence[bytes], rows: Rows) -> None:
        """Restore all actuators from their snapshots."""
        actuators = self._group.actuators
        if len(snapshots) != len(actuators):
            raise ConfigError(
                f'the saved state has {len(snapshots)} participants, the run has '
                f'{len(actuators)}')
        for actuator, own in zip(actuators, snapshots):
            actuator.restore(own)
        self._fill(rows)

    def begin(self) -> None:
        """Do nothing: the narrator publishes for all actuators."""

    def send(self, tick: int, rows: Rows) -> None:
        """Do nothing: `receive` advances the actuators."""

    def receive(self, rows: Rows) -> None:
        """Process the inputs of each actuator and the tick's changes, then advance all."""
        for own in self._inputs:
            own.serve()
        for row, values in rows.changes.items():
            self._group.actuators[row].tune(values)
        self._group.advance(rows.ports, rows.commands)
        self._fill(rows)

    def idle(self, seconds: float = IDLE_S) -> None:
        """Process the inputs of each actuator, then wait."""
        for own in self._inputs:
            own.serve()
        time.sleep(seconds)

    def snapshots(self) -> list[bytes]:
        """Return the state of every actuator."""
        return [actuator.snapshot() for actuator in self._group.actuators]

    def _fill(self, rows: Rows) -> None:
        group = self._group
        rows.reply_values[:] = self._replies
        rows.sample_values[:] = self._samples
        rows.applied[:] = group.applied
        rows.sent[:] = group.sent
        rows.tuned = group.tuned
