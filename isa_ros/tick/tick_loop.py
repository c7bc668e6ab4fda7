"""
The tick of a run, over actuators and controllers in this process or in others; no messages.

Tick k advances every actuator from t_k to t_k+1 = (k + 1) step_ns, then the surroundings.
At the same time controllers compute with the state of t_k; their commands take effect at t_k+1.
The rows of t_k are recorded while actuators in other processes compute tick k: there a recorder
faster than they are does not lengthen a tick. N ticks give N + 1 samples, including the state
at t = 0.
"""

from collections.abc import Callable, Sequence

from isa_ros.actuator.request_range import RequestRange
from isa_ros.core.saved_state import RunState
from isa_ros.core.signals import Records
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.requests import merge_requests
from isa_ros.surroundings.surroundings import Surroundings
from isa_ros.tick.emergency_stop import EmergencyStops
from isa_ros.tick.exchange import Ends, Rows, RowSink, Transport
from isa_ros.tick.quiet import QuietEnd, QuietTicks
from isa_ros.tick.source import ScheduledSource, Source

BEFORE_TICKS = 'between ticks'
"""Phase of the host time between two ticks."""


def ignore(line: str) -> None:
    """Do nothing with a line."""


class TickLoop:
    """
    Advances a run tick by tick and gives its rows to ``sinks`` at each instant.

    ``stops`` are the emergency stops of the run (None: it has none). ``request_range`` refuses or
    limits the requests of controllers (None: without controllers) and reports by ``warn``; ``lap``
    measures the host time of each phase of a tick.
    """

    def __init__(
            self, step_ns: int, transport: Transport, surroundings: Surroundings, rows: Rows,
            source: Source, *, stops: EmergencyStops | None = None,
            request_range: RequestRange | None = None,
            warn: Callable[[str], object] = ignore,
            lap: Callable[[str], None] = ignore) -> None:
        self._step_ns = step_ns
        self.transport = transport
        """Connection to actuators and controllers."""
        self._surroundings = surroundings
        self._beginning = surroundings.snapshot()
        self.rows = rows
        """The rows that are exchanged."""
        self.source = source
        """Commands and changes of parameters by tick."""
        self.sinks: Sequence[RowSink] = ()
        """Take the rows of each instant."""
        self.ticks = 0
        """Number of finished ticks: t = ticks step_ns."""
        self.stops = stops
        """The emergency stops."""
        self._request_range, self._warn, self._lap = request_range, warn, lap
        self._quiet = self._quiet_over(transport.ends)

    @property
    def t_ns(self) -> int:
        """Return the simulated time reached."""
        return self.ticks * self._step_ns

    @property
    def step_ns(self) -> int:
        """Return the length of a tick."""
        return self._step_ns

    def join(self) -> None:
        """Put all at t = 0; tuned values stay. Raises as `Transport.join`."""
        self.ticks = 0
        self.rows.clear_requests()
        self._surroundings.restart(self._beginning)
        if self.stops is not None:
            self.stops.restart()
        self.transport.join(self.rows)

    def begin(self, state: RunState | None = None) -> None:
        """After `join`, give out the first instant: t = 0, or that of a saved state."""
        if state is not None:
            self.restore(state)
        for sink in self.sinks:
            sink.take_time(self.ticks)
        self.transport.begin()
        for sink in self.sinks:
            sink.take(self.ticks, self.rows)

    def advance(self, given: Records | None = None) -> None:
        """
        Advance one tick; ``given`` are `COMMAND` rows instead of those of the source.

        Raises
        ------
        RunError
            A participant or the recorder failed or did not answer in time.
        SimulationDiverged
            A state is no longer finite.

        """
        rows, tick = self.rows, self.ticks
        self._lap(BEFORE_TICKS)
        self._command(given)
        self._surroundings.ports(rows.ports)
        if rows.has_supply_ports:
            self._surroundings.fill_feeds(rows.feeds)
        self._lap('commands and ports')
        for sink in self.sinks:
            sink.take_time(tick + 1)
        self.transport.send(tick, rows)
        self._lap('clock and step out')
        for sink in self.sinks:
            sink.record()
        self._lap('recorder')
        self._finish_tick()

    def _finish_tick(self) -> None:
        """End a tick whose step is out."""
        rows = self.rows
        self.transport.receive(rows)
        if rows.tuned:
            self.source.take_tuned(rows.tuned)
            if self.stops is not None:
                self.stops.take_tuned(rows.tuned)
        self._lap('actuators')
        self._surroundings.advance(rows.replies, rows.fed)
        rows.tuned_supplies = self._surroundings.tuned
        self._lap('body and supplies')
        self.ticks += 1
        for sink in self.sinks:
            sink.take(self.ticks, rows)
        self._lap('messages')

    def advance_quietly(self, until: int) -> None:
        """
        Advance in one call as far as nothing unusual happens, at most to tick ``until``.

        Possibly by no tick: `advance` then goes on. Raises as `advance`.
        """
        rows, tick = self.rows, self.ticks
        quiet = self._quiet_now()
        most, planned = min(until, self.source.quiet_until(tick)) - tick, None
        if most < 1 and isinstance(self.source, ScheduledSource):
            planned = self.source
            most = min(until, planned.planned_until(tick)) - tick
        if quiet is None or most < 1:
            return
        self._lap(BEFORE_TICKS)
        kept, ended = quiet.run(tick, int(most), self.sinks, planned)
        self.ticks += kept + (ended is QuietEnd.SEEN)
        if ended is not QuietEnd.FULL:
            for sink in self.sinks:
                sink.take_time(self.ticks + (ended is QuietEnd.BEGUN))
        self._lap('quiet ticks')
        if ended is QuietEnd.SEEN:
            for sink in self.sinks:
                sink.take(self.ticks, rows)
        elif ended is QuietEnd.BEGUN:
            self._finish_tick()

    def advance_to(self, tick: int) -> None:
        """Advance to t = tick step_ns, the last tick by Python; raises as `advance`."""
        while self.ticks < tick:
            self.advance_quietly(tick - 1)
            self.advance()

    def _quiet_now(self) -> QuietTicks | None:
        """Return the compiled loop; None: something waits to take effect that it does not know."""
        rows, transport = self.rows, self.transport
        if not (transport.is_quiet and self._surroundings.is_settled and not rows.has_requests
                and (self.stops is None or self.stops.is_quiet(rows.samples))):
            return None
        ends = transport.ends
        if self._quiet is None or self._quiet.ends is not ends:
            self._quiet = self._quiet_over(ends)
        return self._quiet if ends is not None and ends.is_settled else None

    def _quiet_over(self, ends: Ends | None) -> QuietTicks | None:
        """Return the compiled loop; None: a part of its ticks is not a kernel."""
        if ends is None:
            return None
        rows = self.rows
        parts = self._surroundings.parts(rows.ports, rows.feeds, rows.replies, rows.fed)
        return None if parts is None else QuietTicks(ends, rows, self._step_ns, *parts)

    def _command(self, given: Records | None) -> None:
        """
        Fill the commands of this tick, and change the parameters that the source changes.

        Given rows, or else the source, win over what the controllers requested in the last tick.
        """
        rows, tick = self.rows, self.ticks
        rows.take_requests()
        if self._request_range is not None:
            for line in self._request_range.admit(self.t_ns, rows.commands):
                self._warn(f't = {self.t_ns / NS_PER_SECOND:g} s: {line}')
                self.add_event(line)
        if given is None:
            self.source.commands(tick, rows.commands)
        else:
            merge_requests(given, rows.commands)
        for text in self.source.events(tick):
            self.add_event(text)
        changes = self.source.changes(tick)
        rows.changes = {} if changes is None else changes.actuators
        if changes is not None:
            self._surroundings.tune(changes.supplies)
        if self.stops is not None:
            rows.changes = self.stops.act(rows.samples, rows.changes)

    def add_event(self, text: str) -> None:
        """Give out an event at this instant."""
        for sink in self.sinks:
            sink.add_event(self.ticks, text)

    def finish(self) -> None:
        """Give the last samples to the source, and out what happened since the last tick."""
        for text in self.source.end(self.ticks, self.rows.samples):
            self.add_event(text)

    def end(self) -> None:
        """Let the sinks finish, however the run ended."""
        for sink in self.sinks:
            sink.end()

    def run(self, n_ticks: int, state: RunState | None = None) -> None:
        """After `join`, advance to t = n_ticks step_ns; raises as `advance`."""
        self.begin(state)
        self.advance_to(n_ticks)
        self.finish()
        self.end()

    def save(self) -> RunState:
        """
        Return the complete state of the run.

        Raises
        ------
        RunError
            A participant failed, or cannot be saved.

        """
        return RunState(
            tick=self.ticks, load=self._surroundings.snapshot(),
            participants=self.transport.snapshots(), requests=self.rows.requests.tobytes(),
            stops=b'' if self.stops is None else self.stops.snapshot())

    def restore(self, state: RunState) -> None:
        """
        Continue from a `save` of the same configuration.

        Raises
        ------
        ConfigError
            The state is not one of this configuration.

        """
        requests = state.rows_of_requests(len(self.rows.requests))
        lasted = None if self.stops is None else self.stops.lasted_in(state.stops, state.tick)
        self._surroundings.restore(state.load)
        self.transport.restore(state.tick, state.participants, self.rows)
        if self.stops is not None and lasted is not None:
            self.stops.restore(state.participants, lasted)
        self.rows.requests[:] = requests
        self.ticks = state.tick
