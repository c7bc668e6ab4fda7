"""What moves when it is ticked: one actuator with its messages, and all of them in one process."""

from collections.abc import Sequence
import time
from typing import Protocol

from isa_ros.actuator import ActuatorConfig, SmartActuator, Timing
from isa_ros.errors import ConfigError
from isa_ros.exchange import Messages, Records, Rows, Voice
from msg_adapters import actuator_messages
from msg_adapters.setpoint import AppliedSetpoint
import numpy as np

IDLE_S = 0.005
"""Host time between two looks at what is asked of a paused run."""


class Stepper(Protocol):
    """One actuator of a run, wherever it lives."""

    @property
    def digest(self) -> str:
        """Return a hash of its resolved parameters."""
        ...

    def start(self, start: np.void | None) -> Messages:
        """Begin anew at t = 0 from a `START` row and return the messages of t = 0."""
        ...

    def advance(self, port: np.void | None, command: np.void | None) -> Messages:
        """
        Take the command of this tick, advance, and return the messages of its end.

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

    @property
    def sample(self) -> np.void:
        """Return the `SAMPLE` at the end of the last tick."""
        ...

    def snapshot(self) -> bytes:
        """Return the whole state; `restore` continues from it byte for byte."""
        ...

    def restore(self, snapshot: bytes) -> Messages:
        """
        Continue from a `snapshot` and return the messages of that instant.

        Raises
        ------
        ConfigError
            It is none of an actuator with these parameters.

        """
        ...

    def publish(self, messages: Messages) -> None:
        """Publish messages of `start`, `restore` or `advance` to whoever listens."""
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
        self._states = actuator_messages.StateMessages([(config.name, config.sheet.is_rotary)])
        self._applied = AppliedSetpoint(config.name)
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

    def restore(self, snapshot: bytes) -> Messages:
        """Continue from a snapshot and return the messages of that instant."""
        self.actuator.restore(snapshot)
        return self._sampled(max(0, self.actuator.t_ns - self._step_ns))

    def _sampled(self, applied_ns: int) -> Messages:
        """Return all messages of this instant; what was applied took effect at ``applied_ns``."""
        applied = self.actuator.applied
        return [None if applied is None else self._applied.pack(applied, applied_ns),
                *self._states.pack(self.actuator.sample_rows, self.actuator.t_ns)]


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

    @property
    def sample(self) -> np.void:
        """Return the `SAMPLE` at the end of the last tick."""
        return self._stepped.actuator.sample

    def start(self, start: np.void | None) -> Messages:
        """Begin anew at t = 0."""
        return self._stepped.start(start)

    def advance(self, port: np.void | None, command: np.void | None) -> Messages:
        """Take the command of this tick and advance."""
        if command is not None and command['kinds']:
            self._stepped.actuator.accept(command)
        return self._stepped.advance(port)

    def snapshot(self) -> bytes:
        """Return the whole state."""
        return self._stepped.actuator.snapshot()

    def restore(self, snapshot: bytes) -> Messages:
        """Continue from a snapshot."""
        return self._stepped.restore(snapshot)

    def publish(self, messages: Messages) -> None:
        """Tell nobody."""

    def serve(self) -> None:
        """Listen to nobody."""


class LocalTransport:
    """
    All actuators in this process, called one after the other in configuration order.

    ``starts`` are their `START` rows, (n,).
    """

    def __init__(self, steppers: Sequence[Stepper], starts: Records, voice: Voice) -> None:
        self._steppers = steppers
        self._starts = starts
        self.publish = voice.publish
        self.publish_clock = voice.publish_clock
        self.publish_event = voice.publish_event
        self._first: list[Messages] = []

    def join(self, rows: Rows) -> Sequence[Messages]:
        """Start everyone and return the messages of t = 0."""
        self._first = [
            stepper.start(self._starts[k]) for k, stepper in enumerate(self._steppers)]
        self.take_samples(rows)
        return self._first

    def restore(
            self, tick: int, snapshots: Sequence[bytes], rows: Rows) -> Sequence[Messages]:
        """Put everyone where the snapshots were taken and return the messages of then."""
        if len(snapshots) != len(self._steppers):
            raise ConfigError(
                f'the saved state has {len(snapshots)} participants, the run has '
                f'{len(self._steppers)}')
        self._first = [
            stepper.restore(own) for stepper, own in zip(self._steppers, snapshots)]
        self.take_samples(rows)
        return self._first

    def begin(self) -> None:
        """Publish the first messages of everyone."""
        for stepper, messages in zip(self._steppers, self._first):
            stepper.publish(messages)

    def send(self, tick: int, rows: Rows) -> None:
        """Leave the work to `receive`."""

    def receive(self, rows: Rows) -> Sequence[Messages]:
        """Advance everyone."""
        answers = []
        for k, stepper in enumerate(self._steppers):
            stepper.serve()
            messages = stepper.advance(rows.ports[k], rows.commands[k])
            stepper.publish(messages)
            rows.replies[k] = stepper.reply
            answers.append(messages)
        return answers

    def idle(self) -> None:
        """Listen to whoever asks something of an actuator."""
        for stepper in self._steppers:
            stepper.serve()
        time.sleep(IDLE_S)

    def snapshots(self) -> list[bytes]:
        """Return the state of every actuator."""
        return [stepper.snapshot() for stepper in self._steppers]

    def take_samples(self, rows: Rows) -> None:
        """Fill the samples with what the actuators show now."""
        for k, stepper in enumerate(self._steppers):
            rows.samples[k] = stepper.sample
