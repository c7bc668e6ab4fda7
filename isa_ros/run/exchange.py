"""What crosses between surroundings, actuators, controllers and recorder at a tick: rows."""

from collections.abc import Mapping, Sequence
from typing import Protocol

from isa_ros.core.signals import COMMAND, LOAD_PORT, LOAD_REPLY, SAMPLE
from isa_ros.run.packing import Shown
from isa_ros.surroundings.surroundings import Surroundings
import numpy as np
from numpy.typing import NDArray

Records = NDArray[np.void]
"""Rows of one of the record types of `isa_ros.core.signals`, one per actuator."""

Floats = NDArray[np.float64]


def floats(rows: Records) -> Floats:
    """
    Return the same memory as plain numbers, (n, floats of a row).

    Records of floats are copied ten times as fast in this form.
    """
    return rows.view(np.float64).reshape(len(rows), rows.itemsize // np.float64().itemsize)


IDLE_S = 0.005
"""Host time between two looks at what is asked of a paused run."""


class Rows:
    """
    The memory of one run's exchange, a row per actuator, (n_actuators,) each.

    Overwritten tick by tick; what must last is copied.
    """

    def __init__(self, n_actuators: int, surroundings: Surroundings) -> None:
        self.ports: Records = np.zeros(n_actuators, LOAD_PORT)
        """From the surroundings to the actuators, for the tick."""
        self.commands: Records = np.zeros(n_actuators, COMMAND)
        """What takes effect at the tick's start."""
        self.replies: Records = np.zeros(n_actuators, LOAD_REPLY)
        """From the actuators to the surroundings, at the tick's end."""
        self.samples: Records = np.zeros(n_actuators, SAMPLE)
        """What the actuators show at the tick's start; at its end once they have answered."""
        self.applied: Records = np.zeros(n_actuators, COMMAND)
        """What is in force since the last tick's start; of no kind where nothing is new."""
        self.tuned: Mapping[int, Mapping[str, float]] = {}
        """Parameters that changed at the start of the last tick, SI, by row and name."""
        self.requests: Records = np.zeros(n_actuators, COMMAND)
        """What the controllers ask for, to take effect at the next tick."""
        self.supplies: Records = surroundings.supplies
        """`SUPPLY_SAMPLE` of the supplies; the surroundings' own memory."""
        self.body: Records | None = None
        """What the body shows, (1,); the body's own memory. None: no body."""
        if surroundings.body is not None:
            self.body = surroundings.body.sample
        self.shown = Shown(self.samples, self.applied, self.supplies, self.body)
        """The rows that messages are made of."""
        self.reply_values, self.sample_values = floats(self.replies), floats(self.samples)
        """The same memory as plain numbers."""


class Transport(Protocol):
    """Actuators and controllers, wherever they run."""

    def join(self, rows: Rows) -> None:
        """
        Wait until every participant is ready at t = 0.

        Fills what they show and have applied. A second call begins another run.

        Raises
        ------
        ConfigError
            A participant has other parameters, or another run is going on.
        RunError
            A participant did not answer in time.

        """
        ...

    def restore(self, tick: int, snapshots: Sequence[bytes], rows: Rows) -> None:
        """
        Put everyone, after `join`, where it was before ``tick``; as `join`.

        ``snapshots`` are those of `snapshots`.
        """
        ...

    def begin(self) -> None:
        """Let everyone publish the first messages: the time is known."""
        ...

    def send(self, tick: int, rows: Rows) -> None:
        """Set everyone to work: ports and commands, and to controllers what is shown."""
        ...

    def receive(self, rows: Rows) -> None:
        """
        Wait for everyone; fill replies, samples, applied, tuned and requests.

        Raises
        ------
        RunError
            A participant was lost or late.
        SimulationDiverged
            The state of an actuator is no longer finite.
        Interrupted
            A stop was requested and the tick does not end.

        """
        ...

    def idle(self) -> None:
        """
        Pass a moment in which the run is paused.

        Raises
        ------
        RunError
            A participant was lost.

        """
        ...

    def snapshots(self) -> list[bytes]:
        """
        Return the whole state of everyone, in the order of the participants.

        Raises
        ------
        RunError
            A participant was lost or late, or cannot be saved.

        """
        ...


class Recorder(Protocol):
    """Where every sample goes, in canonical order."""

    def write_tick(
            self, t_ns: int, sequence: int, messages: Sequence[tuple[int, bytes]]) -> None:
        """
        Append one sample: (index into the sorted topics, CDR) with ascending index.

        Raises
        ------
        RunError
            The recorder was lost, the disk is full.

        """
        ...
