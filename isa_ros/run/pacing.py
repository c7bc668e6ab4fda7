"""Host time: pace and progress of a run. Results do not depend on it."""

from collections.abc import Callable
import time
from typing import NamedTuple, Protocol

from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import ConfigError

SLICE_S = 0.1  # longest sleep between two checks for a signal
REPORT_PERIOD_S = 0.2
LARGEST_LAG_S = 0.1     # at the end of a run; below this lag no warning is printed
QUIET_S = 20e-3  # ticks without a look at what has arrived
JOIN_TIMEOUT_S = 30.0  # longest wait for participants before tick 0

STARTING, JOINING = 'starting', 'joining'
"""Phases of `Laps` before the ticks: until participants are called, and until all have joined."""


class RunProgress(NamedTuple):
    """Progress of a run."""

    t_ns: int
    real_time_factor: float
    """Simulated over elapsed time since the start, or since the last pause."""
    time_left_s: float | None
    """None if the end is not known."""
    is_last: bool


class Pace:
    """
    Limits the speed of a run to ``real_time_factor``; None or 0: as fast as possible.

    Raises
    ------
    ConfigError
        The factor is negative or not finite.

    """

    def __init__(
            self, real_time_factor: float | None = None,
            now: Callable[[], float] = time.monotonic,
            sleep: Callable[[float], None] = time.sleep) -> None:
        self.set_factor(real_time_factor or 0.0)
        self._now = now
        self._sleep = sleep
        self._start = 0.0
        self._lag = 0.0

    def set_factor(self, real_time_factor: float) -> None:
        """Set the factor from the next `start` on; raises as the constructor."""
        if not 0.0 <= real_time_factor < float('inf'):
            raise ConfigError(
                f'real_time_factor = {real_time_factor:g}, must be finite and >= 0 '
                '(0: as fast as possible)')
        self.factor = real_time_factor
        self._seconds_per_ns = (
            1.0 / (NS_PER_SECOND * real_time_factor) if real_time_factor else 0.0)

    def start(self, t_ns: int = 0) -> None:
        """Take the current host time as the time of ``t_ns``."""
        self._start = self._now() - t_ns * self._seconds_per_ns

    def end(self, t_ns: int) -> None:
        """Measure how far the run is behind at its end."""
        self._lag = self.lateness(t_ns)

    def lateness(self, t_ns: int) -> float:
        """Return the host time since ``t_ns`` was due, s; 0 without a pace."""
        due = self._start + t_ns * self._seconds_per_ns
        return self._now() - due if self._seconds_per_ns else 0.0

    @property
    def shortfall(self) -> str | None:
        """Return the warning of a run that is behind its pace, one line; None if it is not."""
        if self._lag <= LARGEST_LAG_S:
            return None
        return (f'{self._lag:.1f} s of host time behind real_time_factor = {self.factor:g} '
                'at the end')

    def wait(self, t_ns: int, should_stop: Callable[[], bool]) -> None:
        """Sleep until ``t_ns`` is due; return early when a stop is requested."""
        if not self._seconds_per_ns:
            return
        due = self._start + t_ns * self._seconds_per_ns
        while (left := due - self._now()) > 0.0 and not should_stop():
            self._sleep(min(left, SLICE_S))


class QuietLoop(Protocol):
    """Ticks that are advanced in one call."""

    @property
    def ticks(self) -> int:
        """Return the number of finished ticks."""
        ...

    def advance_quietly(self, until: int) -> None:
        """Advance as far as nothing unusual happens, at most to tick ``until``."""
        ...


class QuietStretch:
    """Advances quiet ticks, as many in a call as take `QUIET_S` of host time."""

    def __init__(self, now: Callable[[], float] = time.perf_counter) -> None:
        self._now, self._most = now, 1

    def advance(self, loop: QuietLoop, n_ticks: float) -> None:
        """Advance by some quiet ticks, to the one before the last of ``n_ticks`` at most."""
        begin, first, most = self._now(), loop.ticks, self._most
        loop.advance_quietly(int(min(first + most, n_ticks - 1)))
        spent = self._now() - begin
        if loop.ticks - first < most:
            return
        fitting = int(most * QUIET_S / spent) if spent > 0.0 else 2 * most
        self._most = max(1, most // 2, min(fitting, 2 * most))


class Laps:
    """Host time of each phase of the ticks."""

    def __init__(self, now: Callable[[], float] = time.perf_counter) -> None:
        self.spent: dict[str, float] = {}
        """Seconds by phase."""
        self._now = now
        self._last = now()

    def lap(self, phase: str) -> None:
        """Add the time since the last call to ``phase``."""
        now = self._now()
        self.spent[phase] = self.spent.get(phase, 0.0) + now - self._last
        self._last = now


class ProgressMeter:
    """Report the progress of a run of ``duration_ns`` (None: open end) periodically."""

    def __init__(
            self, duration_ns: int | None, report: Callable[[RunProgress], None] | None,
            now: Callable[[], float] = time.monotonic) -> None:
        self._duration_ns = duration_ns
        self._report = report
        self._now = now
        self._start = 0.0
        self._start_ns = 0
        self._next = 0.0

    def start(self, t_ns: int = 0) -> None:
        """Take the current host time as the time of ``t_ns``; the factor counts from there."""
        self._start_ns = t_ns
        self._start = self._now()
        self._next = self._start + REPORT_PERIOD_S

    def update(self, t_ns: int) -> None:
        """Report if the last report is old enough."""
        if self._report is not None and self._now() >= self._next:
            self._next = self._now() + REPORT_PERIOD_S
            self._report(self._progress(t_ns, is_last=False))

    def end(self, t_ns: int) -> None:
        """Report the end of the run."""
        if self._report is not None:
            self._report(self._progress(t_ns, is_last=True))

    def _progress(self, t_ns: int, is_last: bool) -> RunProgress:
        elapsed = self._now() - self._start
        factor = (t_ns - self._start_ns) / (NS_PER_SECOND * elapsed) if elapsed > 0.0 else 0.0
        left = None
        if self._duration_ns is not None and factor > 0.0:
            left = (self._duration_ns - t_ns) / (NS_PER_SECOND * factor)
        return RunProgress(t_ns, factor, left, is_last)
