"""What crosses between load, actuators, controllers and recorder at a tick, and who they are."""

from collections.abc import Sequence
from typing import Protocol

from isa_ros.core.signals import COMMAND, LOAD_PORT, LOAD_REPLY, SAMPLE, SHARED_SAMPLE
import numpy as np
from numpy.typing import NDArray

Messages = Sequence[bytes | None]
"""Serialised messages of one source, in the order of its topics; None: nothing new."""

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

    def __init__(self, n_actuators: int) -> None:
        self.ports: Records = np.zeros(n_actuators, LOAD_PORT)
        """From the load to the actuators, for the tick."""
        self.commands: Records = np.zeros(n_actuators, COMMAND)
        """What takes effect at the tick's start."""
        self.replies: Records = np.zeros(n_actuators, LOAD_REPLY)
        """From the actuators to the load, at the tick's end."""
        self.samples: Records = np.zeros(n_actuators, SAMPLE)
        """What the actuators show at the tick's start; at its end once they have answered."""
        self.reply_values, self.sample_values = floats(self.replies), floats(self.samples)
        """The same memory as plain numbers."""
        self.requests: Records = np.zeros(n_actuators, COMMAND)
        """What the controllers ask for, to take effect at the next tick."""
        self.shared: Records = np.zeros(1, SHARED_SAMPLE)
        """What supply and leg show at the tick's start, (1,)."""


class Voice(Protocol):
    """Who publishes for a run."""

    def publish(self, messages: Messages) -> None:
        """Publish the messages of the shared load."""
        ...

    def publish_clock(self, clock: bytes) -> None:
        """Publish `/clock`."""
        ...

    def publish_event(self, event: bytes) -> None:
        """Publish what was done to the run."""
        ...


class Silence:
    """A `Voice` that tells nobody."""

    def publish(self, messages: Messages) -> None:
        """Tell nobody."""

    def publish_clock(self, clock: bytes) -> None:
        """Tell nobody."""

    def publish_event(self, event: bytes) -> None:
        """Tell nobody."""


class Transport(Voice, Protocol):
    """Actuators and controllers, wherever they run."""

    def join(self, rows: Rows) -> Sequence[Messages]:
        """
        Wait until every participant is ready at t = 0 and return their first messages.

        Fills the samples. A second call begins another run.

        Raises
        ------
        ConfigError
            A participant has other parameters, or another run is going on.
        RunError
            A participant did not answer in time.

        """
        ...

    def restore(
            self, tick: int, snapshots: Sequence[bytes], rows: Rows) -> Sequence[Messages]:
        """
        Put everyone, after `join`, where it was before ``tick``; as `join`.

        ``snapshots`` are those of `snapshots`.
        """
        ...

    def begin(self) -> None:
        """Let everyone publish the first messages: the time is known."""
        ...

    def send(self, tick: int, rows: Rows) -> None:
        """Set everyone to work: ports and commands, and to controllers the samples."""
        ...

    def receive(self, rows: Rows) -> Sequence[Messages]:
        """
        Wait for everyone and return the messages of each.

        Fills replies, samples and requests.

        Raises
        ------
        RunError
            A participant was lost or late.
        SimulationDiverged
            The state of an actuator is no longer finite.
        Interrupted
            A stop is asked for and the tick does not end.

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


class SharedLoad(Protocol):
    """What the actuators have in common: the supply, and the leg where there is one."""

    def ports(self, ports: Records) -> None:
        """Fill the `LOAD_PORT` of every actuator, shape (n_actuators,)."""
        ...

    def advance(self, replies: Records) -> None:
        """Advance by one tick under the `LOAD_REPLY` of every actuator, shape (n_actuators,)."""
        ...

    def show(self, shared: Records) -> None:
        """Fill the `SHARED_SAMPLE` of this instant, shape (1,)."""
        ...

    def messages(self, t_ns: int) -> Messages:
        """Return what leg and supply show at this instant."""
        ...

    def clock(self, t_ns: int) -> bytes:
        """Return the `/clock` message of ``t_ns``."""
        ...

    def event(self, t_ns: int, text: str) -> bytes:
        """Return the message that says what was done to the run at ``t_ns``."""
        ...

    def snapshot(self) -> bytes:
        """Return the whole state; `restore` continues from it byte for byte."""
        ...

    def restore(self, snapshot: bytes) -> None:
        """Continue from a `snapshot` of the same configuration."""
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
