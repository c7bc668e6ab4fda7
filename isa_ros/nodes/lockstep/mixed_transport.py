"""Transport to actuators in the coordinator's process and controllers in other processes."""

from collections.abc import Sequence

from isa_ros.nodes.lockstep.coordinator_end import LockstepTransport
from isa_ros.tick.exchange import IDLE_S, Rows
from isa_ros.tick.in_process import InProcess


class MixedTransport:
    """A `Transport` to both; controllers compute while the actuators advance."""

    def __init__(self, actuators: InProcess, controllers: LockstepTransport) -> None:
        self._actuators = actuators
        self._controllers = controllers
        self.group = actuators.group
        self.is_quiet, self.ends = False, None
        self.send = controllers.send

    def join(self, rows: Rows) -> None:
        """Start the actuators, then wait for the controllers."""
        self._actuators.join(rows)
        self._controllers.join(rows)

    def restore(self, tick: int, snapshots: Sequence[bytes], rows: Rows) -> None:
        """Restore every participant from its snapshot."""
        self._controllers.restore(tick, snapshots, rows)
        self._actuators.restore(tick, snapshots[:len(rows.replies)], rows)

    def begin(self) -> None:
        """Begin the run of the controllers."""
        self._actuators.begin()
        self._controllers.begin()

    def receive(self, rows: Rows) -> None:
        """Advance the actuators, then wait for the controllers."""
        self._actuators.receive(rows)
        self._controllers.receive(rows)

    def idle(self, seconds: float = IDLE_S) -> None:
        """Wait for a moment while the run waits."""
        self._actuators.idle(seconds)
        self._controllers.idle(seconds)

    def snapshots(self) -> list[bytes]:
        """Return the complete state of each participant."""
        return [*self._actuators.snapshots(), *self._controllers.snapshots()]
