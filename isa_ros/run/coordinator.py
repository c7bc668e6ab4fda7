"""The loop of a run in host time: pace, pauses, requests and progress; no ROS."""

from collections.abc import Callable
import math

from isa_ros.core.saved_state import RunState
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError, IsaError
from isa_ros.run.pacing import Pace, ProgressMeter, QuietStretch
from isa_ros.tick.exchange import Rows
from isa_ros.tick.tick_loop import TickLoop


ENDED = 'ended by an error: '
"""Begins the event of a run that did not come to its end."""


class Interrupted(IsaError):
    """A run that was stopped before its end."""

    exit_code = 130


Requests = Callable[['Coordinator'], None]
"""Serves new requests by `Coordinator.pause`, `step`, `reset` or `save`."""


class Coordinator:
    """
    Advance the ticks of a run that has joined, as far and as fast as host time and requests allow.

    The run ends at t = ``n_ticks`` step_ns; None: when it is stopped. ``is_paused``: wait for the
    first `step` or the end of the pause.
    """

    def __init__(
            self, loop: TickLoop, n_ticks: int | None, *, pace: Pace, progress: ProgressMeter,
            should_stop: Callable[[], bool], requests: Requests | None = None,
            is_paused: bool = False) -> None:
        self._loop = loop
        self._n_ticks = n_ticks
        self._pace = pace
        self._progress = progress
        self._should_stop = should_stop
        self._serve: Requests = _no_requests if requests is None else requests
        self._quiet = QuietStretch()
        self.is_paused = is_paused
        self.is_reset = False
        """Whether the run ended by a reset, to start again at t = 0."""
        self.restarts_paused: bool | None = None
        """Whether it then waits there; None: as the options of the run say."""
        self.save: Callable[[], RunState] = loop.save
        self.add_event: Callable[[str], None] = loop.add_event

    @property
    def rows(self) -> Rows:
        """Return the rows of the run: its samples, and the requests for the next tick."""
        return self._loop.rows

    @property
    def ticks(self) -> int:
        """Return the number of finished ticks."""
        return self._loop.ticks

    @property
    def t_ns(self) -> int:
        """Return the simulated time reached."""
        return self._loop.t_ns

    @property
    def step_ns(self) -> int:
        """Return the length of a tick."""
        return self._loop.step_ns

    def run(self, state: RunState | None = None) -> None:
        """
        Run to the end, after `TickLoop.join`, from t = 0 or from a saved state.

        However the run ends, every sample of a finished tick is passed to the recorder; after an
        error also an event that begins with `ENDED`.

        Raises
        ------
        Interrupted
            Stopped before the end; the current tick was finished if possible.
        RunError
            A participant or the recorder failed or did not answer in time.
        SimulationDiverged
            A state is no longer finite.

        """
        self._loop.begin(state)
        self._start_clocks()
        first = self.ticks
        try:
            while True:
                self._serve(self)
                if self._is_over:
                    self._loop.finish()
                    break
                if self.is_paused:
                    self._idle()
                elif self._is_due():
                    if self.ticks == first:
                        self._start_clocks()    # host time before the first tick does not count
                    self._pace.wait(self.t_ns, self._should_stop)
                    self._advance()
        except Interrupted:
            raise
        except Exception as error:
            self.add_event(f'{ENDED}{error}')
            raise
        finally:
            self._loop.end()
            if not self.is_paused:  # a paused run has no due time
                self._pace.end(self.t_ns)
            self._progress.end(self.t_ns)

    @property
    def _is_over(self) -> bool:
        return self.ticks == self._n_ticks or self.is_reset

    def _start_clocks(self) -> None:
        self._pace.start(self.t_ns)
        self._progress.start(self.t_ns)

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
            self._tick()

    def emergency_stop(self, is_open: bool) -> None:
        """Open or close the lines of all emergency stops; raises as `EmergencyStops.request`."""
        if self._loop.stops is not None:
            self._loop.stops.request(is_open, self.rows.samples)

    def reset(self, is_paused: bool | None = None) -> None:
        """
        End this run, to start again at t = 0 with a new bag.

        ``is_paused``: whether the new run waits there; None: as the options say.
        """
        self.add_event('reset')
        self.is_reset = True
        self.restarts_paused = is_paused

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

    def _idle(self) -> None:
        self._refuse_stop()
        self._loop.transport.idle()

    def _is_due(self) -> bool:
        """Return whether the commands of the next tick are there, after a moment's wait."""
        is_due = self._loop.source.is_due(self.ticks, self._loop.rows.samples)
        if not is_due:
            self._refuse_stop()
            self._loop.transport.idle(0.0)
        return is_due

    def _advance(self) -> None:
        """Advance by one tick; without a pace before it by quiet ones, for a moment."""
        if self._pace.factor == 0.0:
            self._refuse_stop()
            self._quiet.advance(self._loop, math.inf if self._n_ticks is None else self._n_ticks)
        self._tick()

    def _tick(self) -> None:
        """Advance by one tick."""
        self._refuse_stop()
        self._loop.advance()
        self._progress.update(self.t_ns)

    def _refuse_stop(self) -> None:
        if self._should_stop():
            t = self.t_ns / NS_PER_SECOND
            raise Interrupted(f'stopped at t = {t:.6f} s after {self.ticks} ticks')


def _no_requests(coordinator: Coordinator) -> None:
    """Do nothing."""
