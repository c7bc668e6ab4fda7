"""
What a participant of the lockstep does with a step: simulate an actuator, or control.

A seat answers in parts of bytes. An actuator's are its `LOAD_REPLY`, its `SAMPLE`, of which
the coordinator makes the state messages itself, and then what it applied; a controller's are
the `COMMAND` rows it asks for.
"""

from collections.abc import Sequence
from typing import Protocol

from isa_ros.controller import Controller, fill_requests, State
from isa_ros.core.signals import COMMAND
from isa_ros.run.exchange import Messages
from isa_ros.run.stepping import Stepper
from isa_ros.run.wire import Step
import numpy as np

Parts = Sequence[bytes | None]


class Seat(Protocol):
    """One place among the participants of a run."""

    @property
    def digest(self) -> bytes:
        """Return a hash of its parameters; empty: nothing to compare."""
        ...

    def start(self, step: Step, index: int) -> Parts:
        """Begin anew at t = 0, as the hello says to the participant at ``index``."""
        ...

    def advance(self, step: Step) -> Parts:
        """
        Take part in one tick.

        Raises
        ------
        SimulationDiverged
            A state is no longer finite.

        """
        ...

    def publish(self) -> None:
        """Publish what the last answer holds to whoever listens."""
        ...

    def serve(self) -> None:
        """Take what has arrived on other topics and services; do not wait."""
        ...

    def snapshot(self) -> bytes:
        """Return the whole state."""
        ...

    def restore(self, snapshot: bytes) -> Parts:
        """Continue from a `snapshot`."""
        ...


class ActuatorSeat:
    """An actuator in the lockstep."""

    def __init__(self, stepper: Stepper) -> None:
        self._stepper = stepper
        self._index = 0
        self._applied: Messages = ()

    @property
    def digest(self) -> bytes:
        """Return a hash of its parameters."""
        return self._stepper.digest.encode()

    def start(self, step: Step, index: int) -> Parts:
        """Begin anew at rest, as its `START` row says."""
        self._index = index
        return self._answer(self._stepper.start(step.start(index)))

    def advance(self, step: Step) -> Parts:
        """Advance one tick under its row of ports and commands."""
        return self._answer(
            self._stepper.advance(step.port(self._index), step.command(self._index)))

    def publish(self) -> None:
        """Publish what the last answer holds."""
        self._stepper.publish(self._applied)

    def serve(self) -> None:
        """Take the setpoints and requests that have arrived."""
        self._stepper.serve()

    def snapshot(self) -> bytes:
        """Return the whole state."""
        return self._stepper.snapshot()

    def restore(self, snapshot: bytes) -> Parts:
        """Continue from a snapshot."""
        return self._answer(self._stepper.restore(snapshot))

    def _answer(self, applied: Messages) -> Parts:
        self._applied = applied
        stepper = self._stepper
        return stepper.reply.tobytes(), stepper.sample.tobytes(), *applied


class ControllerSeat:
    """A user's controller in the lockstep."""

    digest = b''

    def __init__(self, controller: Controller) -> None:
        self._controller = controller
        self._names: list[str] = []
        self._step_ns = 0
        self._requests = np.zeros(0, COMMAND)

    def start(self, step: Step, index: int) -> Parts:
        """Tell the controller who is there; before it has seen a state it asks for nothing."""
        self._names = step.names()[:step.rows]
        self._step_ns = step.step_ns()
        self._requests = np.zeros(step.rows, COMMAND)
        self._controller.start(self._names)
        return (self._requests.tobytes(),)

    def advance(self, step: Step) -> Parts:
        """Show the state before the tick, and return what shall take effect after it."""
        samples, shared = step.samples().view(np.recarray), step.shared().view(np.recarray)
        state = State(step.tick * self._step_ns, dict(zip(self._names, samples)), shared[0])
        self._requests.fill(0)
        fill_requests(self._controller.step(state), self._names, self._requests)
        return (self._requests.tobytes(),)

    def publish(self) -> None:
        """Publish nothing: what it asked for is recorded as it takes effect."""

    def serve(self) -> None:
        """Listen to nobody: what else a node hears is its user's."""

    def snapshot(self) -> bytes:
        """Return the whole state of the controller."""
        return self._controller.snapshot()

    def restore(self, snapshot: bytes) -> Parts:
        """Continue from a snapshot; what was asked for before is in the run's own state."""
        self._controller.restore(snapshot)
        return (self._requests.tobytes(),)
