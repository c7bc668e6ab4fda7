"""Actuators in the coordinator's process, controllers in their own."""

from collections.abc import Sequence

from isa_ros.nodes.lockstep.coordinator_end import LockstepTransport
from isa_ros.run.exchange import Messages, Rows
from isa_ros.run.in_process import LocalTransport


class MixedTransport:
    """A `Transport` of both; controllers work while the actuators are called."""

    def __init__(self, actuators: LocalTransport, controllers: LockstepTransport) -> None:
        self._actuators = actuators
        self._controllers = controllers
        self.publish = actuators.publish
        self.publish_clock = actuators.publish_clock
        self.publish_event = actuators.publish_event
        self.send = controllers.send

    def join(self, rows: Rows) -> Sequence[Messages]:
        """Start the actuators, then wait for the controllers."""
        return [*self._actuators.join(rows), *self._controllers.join(rows)]

    def restore(
            self, tick: int, snapshots: Sequence[bytes], rows: Rows) -> Sequence[Messages]:
        """Put everyone where the snapshots were taken and return the messages of then."""
        controllers = self._controllers.restore(tick, snapshots, rows)
        return [*self._actuators.restore(tick, snapshots[:len(rows.replies)], rows), *controllers]

    def begin(self) -> None:
        """Publish the first messages of the actuators."""
        self._actuators.begin()
        self._controllers.begin()

    def receive(self, rows: Rows) -> Sequence[Messages]:
        """Advance the actuators, then wait for the controllers."""
        actuators = self._actuators.receive(rows)
        return [*actuators, *self._controllers.receive(rows)]

    def idle(self) -> None:
        """Pass a moment in which the run is paused."""
        self._actuators.idle()
        self._controllers.idle()

    def snapshots(self) -> list[bytes]:
        """Return the state of everyone."""
        return [*self._actuators.snapshots(), *self._controllers.snapshots()]
