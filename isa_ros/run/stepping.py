"""What moves when it is ticked: one actuator with its messages."""

from typing import Protocol

from isa_ros.actuator.actuator import ActuatorConfig, SmartActuator, Timing
from isa_ros.run.exchange import Messages, Records
from msg_adapters.actuator_messages import StateMessages
from msg_adapters.applied_parameters import applied_parameters
from msg_adapters.setpoint import AppliedSetpoint
import numpy as np


class Stepper(Protocol):
    """One actuator of a run, wherever it lives."""

    @property
    def digest(self) -> str:
        """Return a hash of its resolved parameters."""
        ...

    def start(self, start: np.void | None) -> Messages:
        """Begin anew at t = 0 from a `START` row; return what is applied then."""
        ...

    def advance(self, port: np.void | None, command: np.void | None) -> Messages:
        """
        Take the command of this tick, advance, and return what was applied at its start.

        Raises
        ------
        SimulationDiverged
            A state is no longer finite.

        """
        ...

    @property
    def reply(self) -> Records:
        """Return the `LOAD_REPLY` of the last tick, (1,)."""
        ...

    @property
    def sample(self) -> Records:
        """Return the `SAMPLE` at the end of the last tick, (1,)."""
        ...

    def snapshot(self) -> bytes:
        """Return the whole state; `restore` continues from it byte for byte."""
        ...

    def restore(self, snapshot: bytes) -> Messages:
        """
        Continue from a `snapshot`; return what was applied before that instant.

        Raises
        ------
        ConfigError
            It is none of an actuator with these parameters.

        """
        ...

    def publish(self, applied: Messages) -> None:
        """Publish what `start`, `restore` or `advance` gave, and the state, to listeners."""
        ...

    def serve(self) -> None:
        """Take the setpoints and requests that have arrived; do not wait."""
        ...


def participant_digest(actuator: SmartActuator, timing: Timing) -> str:
    """Return what tells an actuator node apart from one with other parameters."""
    return f'{actuator.digest}/{timing.step_ns}/{timing.controller_offset_ns}'


class SteppedActuator:
    """
    A `SmartActuator` and what it says at an instant: what it applied, and its state.

    ``actuator`` is where it lives; None: in a memory of its own.
    """

    def __init__(
            self, config: ActuatorConfig, timing: Timing,
            actuator: SmartActuator | None = None) -> None:
        self.actuator = actuator or SmartActuator(config, timing)
        self.digest = participant_digest(self.actuator, timing)
        self._step_ns = timing.step_ns
        self._states = StateMessages([(config.name, config.sheet.is_rotary)])
        self._name = config.name
        self._applied = AppliedSetpoint(config.name)

    def start(self, start: np.void | None) -> Messages:
        """Begin at rest from a `START` row, or where the configuration says."""
        if start is not None:
            self.actuator.start(*start.item())
        return self.applied(0)

    def advance(self, port: np.void | None) -> Messages:
        """Advance one tick under a `LOAD_PORT` row."""
        tick_start = self.actuator.t_ns
        self.actuator.tick(port)
        return self.applied(tick_start)

    def restore(self, snapshot: bytes) -> Messages:
        """Continue from a snapshot; return what was applied before that instant."""
        self.actuator.restore(snapshot)
        return self.applied(max(0, self.actuator.t_ns - self._step_ns))

    def applied(self, t_ns: int) -> Messages:
        """Return what took effect at the tick that began at ``t_ns``, as `APPLIED_TOPICS`."""
        tuned, applied = self.actuator.applied_parameters, self.actuator.applied
        return (applied_parameters(self._name, tuned, t_ns) if tuned else None,
                None if applied is None else self._applied.pack(applied, t_ns))

    def states(self) -> Messages:
        """Return the state messages of this instant, as `STATE_TOPICS`."""
        return self._states.pack(self.actuator.sample_rows, self.actuator.t_ns)
