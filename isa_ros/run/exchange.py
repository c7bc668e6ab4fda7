"""Rows that surroundings, actuators, controllers and recorder exchange at a tick."""

from collections.abc import Mapping, Sequence
from typing import Protocol

from isa_ros.core.record import floats
from isa_ros.core.signals import COMMAND, LOAD_PORT, LOAD_REPLY, Records, SAMPLE
from isa_ros.run.packing import Shown
from isa_ros.surroundings.surroundings import Surroundings
import numpy as np

IDLE_S = 0.005
"""Host time between two checks for requests while a run is paused."""


class Rows:
    """
    The memory of one run's exchange, a row per actuator, (n_actuators,) each.

    Overwritten at every tick; copy rows to keep them.
    """

    def __init__(self, n_actuators: int, surroundings: Surroundings) -> None:
        self.ports: Records = np.zeros(n_actuators, LOAD_PORT)
        """Boundary values of the tick, from the surroundings to the actuators."""
        self.commands: Records = np.zeros(n_actuators, COMMAND)
        """Commands that take effect at the tick's start."""
        self.replies: Records = np.zeros(n_actuators, LOAD_REPLY)
        """Results of the tick, from the actuators to the surroundings."""
        self.samples: Records = np.zeros(n_actuators, SAMPLE)
        """
        Samples at the tick's start; once the actuators have answered, at its end.

        Behind a link the newest that has arrived.
        """
        self.applied: Records = np.zeros(n_actuators, COMMAND)
        """Commands that took effect in the last tick; kinds 0 without one."""
        self.sent: Records = np.zeros(n_actuators, COMMAND)
        """Commands handed to the links at the last tick's start; kinds 0 without one."""
        self.tuned: Mapping[int, Mapping[str, float]] = {}
        """Parameters that changed at the start of the last tick, SI, by row and name."""
        self.changes: Mapping[int, Mapping[str, float]] = {}
        """Parameters that faults change at the tick's start, by row and name."""
        self.requests: Records = np.zeros(n_actuators, COMMAND)
        """Commands of the controllers, to take effect at the next tick."""
        self.supplies: Records = surroundings.supplies
        """`SUPPLY_SAMPLE` of the supplies; memory of the surroundings."""
        self.body: Records | None = None
        """Sample of the body, (1,); memory of the body. None: no body."""
        if surroundings.body is not None:
            self.body = surroundings.body.sample
        self.shown = Shown(self.samples, self.applied, self.supplies, self.body, self.sent)
        """The rows that the messages are packed from."""
        self.reply_values, self.sample_values = floats(self.replies), floats(self.samples)
        """The same memory as plain floats."""


class Transport(Protocol):
    """Connection to the actuators and controllers, in this process or in others."""

    def join(self, rows: Rows) -> None:
        """
        Wait until every participant is ready at t = 0.

        Fills their samples and applied commands. A second call begins another run.

        Raises
        ------
        ConfigError
            A participant has other parameters, or takes part in another run.
        RunError
            A participant did not answer in time.

        """
        ...

    def restore(self, tick: int, snapshots: Sequence[bytes], rows: Rows) -> None:
        """
        After `join`, restore the state of every participant before ``tick``; raises as `join`.

        ``snapshots`` come from `snapshots`.
        """
        ...

    def begin(self) -> None:
        """Make every participant publish its first messages; the time is already published."""
        ...

    def send(self, tick: int, rows: Rows) -> None:
        """Start the tick: send changes, ports, commands, and the samples to the controllers."""
        ...

    def receive(self, rows: Rows) -> None:
        """
        Wait for all participants; fill replies, samples, applied, tuned and requests.

        Raises
        ------
        RunError
            A participant failed or did not answer in time.
        SimulationDiverged
            The state of an actuator is no longer finite.
        Interrupted
            A stop was requested and the tick did not end.

        """
        ...

    def idle(self, seconds: float = IDLE_S) -> None:
        """
        Wait for a moment while the run waits; process the inputs of actuators in this process.

        Raises
        ------
        RunError
            A participant failed.

        """
        ...

    def snapshots(self) -> list[bytes]:
        """
        Return the complete state of each participant, in their order.

        Raises
        ------
        RunError
            A participant failed, did not answer in time, or cannot be saved.

        """
        ...


class Recorder(Protocol):
    """Receives every sample of a run, in order of time."""

    def write_tick(
            self, t_ns: int, sequence: int, messages: Sequence[tuple[int, bytes]]) -> None:
        """
        Append one sample: (index into the sorted topics, CDR) with ascending index.

        Raises
        ------
        RunError
            The sample cannot be written, for example because the disk is full.

        """
        ...
