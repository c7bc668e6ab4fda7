"""What moves when it is ticked: one actuator with its messages, and all of them in one process."""

from collections.abc import Callable, Sequence
from typing import Protocol

from isa_ros.actuator import ActuatorConfig, SmartActuator, Timing
from isa_ros.coordinator import Messages, Records
from isa_ros.signals import LOAD_REPLY
from msg_adapters import actuator_messages
import numpy as np

START = np.dtype([
    ('position', '<f8'),         # m | rad
    ('force', '<f8'),            # what the actuator holds at rest, N | Nm
    ('supply_pressure', '<f8'),  # Pa gauge
    ('return_pressure', '<f8'),  # Pa gauge
])
"""How one actuator begins a run."""

NO_REPLY = np.zeros(1, LOAD_REPLY)[0]


class Stepper(Protocol):
    """One participant of a run, wherever it lives."""

    @property
    def digest(self) -> str:
        """Return a hash of its resolved parameters; empty: nothing to compare."""
        ...

    def start(self, start: np.void | None) -> Messages:
        """Begin anew at t = 0 from a `START` row and return the messages of t = 0."""
        ...

    def advance(self, tick: int, port: np.void | None, command: np.void | None) -> Messages:
        """
        Take part in one tick and return the messages of its end.

        ``port`` and ``command`` are None for a participant that is no actuator.

        Raises
        ------
        SimulationDiverged
            A state is no longer finite.

        """
        ...

    @property
    def reply(self) -> np.void:
        """Return the `LOAD_REPLY` of the last tick."""
        ...

    def publish(self, messages: Messages) -> None:
        """Publish messages of `start` or `advance` to whoever listens."""
        ...

    def serve(self) -> None:
        """Take the setpoints and requests that have arrived; do not wait."""
        ...


def participant_digest(actuator: SmartActuator, timing: Timing) -> str:
    """Return what tells an actuator node apart from one with other parameters."""
    return f'{actuator.digest}/{timing.step_ns}/{timing.controller_offset_ns}'


class SteppedActuator:
    """A `SmartActuator` and the messages it sends, sorted by topic."""

    def __init__(self, config: ActuatorConfig, timing: Timing) -> None:
        self.actuator = SmartActuator(config, timing)
        self.topics = actuator_messages.TOPICS
        self._step_ns = timing.step_ns
        self._messages = actuator_messages.ActuatorMessages(config.name, config.sheet.is_rotary)
        self.digest = participant_digest(self.actuator, timing)

    def start(self, start: np.void | None) -> Messages:
        """Begin at rest from a `START` row, or where the configuration says."""
        if start is not None:
            self.actuator.start(*start.item())
        return self._sampled(0)

    def advance(self, port: np.void | None) -> Messages:
        """Advance one tick under a `LOAD_PORT` row."""
        tick_start = self.actuator.t_ns
        self.actuator.tick(port)
        return self._sampled(tick_start)

    def _sampled(self, applied_ns: int) -> Messages:
        """Return all messages of this instant; what was applied took effect at ``applied_ns``."""
        applied = self.actuator.applied
        messages: list[bytes | None] = [
            None if applied is None
            else self._messages.applied_setpoint(applied, applied_ns)[1]]
        messages += [
            data for _, data in self._messages.state(self.actuator.sample, self.actuator.t_ns)]
        return messages


class QuietActuator:
    """One actuator that is told everything by the coordinator and tells nobody else."""

    def __init__(self, config: ActuatorConfig, timing: Timing) -> None:
        self._stepped = SteppedActuator(config, timing)

    @property
    def digest(self) -> str:
        """Return the digest of its parameters."""
        return self._stepped.digest

    @property
    def reply(self) -> np.void:
        """Return the `LOAD_REPLY` of the last tick."""
        return self._stepped.actuator.reply

    def start(self, start: np.void | None) -> Messages:
        """Begin anew at t = 0."""
        return self._stepped.start(start)

    def advance(self, tick: int, port: np.void | None, command: np.void | None) -> Messages:
        """Take the command of this tick and advance."""
        if command is not None and command['kinds']:
            self._stepped.actuator.accept(command)
        return self._stepped.advance(port)

    def publish(self, messages: Messages) -> None:
        """Tell nobody."""

    def serve(self) -> None:
        """Listen to nobody."""


class LocalTransport:
    """
    All participants in this process, called one after the other in configuration order.

    ``starts`` are their `START` rows, (n,); ``publish`` takes the messages of the shared load.
    """

    def __init__(
            self, steppers: Sequence[Stepper], starts: Records,
            publish: Callable[[Messages], None], publish_clock: Callable[[bytes], None]) -> None:
        self._steppers = steppers
        self._starts = starts
        self.publish = publish
        self.publish_clock = publish_clock
        self._work: tuple[int, Records, Records] | None = None

    def join(self) -> Sequence[Messages]:
        """Start everyone and return the messages of t = 0."""
        answers = [stepper.start(self._starts[k]) for k, stepper in enumerate(self._steppers)]
        for stepper, messages in zip(self._steppers, answers):
            stepper.publish(messages)
        return answers

    def send(self, tick: int, ports: Records, commands: Records) -> None:
        """Keep the work for `receive`."""
        self._work = (tick, ports, commands)

    def receive(self, replies: Records) -> Sequence[Messages]:
        """Advance everyone."""
        assert self._work is not None, 'send comes first'
        tick, ports, commands = self._work
        answers = []
        for k, stepper in enumerate(self._steppers):
            stepper.serve()
            messages = stepper.advance(tick, ports[k], commands[k])
            stepper.publish(messages)
            replies[k] = stepper.reply
            answers.append(messages)
        return answers
