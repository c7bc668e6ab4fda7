"""
The run: one barrier per tick, free of ROS.

Tick k takes every actuator from t_k to t_k+1 = (k + 1) step_ns, then the load they share.
The sample of t_k is recorded while the actuators work on tick k, so the recorder costs a
tick nothing as long as it is faster than they are. N ticks give N + 1 samples: the state
at t = 0 is one of them.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from isa_ros.errors import IsaError
from isa_ros.pacing import Laps, Pace, ProgressMeter
from isa_ros.signals import COMMAND, LOAD_REPLY
import numpy as np
from numpy.typing import NDArray

Messages = Sequence[bytes | None]
"""Serialised messages of one source, in the order of its topics; None: nothing new."""

Records = NDArray[np.void]
"""Rows of one of the record types of `isa_ros.signals`, one per actuator."""


class Interrupted(IsaError):
    """A run that was asked to stop before its end."""

    exit_code = 130


class Transport(Protocol):
    """The actuators, wherever they run."""

    def join(self) -> Sequence[Messages]:
        """
        Wait until every participant is ready at t = 0 and return their first messages.

        Raises
        ------
        ConfigError
            A participant has other parameters, or another run is going on.
        RunError
            A participant did not answer in time.

        """
        ...

    def publish_clock(self, clock: bytes) -> None:
        """Publish `/clock`."""
        ...

    def send(self, tick: int, ports: Records, commands: Records) -> None:
        """Set all actuators to work."""
        ...

    def receive(self, replies: Records) -> Sequence[Messages]:
        """
        Wait for all actuators, fill ``replies`` and return the messages of each.

        Raises
        ------
        RunError
            A participant was lost or late.
        SimulationDiverged
            The state of an actuator is no longer finite.
        Interrupted
            A stop was asked for and the tick does not end.

        """
        ...

    def publish(self, messages: Messages) -> None:
        """Publish the messages of the shared load to whoever listens."""
        ...


class SharedLoad(Protocol):
    """What the actuators have in common: the supply, and the leg where there is one."""

    def ports(self) -> Records:
        """Return the `LOAD_PORT` of every actuator, shape (n_actuators,)."""
        ...

    def advance(self, replies: Records) -> None:
        """Advance by one tick under the `LOAD_REPLY` of every actuator, shape (n_actuators,)."""
        ...

    def messages(self, t_ns: int) -> Messages:
        """Return what leg and supply show at this instant."""
        ...

    def clock(self, t_ns: int) -> bytes:
        """Return the `/clock` message of ``t_ns``."""
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


class Order:
    """
    The canonical order of one sample: all topics of all sources, sorted by name.

    ``sources`` are the topic names of each participant, then `/clock` alone, then those of
    the shared load.
    """

    def __init__(self, sources: Sequence[Sequence[str]]) -> None:
        places = sorted(
            (name, source, slot)
            for source, names in enumerate(sources) for slot, name in enumerate(names))
        self.topics = tuple(name for name, _, _ in places)
        if len(set(self.topics)) != len(self.topics):
            raise ValueError(f'a topic has two sources: {self.topics}')
        self._places = tuple(
            (index, source, slot) for index, (_, source, slot) in enumerate(places))

    def merge(self, sources: Sequence[Messages]) -> list[tuple[int, bytes]]:
        """Return (topic index, message) of everything new, ascending."""
        return [(index, message) for index, source, slot in self._places
                if (message := sources[source][slot]) is not None]


class Sample(NamedTuple):
    """Everything the sources said at one instant."""

    sequence: int
    sources: Sequence[Messages]


@dataclass(frozen=True, kw_only=True)
class Plan:
    """What is run, and for how long."""

    step_ns: int
    n_actuators: int
    n_ticks: int | None
    """None: until stopped."""
    commands: Callable[[int, Records], None]
    """Fills the `COMMAND` rows of one tick; rows arrive with ``kinds`` zero."""


class Coordinator:
    """Advance actuators and their load tick by tick, and record every sample."""

    def __init__(
            self, plan: Plan, order: Order, transport: Transport, load: SharedLoad,
            recorder: Recorder, *, pace: Pace, progress: ProgressMeter,
            should_stop: Callable[[], bool], laps: Laps | None = None) -> None:
        self._plan = plan
        self._lap: Callable[[str], None] = _no_lap if laps is None else laps.lap
        self._order = order
        self._transport = transport
        self._load = load
        self._recorder = recorder
        self._pace = pace
        self._progress = progress
        self._should_stop = should_stop
        self._commands: Records = np.zeros(plan.n_actuators, COMMAND)
        self._replies: Records = np.zeros(plan.n_actuators, LOAD_REPLY)
        self._unrecorded: Sample | None = None
        self.ticks = 0

    def run(self, first: Sequence[Messages]) -> None:
        """
        Run to the end, from the answers of `Transport.join`.

        Whatever ends the run, every sample of a finished tick is handed to the recorder.

        Raises
        ------
        Interrupted
            Stopped before the end; the tick under way was finished if it could.
        RunError
            A participant or the recorder was lost or late.
        SimulationDiverged
            A state is no longer finite.

        """
        self._end_tick(0, self._publish_clock(0), first)
        self._pace.start()
        self._progress.start()
        try:
            while self.ticks != self._plan.n_ticks:
                self._pace.wait(self.ticks * self._plan.step_ns, self._should_stop)
                if self._should_stop():
                    raise Interrupted(self._stopped())
                self._tick(self.ticks)
                self.ticks += 1
                self._progress.update(self.ticks * self._plan.step_ns)
        finally:
            self._record()
            self._progress.end(self.ticks * self._plan.step_ns)

    def _tick(self, tick: int) -> None:
        self._lap('between ticks')
        self._commands['kinds'] = 0
        self._plan.commands(tick, self._commands)
        ports = self._load.ports()
        self._lap('commands and ports')
        clock = self._publish_clock(tick + 1)
        self._transport.send(tick, ports, self._commands)
        self._lap('clock and step out')
        self._record()
        self._lap('recorder')
        answers = self._transport.receive(self._replies)
        self._lap('actuators')
        self._load.advance(self._replies)
        self._lap('leg and supply')
        self._end_tick(tick + 1, clock, answers)
        self._lap('messages of the leg')

    def _publish_clock(self, sequence: int) -> bytes:
        clock = self._load.clock(sequence * self._plan.step_ns)
        self._transport.publish_clock(clock)
        return clock

    def _end_tick(self, sequence: int, clock: bytes, answers: Sequence[Messages]) -> None:
        shown = self._load.messages(sequence * self._plan.step_ns)
        self._transport.publish(shown)
        self._unrecorded = Sample(sequence, (*answers, (clock,), shown))

    def _record(self) -> None:
        sample, self._unrecorded = self._unrecorded, None
        if sample is None:
            return
        t_ns = sample.sequence * self._plan.step_ns
        self._recorder.write_tick(t_ns, sample.sequence, self._order.merge(sample.sources))

    def _stopped(self) -> str:
        t = self.ticks * self._plan.step_ns * 1e-9
        return f'stopped at t = {t:.6f} s after {self.ticks} ticks'


def _no_lap(phase: str) -> None:
    """Measure nothing."""
