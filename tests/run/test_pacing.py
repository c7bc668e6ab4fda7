"""Host time: pace and progress, on a clock of the test's own."""

from isa_ros.errors import ConfigError
from isa_ros.run.pacing import (
    Laps, Pace, ProgressMeter, QUIET_S, QuietStretch, RunProgress, SLICE_S)
import pytest


class Host:
    """A clock that only sleeping moves, and what was slept."""

    def __init__(self) -> None:
        self.now = 100.0
        self.naps: list[float] = []

    def time(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.naps.append(seconds)
        self.now += seconds


def never() -> bool:
    return False


def test_pace_holds_the_run_back():
    """At factor 0.5, 10 ms of simulation last 20 ms."""
    host = Host()
    pace = Pace(0.5, host.time, host.sleep)
    pace.start()
    for tick in range(11):
        pace.wait(tick * 1_000_000, never)
    assert host.now == pytest.approx(100.02, abs=1e-9)  # 1e-9 s: eleven roundings of 100 s


def test_pace_does_not_drift():
    """A tick that takes long is made up for: due times count from the start."""
    host = Host()
    pace = Pace(1.0, host.time, host.sleep)
    pace.start()
    host.now += 0.0035
    pace.wait(1_000_000, never)
    assert host.naps == []
    pace.wait(4_000_000, never)
    assert host.naps == [pytest.approx(0.0005, abs=1e-9)]


@pytest.mark.parametrize('factor', [None, 0.0])
def test_without_factor_nothing_waits(factor):
    host = Host()
    pace = Pace(factor, host.time, host.sleep)
    pace.start()
    pace.wait(10**12, never)
    assert host.naps == []


def test_a_stop_ends_the_wait_within_a_slice():
    host = Host()
    pace = Pace(1e-6, host.time, host.sleep)
    pace.start()
    pace.wait(1_000_000, lambda: len(host.naps) == 2)
    assert host.naps == [SLICE_S, SLICE_S]


def test_a_run_that_fell_behind_says_so():
    """Ten simulated seconds in eleven of the host's: one behind; nothing where it kept pace."""
    host = Host()
    pace = Pace(1.0, host.time, host.sleep)
    pace.start()
    host.now += 11.0
    pace.end(10 * 10**9)
    assert pace.shortfall == '1.0 s of host time behind real_time_factor = 1 at the end'
    pace.start(10 * 10**9)
    pace.wait(12 * 10**9, never)
    pace.end(12 * 10**9)
    assert pace.shortfall is None


def test_a_run_without_pace_is_never_behind():
    host = Host()
    pace = Pace(None, host.time, host.sleep)
    pace.start()
    host.now += 50.0
    pace.end(1)
    assert pace.shortfall is None


def test_another_factor_counts_from_the_next_start():
    """What was simulated before does not count."""
    host = Host()
    pace = Pace(1.0, host.time, host.sleep)
    pace.start()
    pace.set_factor(0.5)
    pace.start(3_000_000)
    pace.wait(5_000_000, never)
    assert host.now == pytest.approx(100.004, abs=1e-9)


@pytest.mark.parametrize('factor', [-1.0, float('inf'), float('nan')])
def test_pace_refuses(factor):
    with pytest.raises(ConfigError, match='real_time_factor'):
        Pace(factor)


def test_progress_names_factor_and_time_left():
    host = Host()
    reports: list[RunProgress] = []
    meter = ProgressMeter(4_000_000_000, reports.append, host.time)
    meter.start()
    host.now += 0.1
    meter.update(500_000_000)
    assert reports == []
    host.now += 0.4
    meter.update(1_000_000_000)
    host.now += 1.5
    meter.end(4_000_000_000)
    assert reports == [
        RunProgress(1_000_000_000, 2.0, 1.5, False), RunProgress(4_000_000_000, 2.0, 0.0, True)]


def test_open_end_has_no_time_left():
    host = Host()
    reports: list[RunProgress] = []
    meter = ProgressMeter(None, reports.append, host.time)
    meter.start()
    host.now += 1.0
    meter.update(1_000_000_000)
    assert reports == [RunProgress(1_000_000_000, 1.0, None, False)]


def test_laps_charge_the_time_since_the_last_one():
    """Host time by phase, summed over the ticks."""
    clock = iter([0.0, 1.0, 3.0, 3.5, 7.5])
    laps = Laps(now=lambda: next(clock))
    for phase in ('send', 'wait', 'send', 'wait'):
        laps.lap(phase)
    assert laps.spent == {'send': 1.5, 'wait': 6.0}


def test_the_factor_counts_from_where_the_meter_was_started():
    """After a pause, or from a saved state: 1 s simulated in 0.5 s, not 4 s."""
    host = Host()
    reports: list[RunProgress] = []
    meter = ProgressMeter(4_000_000_000, reports.append, host.time)
    meter.start(3_000_000_000)
    host.now += 0.5
    meter.end(4_000_000_000)
    assert reports == [RunProgress(4_000_000_000, 2.0, 0.0, True)]


def test_reports_are_a_period_apart():
    """Of ticks of 1/16 s every fourth is the first that is 0.2 s after the report before."""
    host = Host()
    host.now = 0.0
    reports: list[RunProgress] = []
    meter = ProgressMeter(None, reports.append, host.time)
    meter.start()
    for tick in range(1, 17):
        host.now = tick / 16.0
        meter.update(tick * 62_500_000)
    assert [report.t_ns for report in reports] == [
        250_000_000, 500_000_000, 750_000_000, 1_000_000_000]


class Loop:
    """Quiet ticks that take a time each, of which some call does no more than a few."""

    def __init__(self, host: Host, tick_s: float) -> None:
        self.host, self.tick_s, self.ticks, self.most = host, tick_s, 0, 1000

    def advance_quietly(self, until: int) -> None:
        done = min(until - self.ticks, self.most)
        self.ticks += done
        self.host.now += done * self.tick_s


def stretches(stretch: QuietStretch, loop: Loop, n: int) -> list[int]:
    """Return the ticks of so many calls."""
    found = []
    for _ in range(n):
        before = loop.ticks
        stretch.advance(loop, 1000)
        found.append(loop.ticks - before)
    return found


def test_a_stretch_of_quiet_ticks_grows_to_its_time_and_no_further():
    """Of 1.2 ms each: 16 take 19 ms and stay, where 20 ms pass without a look at a service."""
    host = Host()
    loop, stretch = Loop(host, 1.2e-3), QuietStretch(host.time)
    assert stretches(stretch, loop, 6) == [1, 2, 4, 8, 16, 16]
    assert QUIET_S == 20e-3
    loop.tick_s = 2.8e-3                    # a slower one: 16 take 45 ms, 8 22.4 ms and 7 19.6 ms
    assert stretches(stretch, loop, 4) == [16, 8, 7, 7]
    loop.tick_s = 6.4e-4                    # 14 take 9 ms, and 31 19.8 ms
    assert stretches(stretch, loop, 4) == [7, 14, 28, 31]


def test_a_stretch_is_halved_at_most_by_a_host_that_was_busy():
    """Else the one after a pause of 1 s would be a single tick."""
    host = Host()
    loop, stretch = Loop(host, 1.2e-3), QuietStretch(host.time)
    stretches(stretch, loop, 5)
    loop.tick_s = 1.0
    assert stretches(stretch, loop, 2) == [16, 8]
    assert stretches(stretch, loop, 4) == [4, 2, 1, 1]


def test_a_stretch_that_takes_no_time_on_a_coarse_clock_grows():
    host = Host()
    assert stretches(QuietStretch(host.time), Loop(host, 0.0), 4) == [1, 2, 4, 8]


def test_a_stretch_that_was_cut_short_says_nothing_of_the_next_one():
    host = Host()
    loop, stretch = Loop(host, 1.2e-3), QuietStretch(host.time)
    for _ in range(3):
        stretch.advance(loop, 1000)
    loop.most = 2
    stretch.advance(loop, 1000)
    assert loop.ticks == 1 + 2 + 4 + 2
    loop.most = 1000
    stretch.advance(loop, 1000)
    assert loop.ticks == 9 + 8
    stretch.advance(loop, 20)
    assert loop.ticks == 19                 # the last tick of a run is for Python
