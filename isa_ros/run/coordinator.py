"""
The loop of a run, with one barrier per tick; no ROS.

Tick k advances every actuator from t_k to t_k+1 = (k + 1) step_ns, then the surroundings.
At the same time controllers compute with the state of t_k; their commands take effect at t_k+1.
The sample of t_k is recorded while the actuators compute tick k: a recorder faster than the
actuators does not lengthen a tick. N ticks give N + 1 samples, including the state at t = 0.
"""

from collections.abc import Callable
from dataclasses import dataclass

from isa_ros.core.saved_state import RunState
from isa_ros.core.signals import Records
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError, IsaError
from isa_ros.run.exchange import Rows, Transport
from isa_ros.run.narrator import Narrator
from isa_ros.run.pacing import BEFORE_TICKS, Laps, Pace, ProgressMeter
from isa_ros.run.source import Source
from isa_ros.surroundings.surroundings import Surroundings


class Interrupted(IsaError):
    """A run that was stopped before its end."""

    exit_code = 130


def admit_all(t_ns: int, requests: Records) -> None:
    """Admit every request."""


@dataclass(frozen=True, kw_only=True)
class Plan:
    """Content and length of a run."""

    step_ns: int
    rows: Rows
    n_ticks: int | None
    """The run ends at t = n_ticks step_ns; None: when it is stopped."""
    source: Source
    """Overwrites `COMMAND` rows of one tick, which contain the requests of controllers."""
    admit: Callable[[int, Records], None] = admit_all
    """Refuses or limits those requests, given the time in ns, before they become commands."""
    is_paused: bool = False
    """Start paused: wait for the first `Coordinator.step` or the end of the pause."""


Requests = Callable[['Coordinator'], None]
"""Serves new requests by `Coordinator.pause`, `step`, `reset` or `save`."""


class Coordinator:
    """Advance actuators and their surroundings tick by tick; pass samples to the narrator."""

    def __init__(
            self, plan: Plan, transport: Transport, surroundings: Surroundings,
            narrator: Narrator, *, pace: Pace, progress: ProgressMeter,
            should_stop: Callable[[], bool], requests: Requests | None = None,
            laps: Laps | None = None) -> None:
        self._plan = plan
        self._rows = plan.rows
        self._lap: Callable[[str], None] = _no_lap if laps is None else laps.lap
        self._transport = transport
        self._surroundings = surroundings
        self._narrator = narrator
        self._pace = pace
        self._progress = progress
        self._should_stop = should_stop
        self._serve: Requests = _no_requests if requests is None else requests
        self.ticks = 0
        """Number of finished ticks: t = ticks step_ns."""
        self.is_paused = plan.is_paused
        self.is_reset = False
        """Whether the run ended by a reset, to start again at t = 0."""

    @property
    def t_ns(self) -> int:
        """Return the simulated time reached."""
        return self.ticks * self._plan.step_ns

    def run(self, state: RunState | None = None) -> None:
        """
        Run to the end, after `Transport.join`, from t = 0 or from a saved state.

        However the run ends, every sample of a finished tick is passed to the recorder.

        Raises
        ------
        Interrupted
            Stopped before the end; the current tick was finished if possible.
        RunError
            A participant or the recorder failed or did not answer in time.
        SimulationDiverged
            A state is no longer finite.

        """
        if state is not None:
            self._restore(state)
        self._narrator.publish_time(self.ticks)
        self._transport.begin()
        self._narrator.publish_rows(self.ticks, self._rows.tuned, self._surroundings.tuned)
        self._start_clocks()
        first = self.ticks
        try:
            while True:
                self._serve(self)
                if self._is_over:
                    self._plan.source.end(self.ticks, self._rows.samples)
                    break
                if self.is_paused:
                    self._idle()
                elif self._is_due():
                    if self.ticks == first:
                        self._start_clocks()    # host time before the first tick does not count
                    self._pace.wait(self.t_ns, self._should_stop)
                    self._advance()
        finally:
            self._narrator.end()
            if not self.is_paused:  # a paused run has no due time
                self._pace.end(self.t_ns)
            self._progress.end(self.t_ns)

    @property
    def _is_over(self) -> bool:
        return self.ticks == self._plan.n_ticks or self.is_reset

    def _start_clocks(self) -> None:
        self._pace.start(self.t_ns)
        self._progress.start(self.t_ns)

    def _restore(self, state: RunState) -> None:
        self.ticks = state.tick
        self._surroundings.restore(state.load)
        self._rows.requests[:] = state.rows_of_requests(len(self._rows.requests))
        self._transport.restore(state.tick, state.participants, self._rows)

    def pause(self, is_paused: bool) -> None:
        """Pause before the next tick, or resume."""
        if is_paused == self.is_paused:
            return
        self.is_paused = is_paused
        self.add_event('pause' if is_paused else 'resume')
        self._start_clocks()

    def step(self, n_ticks: int) -> None:
        """
        Advance exactly ``n_ticks`` while paused; fewer only if the run ends before.

        Raises
        ------
        ConfigError
            The run is not paused.

        """
        if not self.is_paused:
            raise ConfigError('step: the run is not paused, pause it first')
        self.add_event(f'step {n_ticks}')
        for _ in range(n_ticks):
            if self._is_over:
                break
            while not self._is_due():
                pass
            self._advance()

    def reset(self) -> None:
        """End this run, to start again at t = 0 with a new bag."""
        self.add_event('reset')
        self.is_reset = True

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
            participants=self._transport.snapshots(), requests=self._rows.requests.tobytes())

    def set_real_time_factor(self, factor: float) -> None:
        """
        Continue at ``factor`` times real time; 0: as fast as possible.

        Raises
        ------
        ConfigError
            The factor is negative or not finite.

        """
        self._pace.set_factor(factor)
        self._start_clocks()

    def add_event(self, event: str) -> None:
        """Record and publish an event at this instant."""
        self._narrator.add_event(self.ticks, event)

    def _idle(self) -> None:
        self._refuse_stop()
        self._transport.idle()

    def _is_due(self) -> bool:
        """Return whether the commands of the next tick are there, after a moment's wait."""
        is_due = self._plan.source.is_due(self.ticks, self._rows.samples)
        if not is_due:
            self._refuse_stop()
            self._transport.idle(0.0)
        return is_due

    def _advance(self) -> None:
        self._refuse_stop()
        self._tick(self.ticks)
        self._progress.update(self.t_ns)

    def _refuse_stop(self) -> None:
        if self._should_stop():
            t = self.t_ns / NS_PER_SECOND
            raise Interrupted(f'stopped at t = {t:.6f} s after {self.ticks} ticks')

    def _tick(self, tick: int) -> None:
        rows = self._rows
        self._lap(BEFORE_TICKS)
        rows.commands[:] = rows.requests
        rows.requests['kinds'] = 0
        self._plan.admit(self.t_ns, rows.commands)
        self._plan.source.commands(tick, rows.commands)
        for event in self._plan.source.events(tick):
            self.add_event(event)
        self._change(tick)
        self._surroundings.ports(rows.ports)
        self._lap('commands and ports')
        self._narrator.publish_time(tick + 1)
        self._transport.send(tick, rows)
        self._lap('clock and step out')
        self._narrator.record()
        self._lap('recorder')
        self._transport.receive(rows)
        if rows.tuned:
            self._plan.source.take_tuned(rows.tuned)
        self._lap('actuators')
        self._surroundings.advance(rows.replies)
        self._lap('body and supplies')
        self.ticks = tick + 1
        self._narrator.publish_rows(self.ticks, self._rows.tuned, self._surroundings.tuned)
        self._lap('messages')

    def _change(self, tick: int) -> None:
        """Change the parameters that the source changes at a tick."""
        changes = self._plan.source.changes(tick)
        self._rows.changes = {} if changes is None else changes.actuators
        if changes is not None:
            self._surroundings.tune(changes.supplies)


def _no_lap(phase: str) -> None:
    """Measure nothing."""


def _no_requests(coordinator: Coordinator) -> None:
    """Do nothing."""
