"""All actuators of a run in this process, and controllers that are called directly."""

from collections.abc import Sequence
import time
from typing import Protocol

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.group import ActuatorGroup
from isa_ros.controller import by_name, Controller, fill_requests, only_rows, State
from isa_ros.core.signals import Records
from isa_ros.errors import ConfigError
from isa_ros.tick.exchange import IDLE_S, Rows


class Input(Protocol):
    """Input of setpoints and requests of one actuator: its node."""

    def serve(self) -> None:
        """Process the setpoints and requests that have arrived; do not wait."""
        ...


class InProcess:
    """
    A `Transport` to the actuators of a group, which advance together.

    ``starts`` are their `START` rows, (n,); ``inputs`` has one entry per actuator, or none.
    ``controllers`` get the state with the names of ``supplies``. The rows of the run are those
    of the group.
    """

    def __init__(
            self, group: ActuatorGroup, starts: Records, inputs: Sequence[Input] = (),
            controllers: Sequence[Controller] = (), supplies: Sequence[str] = ()) -> None:
        self.group = group
        self._starts = starts
        self._inputs = inputs
        self._names = [actuator.name for actuator in group.actuators]
        self._controllers, self._supplies = tuple(controllers), supplies
        self._participants: Sequence[SmartActuator | Controller] = (
            *group.actuators, *controllers)

    def join(self, rows: Rows) -> None:
        """Start all at t = 0."""
        self.group.start(self._starts)
        rows.tuned = {}
        self._state = State(
            0, by_name(self._names, rows.samples), by_name(self._supplies, rows.supplies),
            only_rows(rows.bodies))
        for controller in self._controllers:
            controller.start(list(self._names))

    def restore(self, tick: int, snapshots: Sequence[bytes], rows: Rows) -> None:
        """Restore all participants from their snapshots."""
        if len(snapshots) != len(self._participants):
            raise ConfigError(
                f'the saved state has {len(snapshots)} participants, the run has '
                f'{len(self._participants)}')
        for participant, own in zip(self._participants, snapshots):
            participant.restore(own)
        rows.tuned = self.group.tuned

    def begin(self) -> None:
        """Do nothing: a sink of the rows publishes for all actuators."""

    def send(self, tick: int, rows: Rows) -> None:
        """Call the controllers with the state before the tick."""
        if self._controllers:
            state = self._state._replace(t_ns=self.group.t_ns)
            for controller in self._controllers:
                fill_requests(
                    controller.step(state), self._names, rows.requests, state.actuators)

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
        """Return the state of every participant."""
        return [participant.snapshot() for participant in self._participants]
