"""Output of a run: every sample to the recorder, and messages to topics with subscribers."""

from collections.abc import Sequence

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.bound import nothing, Part
from isa_ros.core.topic import Topic
from isa_ros.plant.cushion_sheets import is_cushioned
from isa_ros.plant.plant import is_heated
from isa_ros.run.buffered import quiet
from isa_ros.run.live import every_tick, LivePeriods, PeriodOf
from isa_ros.run.outlets import Outlets
from isa_ros.run.packing import Packer
from isa_ros.run.quiet_setpoints import QuietSetpoints
from isa_ros.run.recorders import Recorder
from isa_ros.run.row_messages import Names
from isa_ros.tick.exchange import PublishedRows, Rows, RowSink
from msg_adapters import clock, diagnostics, event
import numpy as np
from numpy.typing import NDArray


class RunOutput(RowSink):
    """
    Packs the rows of a run at each instant and passes the messages to recorder and outlets.

    Without recorder (None) and without subscriptions only what was applied is packed. Without
    ``has_end`` the run was cut off, and its last instant has no diagnostics. ``period_of`` are the
    periods of publishing.
    """

    def __init__(
            self, packer: Packer, step_ns: int, recorder: Recorder | None = None,
            outlets: Outlets = Outlets(), *, has_end: bool = True,
            period_of: PeriodOf = every_tick) -> None:
        self._packer = packer
        self._step_ns = step_ns
        self._recorder = None if recorder is None else quiet(recorder)
        self._outlets = outlets
        self._has_end = has_end
        self._surroundings = packer.surroundings
        self._live = LivePeriods(period_of, self._surroundings)
        self._live_actuators = [LivePeriods(period_of, packer.topics_of(row))
                                for row, _ in enumerate(outlets.actuators)]
        self._live_clock = LivePeriods(period_of, [Topic(*clock.TOPIC)])
        self._events: list[bytes] = []
        self._unrecorded: int | None = None
        self._recorded = 0
        self._applied = b''
        self._setpoints = (
            QuietSetpoints(packer, outlets.actuators) if outlets.actuators else None)
        self._keeps = False
        self._sampled = outlets.clock, outlets.surroundings, *outlets.actuators

    def take_time(self, tick: int) -> None:
        """Publish the time of a tick, before all other messages of that instant."""
        if self._outlets.clock.has_subscribers() and self._live_clock.due(tick, (0,)):
            self._outlets.clock.publish((clock.pack(self._stamp(tick)),))

    def quiet_ticks(self, tick: int) -> int:
        """Return how many ticks after ``tick`` only have to be packed and recorded."""
        if any(outlet.has_subscribers() for outlet in self._sampled) or self._events:
            return 0
        return self._packer.quiet_ticks(tick * self._step_ns, self._step_ns)

    def takes_applied(self, expected: NDArray[np.bool_]) -> bool:
        """Return True: they are recorded, and kept for the publishers of actuators."""
        self._applied = expected.tobytes()
        self._keeps = bool(expected.any())
        return True

    def begin_quiet(
            self, tick: int, most: int, clock: NDArray[np.int64]) -> tuple[int, Sequence[Part]]:
        """Record what is packed; return what packs, records and keeps, as far as there is room."""
        parts = []
        if self._setpoints is not None and self._keeps:
            places, part = self._setpoints.begin()
            most, parts = min(most, places), [part]
        if self._recorder is None:
            return most, parts
        self.record()
        layout = self._packer.quiet_layout(self._step_ns, self._applied)
        room = self._recorder.open_stretch(layout, self._stamp(tick + 1), self._step_ns)
        parts.append(Part(self._packer.recording(clock, layout, room), nothing))
        return min(most, room.n_ticks), parts

    def end_quiet(self, tick: int, n_ticks: int) -> None:
        """Record what was written, then publish what is kept: no publisher loses the bag's."""
        if self._recorder is not None:
            self._recorder.close_stretch(n_ticks)
            if n_ticks:
                self._recorded = tick + n_ticks
        if self._setpoints is not None and self._keeps:
            self._setpoints.publish(tick, self._step_ns)
        for outlet in self._sampled:
            outlet.skip(n_ticks)

    def add_event(self, tick: int, text: str) -> None:
        """Publish and record an event before a tick: a pause, a step, a reset, an error."""
        message = event.pack(self._stamp(tick), text)
        self._events.append(message)
        if self._outlets.events.has_subscribers():
            self._outlets.events.publish((message,))

    def take(self, tick: int, rows: Rows) -> None:
        """Pack and publish the rows before ``tick``; `record` passes them to the recorder."""
        outlets, packer = self._outlets, self._packer
        t_ns = tick * self._step_ns
        start_ns = max(0, t_ns - self._step_ns)
        devices = packer.rare.devices(t_ns, start_ns) if outlets.actuators else ()
        subscribed = [
            row for row, outlet in enumerate(outlets.actuators)
            if outlet.has_subscribers() or packer.has_applied(row) or row in rows.tuned
            or row in devices]
        has_surroundings = outlets.surroundings.has_subscribers() or bool(
            rows.tuned_supplies)
        if self._recorder is None and not subscribed and not has_surroundings:
            return
        packer.pack(t_ns, start_ns, rows.tuned, rows.tuned_supplies)
        self._unrecorded = tick
        for row in subscribed:
            outlet = outlets.actuators[row]
            due = self._live_actuators[row].due(tick, outlet.wanted)
            outlet.publish(packer.of_actuator(row, due))
        if has_surroundings:
            outlets.surroundings.publish(
                packer.of(self._surroundings, self._live.due(tick, outlets.surroundings.wanted)))

    def end(self) -> None:
        """
        Add the diagnostics to the last instant if it is not recorded yet, and record it.

        Events after an instant that is recorded already, as an error in its tick, follow it.
        """
        if self._unrecorded is not None and self._has_end:
            diagnosed = self._packer.rare.diagnose()
            if self._outlets.surroundings.has_subscribers():
                self._outlets.surroundings.publish(
                    [diagnosed if topic.name == diagnostics.TOPIC[0] else None
                     for topic in self._surroundings])
        self.record()
        if self._events and self._recorder is not None:
            events, self._events = self._events, []
            self._recorder.write_tick(
                self._stamp(self._recorded), self._recorded, self._packer.of_events(events))

    def record(self) -> None:
        """Pass the last packed instant to the recorder, once."""
        tick, self._unrecorded = self._unrecorded, None
        if tick is None or self._recorder is None:
            return
        self._recorded = tick
        events, self._events = self._events, []
        self._recorder.write_tick(self._stamp(tick), tick, self._packer.all_messages(events))

    def _stamp(self, tick: int) -> int:
        """Return the time of a tick in stamps and in the bag, ns."""
        return self._packer.start_ns + tick * self._step_ns


def packer_of(run: RunConfig, rows: PublishedRows) -> Packer:
    """Return the packer of the rows of a run; encoding its messages takes about a millisecond."""
    return Packer(
        Names([(actuator.name, actuator.sheet.is_rotary) for actuator in run.actuators],
              run.sampled_supplies,
              {body.name: body.messages(run.step_ns) for body in run.bodies},
              [actuator.name for actuator in run.actuators if is_heated(actuator.sheet.plant)],
              run.linked, [actuator.name for actuator in run.actuators
                           if is_cushioned(actuator.sheet.plant)]), rows, start_ns=run.start_ns)
