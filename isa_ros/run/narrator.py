"""What a run tells: every sample to the recorder, and to publishers what somebody listens to."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple, Protocol

from isa_ros.config.leg_config import LegConfig
from isa_ros.config.run_config import RunConfig
from isa_ros.core.topic import Topic
from isa_ros.run.exchange import Recorder
from isa_ros.run.packing import BodyMessages, Messages, Names, Packer, Shown
from isa_ros.surroundings.leg.sheet import JOINTS
from isa_ros.surroundings.supply import VolumeReturn
from msg_adapters import clock, coordinator_messages, event


class Outlet(Protocol):
    """The publishers of one source, in the order of its topics."""

    def is_heard(self) -> bool:
        """Return whether there is a subscription; asked once a tick."""
        ...

    def send(self, messages: Messages) -> None:
        """Publish to those who subscribe."""
        ...


class Silence:
    """An `Outlet` without subscriptions."""

    def is_heard(self) -> bool:
        """Return False."""
        return False

    def send(self, messages: Messages) -> None:
        """Do nothing."""


class Outlets(NamedTuple):
    """Where the messages of a run are published."""

    clock: Outlet = Silence()
    events: Outlet = Silence()
    surroundings: Outlet = Silence()
    actuators: Sequence[Outlet] = ()
    """One per actuator, in their order; none where the actuators publish for themselves."""


class Narrator:
    """
    Packs the rows of a run at each instant, for its recorder and its outlets.

    Nothing is packed where nothing is recorded and nobody subscribes. ``recorder`` may be None.
    """

    def __init__(
            self, run: RunConfig, shown: Shown, recorder: Recorder | None = None,
            outlets: Outlets = Outlets()) -> None:
        self._step_ns = run.step_ns
        self._recorder = recorder
        self._outlets = outlets
        self._packer = packer_of(run, shown)
        self._surroundings = self._packer.surroundings
        self._events: list[bytes] = []
        self._unrecorded: int | None = None

    def say_time(self, tick: int) -> None:
        """Publish the time of a tick, before anything else of that instant."""
        if self._outlets.clock.is_heard():
            self._outlets.clock.send((clock.pack(tick * self._step_ns),))

    def note(self, tick: int, text: str) -> None:
        """Publish and record what was done to the run before a tick."""
        message = event.pack(tick * self._step_ns, text)
        self._events.append(message)
        if self._outlets.events.is_heard():
            self._outlets.events.send((message,))

    def take(self, tick: int, tuned: Mapping[int, Mapping[str, float]]) -> None:
        """
        Pack and publish the rows as they are before ``tick``; `record` hands them on.

        ``tuned`` are the parameters that changed at the start of the last tick, by row.
        """
        outlets = self._outlets
        heard = [row for row, outlet in enumerate(outlets.actuators) if outlet.is_heard()]
        shows = outlets.surroundings.is_heard()
        if self._recorder is None and not heard and not shows:
            return
        t_ns = tick * self._step_ns
        self._packer.pack(t_ns, max(0, t_ns - self._step_ns), tuned)
        self._unrecorded = tick
        for row in heard:
            outlets.actuators[row].send(self._packer.of_actuator(row))
        if shows:
            outlets.surroundings.send(self._packer.of(self._surroundings))

    def record(self) -> None:
        """Hand the instant that was packed last to the recorder, once."""
        tick, self._unrecorded = self._unrecorded, None
        if tick is None or self._recorder is None:
            return
        events, self._events = self._events, []
        self._recorder.write_tick(
            tick * self._step_ns, tick, self._packer.everything(events))


def packer_of(run: RunConfig, shown: Shown) -> Packer:
    """Return what packs the rows of a run."""
    return Packer(
        Names([(actuator.name, actuator.sheet.is_rotary) for actuator in run.actuators],
              [(supply.name, isinstance(supply.sheet.return_line, VolumeReturn))
               for supply in run.supplies], _body_messages(run)), shown)


def topics_of(run: RunConfig, shown: Shown) -> list[Topic]:
    """Return the topics of a run, sorted by name."""
    return list(packer_of(run, shown).topics)


def _body_messages(run: RunConfig) -> BodyMessages | None:
    """Return what makes the messages of a body; another kind is one more line here."""
    if isinstance(run.body, LegConfig):
        return lambda columns: coordinator_messages.leg(JOINTS, columns)
    return None
