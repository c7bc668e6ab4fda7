"""The master as a source of commands, in real-time pace, on a clock of the test's own."""

from itertools import cycle
import os

from isa_ros.core.signals import COMMAND, SAMPLE
from isa_ros.fieldbus.real_time import (
    Lateness, MICROSECONDS, RealTimeSource, scheduled_first, ServedPace)
from isa_ros.fieldbus.source import FrameSource
import numpy as np
import pytest
from tests.fieldbus.toy_line import ENABLE, SILENCE, ToyDevice, ToyLine

STEP_NS = 1_000_000


class Bus:
    """One toy in real-time pace; only waiting moves the clock."""

    def __init__(self, *cycles) -> None:
        self.now = 100.0
        self.devices = [ToyDevice('knee')]
        self.line = ToyLine(self.devices, cycles, self.sleep)
        self.lines: list[str] = []
        self.pace = ServedPace(STEP_NS, now=lambda: self.now, warn=self.lines.append)
        self.source = RealTimeSource(
            FrameSource(self.line, self.devices, lambda tick: None), self.line, self.pace, 0.1,
            lambda: self.now)
        self.samples, self.rows = np.zeros(1, SAMPLE), np.zeros(1, COMMAND)
        self.events: dict[int, list[str]] = {}

    def sleep(self, seconds: float) -> None:
        self.now += seconds

    def run(self, n_ticks: int, first: int = 0) -> None:
        """Run ticks as the coordinator does."""
        if not first:
            assert self.source.is_due(0, self.samples)
            self.pace.start(0)
        for tick in range(first, first + n_ticks):
            assert self.source.is_due(tick, self.samples)
            self.pace.wait(tick * STEP_NS, lambda: False)
            self.source.commands(tick, self.rows)
            if events := self.source.events(tick):
                self.events[tick] = list(events)


def test_a_tick_needs_no_cycle_once_time_has_begun():
    bus = Bus((0, 0), (6, 0), SILENCE)
    bus.run(11)
    assert bus.now == pytest.approx(100.010, abs=1e-9)  # 1e-9 s: eleven roundings of 100 s


def test_the_last_process_data_are_used():
    bus = Bus((ENABLE, 1), (ENABLE, 2), (ENABLE, 3), SILENCE)
    bus.run(2)
    assert bus.rows['position'].tolist() == [3e-6]


def test_silence_trips_the_watchdog_once():
    """100 ms after the last cycle at t = 0: at tick 101, the first that is more than 100 ms."""
    bus = Bus((6, 0))
    bus.run(300)
    assert bus.events == {101: ['bus: no process data for 100 ms']}
    assert bus.line.log.count('miss') == 1
    assert bus.pace.times.n_stale == 299


def test_the_watchdog_looks_again_after_the_next_cycle():
    bus = Bus((6, 0), *[SILENCE] * 300, (6, 0))
    bus.run(400)
    assert len(bus.events) == 2


def test_a_host_that_stood_still_does_not_drive_on_with_a_stale_command():
    """
    One second at tick 5: 1000 ticks are made up for, without time between them.

    A frame that arrived meanwhile is new for tick 5 only. 100 ms later in simulated time, at tick
    106, the watchdog expires, although the host has just seen a frame.
    """
    bus = Bus((6, 0))
    bus.run(5)
    bus.now += 1.001
    bus.line.cycles = iter([(6, 0)])
    bus.run(1000, first=5)
    assert bus.events == {
        5: ['bus: tick 1000 ms late; the host stood still or is too slow'],
        106: ['bus: no process data for 100 ms']}
    assert bus.line.log.count('miss') == 1


def test_a_stall_is_an_event_again_once_ticks_were_in_time():
    bus = Bus((6, 0))
    bus.line.cycles = cycle([(6, 0), SILENCE])
    bus.run(5)
    for first in (5, 605):
        bus.now += 0.501
        bus.run(600, first=first)
    stalls = {tick: events[0] for tick, events in bus.events.items() if 'late' in events[0]}
    assert stalls == dict.fromkeys(
        (5, 605), 'bus: tick 500 ms late; the host stood still or is too slow')


def test_a_stall_is_one_event_until_its_ticks_are_made_up_for():
    """The host stands still again while half of the ticks are made up for."""
    bus = Bus((6, 0))
    bus.line.cycles = cycle([(6, 0), SILENCE])
    bus.run(5)
    bus.now += 0.5
    bus.run(450, first=5)       # 50 ms late, below the watchdog
    bus.now += 0.2
    bus.run(300, first=455)
    assert sum('late' in event for events in bus.events.values() for event in events) == 1


def test_a_lag_that_does_not_grow_is_said_once():
    bus = Bus((6, 0))
    bus.run(1)
    bus.now += 0.5
    for tick in range(1, 3000):
        bus.run(1, first=tick)
        bus.now += 0.001
    assert len(bus.lines) == 1


def test_a_run_that_falls_behind_says_so_once_a_second():
    """A tick takes 3 ms: 2 ms a tick are lost, 0.1 s after 50 ticks, then a line each second."""
    bus = Bus(*[(6, 0)] * 4000)
    bus.run(1)
    for tick in range(1, 1000):
        bus.run(1, first=tick)
        bus.now += 0.003
    assert bus.lines == [f'real time is not kept: {late} s behind at t = {t} s' for late, t in (
        ('0.1', '0.1'), ('0.8', '0.4'), ('1.4', '0.7'))]
    bus.now -= 2.0      # it catches up, and falls behind again
    bus.run(1, first=1000)
    bus.now += 5.0
    bus.run(2, first=1001)
    assert len(bus.lines) == 4 and bus.lines[-1].startswith('real time is not kept: 5.0 s')


def test_ticks_are_due_in_phase_with_the_clocks_of_the_line():
    bus = Bus((6, 0), *[SILENCE] * 9)
    bus.pace.phase = lambda: 0.0004
    bus.run(4)
    assert bus.now == pytest.approx(100.0034, abs=1e-9)


def test_a_cycle_that_waits_keeps_a_late_run_fed():
    """A tick that is due already still handles a frame."""
    bus = Bus((6, 0), (6, 7))
    bus.run(1)
    bus.now += 0.05
    bus.pace.wait(STEP_NS, lambda: False)
    bus.source.commands(1, bus.rows)
    assert bus.rows['position'].tolist() == [7e-6]
    assert bus.pace.times.n_stale == 0


def test_lateness_is_counted_to_the_microsecond():
    """99 ticks of 10.5 us and one of 7.8 ms; a longer one to four digits."""
    times = Lateness(1e-3)
    for _ in range(99):
        times.add(10.5e-6)
    times.add(7.8e-3)
    assert times.percentile(0.5) == times.percentile(0.99) == 11 / MICROSECONDS
    assert times.percentile(1.0) == 7.8e-3
    assert str(times) == (
        '100 ticks in real time: lateness p50 11 us, p99 11 us, max 7800 us; 1 more than a tick '
        'late, 0 without new process data')
    for late in (0.4, 0.81234, 12.3456):
        times.add(late)
    assert times.percentile(100 / 103) == 7801 / MICROSECONDS
    assert times.percentile(101 / 103) == 0.4001
    assert times.percentile(102 / 103) == 0.8124
    assert (times.percentile(1.0), times.largest) == (12.3456, 12.3456)


def test_a_run_without_a_master_says_so():
    assert str(Lateness(1e-3)) == 'no tick: no master has sent a control word'


def test_a_thread_that_may_not_be_scheduled_first_says_so(monkeypatch: pytest.MonkeyPatch):
    def refuse(*_: object) -> None:
        raise PermissionError
    monkeypatch.setattr('os.sched_setscheduler', refuse)
    lines: list[str] = []
    with scheduled_first(lines.append):
        pass
    assert lines == [
        'real-time pace without SCHED_FIFO: ticks may begin milliseconds late; it needs '
        'CAP_SYS_NICE, or rtprio in /etc/security/limits.conf']


def test_the_schedule_is_restored(monkeypatch: pytest.MonkeyPatch):
    calls = []
    monkeypatch.setattr('os.sched_setscheduler', lambda *arguments: calls.append(arguments[1]))
    with scheduled_first(calls.append):
        pass
    assert calls == [os.SCHED_FIFO, os.SCHED_OTHER]
