"""
The master of a bus as the source of a run's commands, in real-time pace: a tick is a step of time.

A tick begins when it is due by the host's clock, whether or not the master has sent process data;
the last ones are used. The line is served until then. Silence of the master for the watchdog's
time is a loss of the bus, an event of the run. Ticks that come late are made up for; those without
new process data count for the watchdog too, so that a host that stood still does not drive on for
longer than it allows.

Clocks that a master reads (EtherCAT) run with host time, and ticks are due in phase with their
SYNC0.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
import os
import time

from isa_ros.core.signals import Records
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.fieldbus.line import ClockedLine, Line
from isa_ros.fieldbus.source import FrameSource
from isa_ros.run.pacing import LARGEST_LAG_S, Pace
from isa_ros.scenario.faults import ParameterChanges

PRIORITY = 50   # of SCHED_FIFO, in the middle of its range
MICROSECONDS = 1_000_000
DIGITS = 4      # of a lateness in microseconds, which is counted by
GROWTH_S = 1.0  # between two lines while a run falls behind


class Lateness:
    """How late ticks of a length in s began: their number by microseconds, of four digits."""

    def __init__(self, step: float) -> None:
        self._step = step
        self._counts: Counter[int] = Counter()
        self.n_ticks = 0
        self.n_late = 0
        """Ticks that began more than a tick late."""
        self.n_stale = 0
        """Ticks without new process data."""
        self.largest = 0.0

    def add(self, seconds: float) -> None:
        """Count a tick."""
        self.n_ticks += 1
        self.n_late += seconds > self._step
        self.largest = max(self.largest, seconds)
        self._counts[_bin_end(max(int(seconds * MICROSECONDS), 0))] += 1

    def percentile(self, share: float) -> float:
        """Return the lateness in s that a share of the ticks did not exceed."""
        left = share * self.n_ticks
        for end in sorted(self._counts):
            left -= self._counts[end]
            if left <= 0.0:
                return min(end / MICROSECONDS, max(self.largest, 1 / MICROSECONDS))
        return self.largest

    def __str__(self) -> str:
        """Return the summary of a run, one line."""
        if not self.n_ticks:
            return 'no tick: no master has sent a control word'
        p50, p99, largest = (f'{1e6 * seconds:.0f}' for seconds in (
            self.percentile(0.5), self.percentile(0.99), self.largest))
        return (f'{self.n_ticks} ticks in real time: lateness p50 {p50} us, p99 {p99} us, max '
                f'{largest} us; {self.n_late} more than a tick late, {self.n_stale} without new '
                'process data')


def _bin_end(microseconds: int) -> int:
    """Return the end of the interval that a lateness is counted in."""
    width = int(f'1{"0" * (len(str(microseconds)) - DIGITS)}')
    return (microseconds // width + 1) * width


class ServedPace(Pace):
    """
    Real time: ``serve``, called with the seconds until a tick is due, is what waits.

    ``warn`` prints a line each second in which the run falls behind.
    """

    def __init__(
            self, step_ns: int, serve: Callable[[float], None] = time.sleep,
            now: Callable[[], float] = time.monotonic,
            warn: Callable[[str], object] = lambda line: None) -> None:
        super().__init__(1.0, now, self._wait)
        self.serve = serve
        self.phase: Callable[[], float] = lambda: 0.0
        """Returns how long after its start the first tick is due, s."""
        self.times = Lateness(step_ns / NS_PER_SECOND)
        """How late the ticks began."""
        self.step = step_ns / NS_PER_SECOND
        """Length of a tick, s."""
        self._warn = warn
        self._warned, self._warned_at = 0.0, -GROWTH_S

    def start(self, t_ns: int = 0) -> None:
        """Take the current host time, and the phase of the clocks, as the time of ``t_ns``."""
        super().start(t_ns)
        self._start += self.phase()

    def end(self, t_ns: int) -> None:
        """Measure how far the run is behind, if its time has begun."""
        if self.times.n_ticks:
            super().end(t_ns)

    def wait(self, t_ns: int, should_stop: Callable[[], bool]) -> None:
        """Serve until ``t_ns`` is due; return early when a stop is requested."""
        super().wait(t_ns, should_stop)
        late = self.lateness(t_ns)
        self.times.add(late)
        if late > LARGEST_LAG_S or self._warned:
            self._report(late, t_ns)

    def _report(self, late: float, t_ns: int) -> None:
        """Print a line if the run has lost a tick or more since the last one."""
        if late <= LARGEST_LAG_S:
            self._warned = 0.0
        elif late > self._warned + self.step and self._now() - self._warned_at >= GROWTH_S:
            self._warned, self._warned_at = late, self._now()
            self._warn(f'real time is not kept: {late:.1f} s behind at t = '
                       f'{t_ns / NS_PER_SECOND:.1f} s')

    def _wait(self, seconds: float) -> None:
        self.serve(seconds)


class RealTimeSource:
    """
    A `Source` that never waits once time has begun: ``pace`` serves the line between ticks.

    ``watchdog`` is the silence in s after which the bus counts as lost, of the host's time or of
    simulated time.
    """

    def __init__(
            self, frames: FrameSource, line: Line, pace: ServedPace, watchdog: float,
            now: Callable[[], float] = time.monotonic) -> None:
        self._frames, self._line, self._pace = frames, line, pace
        self._watchdog, self._now = watchdog, now
        self._last = 0.0
        self._stale_ticks = 0
        self._is_fresh = self._is_watched = self._is_behind = False
        self._events: list[str] = []
        pace.serve = self.serve
        if isinstance(line, ClockedLine):
            line.keep_host_time(lambda: round(now() * NS_PER_SECOND))
            pace.phase = line.until_sync
        self.changes: Callable[[int], ParameterChanges | None] = frames.changes
        self.end: Callable[[int, Records], Sequence[str]] = frames.end
        self.take_tuned = frames.take_tuned

    def quiet_until(self, tick: int) -> float:
        """Return the tick itself: frames may bring commands for any."""
        return tick

    def is_due(self, tick: int, samples: Records) -> bool:
        """Return True once time has begun; before, serve the line for a moment."""
        if self._frames.has_begun:
            self._frames.show(tick, samples)
        elif self._frames.is_due(tick, samples):
            self._note_cycle()
        return self._frames.has_begun

    def serve(self, seconds: float) -> None:
        """Serve the line for at most some seconds, or until a cycle begins."""
        if self._line.serve(seconds):
            self._note_cycle()

    def _note_cycle(self) -> None:
        self._last = self._now()
        self._is_fresh = self._is_watched = True

    def commands(self, tick: int, out: Records) -> None:
        """Write what the master commanded last, after the watchdog has looked at its age."""
        self._note_stall(tick)
        if not self._is_fresh:
            self.serve(0.0)
        self._stale_ticks = 0 if self._is_fresh else self._stale_ticks + 1
        if not self._is_fresh:
            self._pace.times.n_stale += 1
            if self._is_watched and self._age > self._watchdog:
                self._is_watched = False
                self._line.miss()
                self._events.append(
                    f'bus: no process data for {1e3 * self._watchdog:g} ms')
        self._is_fresh = False
        self._frames.commands(tick, out)

    @property
    def _age(self) -> float:
        """Return the age of the last process data in s, of simulated or of host time."""
        return max(self._stale_ticks * self._pace.step, self._now() - self._last)

    def _note_stall(self, tick: int) -> None:
        """Note that a tick begins later than the watchdog allows, once until they are in time."""
        late = self._pace.lateness(round(tick * self._pace.step * NS_PER_SECOND))
        if late > self._watchdog and not self._is_behind:
            self._events.append(
                f'bus: tick {1e3 * late:.0f} ms late; the host stood still or is too slow')
        self._is_behind = late > (self._pace.step if self._is_behind else self._watchdog)

    def events(self, tick: int) -> Sequence[str]:
        """Return the trips of the watchdog and the faults of connections since the last tick."""
        events, self._events = [*self._frames.events(tick), *self._events], []
        return events


@contextmanager
def scheduled_first(warn: Callable[[str], object]) -> Iterator[None]:
    """
    Schedule this thread before all others (SCHED_FIFO); where this is not allowed, say so.

    Threads that it starts meanwhile inherit it: the recorder's shares the lock of the interpreter,
    and would hold it while other programs have the processor.
    """
    before = os.sched_getscheduler(0)
    parameters = os.sched_getparam(0)
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    except PermissionError:
        warn('real-time pace without SCHED_FIFO: ticks may begin milliseconds late; it needs '
             'CAP_SYS_NICE, or rtprio in /etc/security/limits.conf')
        yield
        return
    try:
        yield
    finally:
        os.sched_setscheduler(0, before, parameters)
