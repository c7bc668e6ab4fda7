"""All actuators of a run in this process."""

from collections.abc import Sequence
import time
from typing import Protocol

from isa_ros.errors import ConfigError
from isa_ros.run.exchange import floats, IDLE_S, Messages, Records, Rows, Voice
from isa_ros.run.group import ActuatorGroup


class Outlet(Protocol):
    """Where one actuator meets whoever listens and asks: its node."""

    def publish(self, applied: Messages, states: Messages) -> None:
        """Publish the messages of an instant."""
        ...

    def serve(self) -> None:
        """Take the setpoints and requests that have arrived; do not wait."""
        ...


class LocalTransport:
    """
    The actuators of a group, ticked together.

    ``starts`` are their `START` rows, (n,); ``outlets`` one of each, or none at all.
    """

    def __init__(
            self, group: ActuatorGroup, starts: Records, voice: Voice,
            outlets: Sequence[Outlet] = ()) -> None:
        self._group = group
        self._starts = starts
        self._outlets = outlets
        self.publish = voice.publish
        self.publish_clock = voice.publish_clock
        self.publish_event = voice.publish_event
        self._applied: list[Messages] = []
        self._replies, self._samples = floats(group.replies), floats(group.samples)

    def join(self, rows: Rows) -> Sequence[Messages]:
        """Start everyone and return the messages of t = 0."""
        return self._say(rows, [
            member.start(start) for member, start in zip(self._group.members, self._starts)])

    def restore(
            self, tick: int, snapshots: Sequence[bytes], rows: Rows) -> Sequence[Messages]:
        """Put everyone where the snapshots were taken and return the messages of then."""
        members = self._group.members
        if len(snapshots) != len(members):
            raise ConfigError(
                f'the saved state has {len(snapshots)} participants, the run has {len(members)}')
        return self._say(rows, [
            member.restore(own) for member, own in zip(members, snapshots)])

    def begin(self) -> None:
        """Publish the first messages of everyone."""
        self._publish(self._group.states())

    def send(self, tick: int, rows: Rows) -> None:
        """Leave the work to `receive`."""

    def receive(self, rows: Rows) -> Sequence[Messages]:
        """Let everyone take its inputs, then advance all."""
        for outlet in self._outlets:
            outlet.serve()
        for k, kinds in enumerate(rows.commands['kinds'].tolist()):
            if kinds:
                self._group.members[k].actuator.accept(rows.commands[k])
        said = self._say(rows, self._group.advance(rows.ports))
        self._publish([messages[len(self._applied[0]):] for messages in said])
        return said

    def idle(self) -> None:
        """Listen to whoever asks something of an actuator."""
        for outlet in self._outlets:
            outlet.serve()
        time.sleep(IDLE_S)

    def snapshots(self) -> list[bytes]:
        """Return the state of every actuator."""
        return [member.actuator.snapshot() for member in self._group.members]

    def _say(self, rows: Rows, applied: list[Messages]) -> list[Messages]:
        """Fill replies and samples, and return all messages of this instant."""
        self._applied = applied
        rows.reply_values[:] = self._replies
        rows.sample_values[:] = self._samples
        return [(*own, *states) for own, states in zip(applied, self._group.states())]

    def _publish(self, states: Sequence[Messages]) -> None:
        for outlet, applied, own in zip(self._outlets, self._applied, states):
            outlet.publish(applied, own)
