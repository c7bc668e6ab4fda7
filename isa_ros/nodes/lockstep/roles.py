"""
What a participant of the lockstep does with a step: simulate an actuator, or control.

A role answers in parts of bytes. An actuator's are its rows and the parameters that changed
(`wire.actuator_parts`); a controller's are the `COMMAND` rows it asks for.
"""

from collections.abc import Mapping, Sequence
from typing import Protocol

from isa_ros.controller import by_name, Controller, ControllerSeat, State
from isa_ros.run.exchange import Records
from isa_ros.run.wire import actuator_parts, Cast, Step
import numpy as np

Parts = Sequence[bytes | None]


class Role(Protocol):
    """What one participant does in a run."""

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
        """Publish what the last answer holds to those who subscribe."""
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


class Stepper(Protocol):
    """One actuator of a run: its node. Rows are those of `SmartActuator.memory`, (1,)."""

    @property
    def digest(self) -> str:
        """Return a hash of its resolved parameters."""
        ...

    @property
    def reply(self) -> Records:
        """Return the `LOAD_REPLY` of the last tick."""
        ...

    @property
    def sample(self) -> Records:
        """Return the `SAMPLE` at the end of the last tick."""
        ...

    @property
    def applied(self) -> Records:
        """Return the `COMMAND` that took effect at its start, of no kind for none."""
        ...

    @property
    def tuned(self) -> Mapping[str, float]:
        """Return the parameters that changed at its start, SI."""
        ...

    def start(self, start: np.void | None) -> None:
        """Begin anew at t = 0 from a `START` row; None: as configured."""
        ...

    def advance(self, port: np.void | None, command: np.void | None) -> None:
        """
        Take the command of this tick and advance.

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
        """
        Continue from a `snapshot`.

        Raises
        ------
        ConfigError
            The bytes are not a snapshot of an actuator with these parameters.

        """
        ...

    def publish(self) -> None:
        """Publish the state and what was applied to those who subscribe."""
        ...

    def serve(self) -> None:
        """Take the setpoints and requests that have arrived; do not wait."""
        ...


class ActuatorRole:
    """An actuator in the lockstep."""

    def __init__(self, stepper: Stepper) -> None:
        self._stepper = stepper
        self._index = 0
        self.publish = stepper.publish
        self.serve = stepper.serve
        self.snapshot = stepper.snapshot

    @property
    def digest(self) -> bytes:
        """Return a hash of its parameters."""
        return self._stepper.digest.encode()

    def start(self, step: Step, index: int) -> Parts:
        """Begin anew at rest, as its `START` row says."""
        self._index = index
        self._stepper.start(step.start(index))
        return self._parts()

    def advance(self, step: Step) -> Parts:
        """Advance one tick under its row of ports and commands."""
        self._stepper.advance(step.port(self._index), step.command(self._index))
        return self._parts()

    def restore(self, snapshot: bytes) -> Parts:
        """Continue from a snapshot."""
        self._stepper.restore(snapshot)
        return self._parts()

    def _parts(self) -> Parts:
        own = self._stepper
        return actuator_parts(own.reply, own.sample, own.applied, own.tuned)


class ControllerRole:
    """A user's controller in the lockstep."""

    digest = b''

    def __init__(self, controller: Controller) -> None:
        self._controller = controller
        self._seat: ControllerSeat | None = None
        self._cast = Cast((), (), None)
        self._step_ns = 0

    def start(self, step: Step, index: int) -> Parts:
        """Tell the controller which actuators there are; it asks for nothing yet."""
        self._cast, self._step_ns = step.cast(), step.step_ns()
        self._seat = ControllerSeat(self._controller, self._cast.names[:step.rows])
        return self._parts()

    def advance(self, step: Step) -> Parts:
        """Show the state before the tick, and return what shall take effect after it."""
        assert self._seat is not None, 'a run begins with a hello'
        shown = step.shown(self._cast)
        body = None if shown.body is None else shown.body.view(np.recarray)[0]
        self._seat.step(State(
            step.tick * self._step_ns, by_name(self._seat.names, shown.samples),
            by_name(self._cast.supplies, shown.supplies), body))
        return self._parts()

    def publish(self) -> None:
        """Do nothing: what it asks for is recorded as it takes effect."""

    def serve(self) -> None:
        """Do nothing: other subscriptions belong to the user's node."""

    def snapshot(self) -> bytes:
        """Return the whole state of the controller."""
        return self._controller.snapshot()

    def restore(self, snapshot: bytes) -> Parts:
        """Continue from a snapshot; what was asked for before is in the run's own state."""
        self._controller.restore(snapshot)
        return self._parts()

    def _parts(self) -> Parts:
        assert self._seat is not None, 'a run begins with a hello'
        return (self._seat.requests.tobytes(),)
