"""A bag that plays: its signals over host time, for all pages alike."""

from collections.abc import Callable, Sequence
from pathlib import Path
import time

from isa_ros.analysis.signals.signals import read_signals, Signal, Signals
from isa_ros.bag.reader import Bag
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.view.frames import frame_of, MOST, PERIOD_S, Samples
from isa_ros.view.hub import Hub
from isa_ros.view.orders import Order, OrderAnswer, PAUSE, SEEK, SPEED, STEP, ticks_text
from isa_ros.view.pages import ViewPage
from isa_ros.view.panels import groups_of, recorded
from isa_ros.view.scene import scene_of
import numpy as np
from numpy.typing import NDArray

_CATCH_UP_S = 0.5
"""Longest host time that one frame makes up for: a suspended program does not jump."""
_EARLY = 1e-3       # of a step, by which a sample may be before its tick


class Tracks:
    """
    The channels of a bag by tick, each with its last sample until the next one.

    A bag may have some signals at few ticks, and none of others.
    """

    def __init__(self, signals: Signals, channels: Sequence[str]) -> None:
        self._step = signals.run.step_ns / NS_PER_SECOND
        self._of = [_column(signals, name) for name in channels]
        times = {id(own.t): own.t for own in self._of}
        self._times = times

    def at(self, ticks: NDArray[np.int64]) -> NDArray[np.float32]:
        """Return the samples of all channels at some ticks, (n, n_channels)."""
        t = (ticks + _EARLY) * self._step
        places = {key: np.searchsorted(own, t, side='right') - 1
                  for key, own in self._times.items()}
        found = np.full((len(ticks), len(self._of)), np.nan, np.float32)
        for k, own in enumerate(self._of):
            place = places[id(own.t)]
            is_there = place >= 0
            found[is_there, k] = own.values[place[is_there]]
        return found


def _column(signals: Signals, channel: str) -> Signal:
    """Return one number of a signal over its times; without samples if it is not there."""
    name, bracket, place = channel.partition('[')
    signal = signals.drawn(name)
    if bracket and len(signal.t):
        return Signal(signal.t, signal.values[:, int(place.rstrip(']'))])
    return signal


class Player:
    """
    Plays the ticks of a bag, as fast as host time, again and again from where a page wants.

    ``now`` is the host time, s.
    """

    def __init__(self, bag: Path, folder: Path, now: Callable[[], float] = time.perf_counter
                 ) -> None:
        opened = Bag(bag)
        signals = read_signals(opened, needs_values=False)
        run = signals.run
        nodes = scene_of(run, folder)
        page = ViewPage(bag.resolve().name, recorded(groups_of(run), _there(signals)), nodes)
        self._tracks = Tracks(signals, page.channels)
        self._step = run.step_ns / NS_PER_SECOND
        first, last = np.rint(signals.time[[0, -1]] / self._step).astype(int).tolist()
        self._first, self._last = first, last
        self._tick = first - 1      # the last one that is shown
        self._due = float(first)    # the tick that host time has reached
        self._now, self._host = now, now()
        self._is_paused, self._speed = False, 1.0
        self.hub = Hub(page.tree(run, 'bag', last * self._step, begin=first * self._step,
                                 note=signals.problem, controls=None))
        """Its pages."""

    def play(self, should_stop: Callable[[], bool]) -> None:
        """Play until ``should_stop``; the first page begins it."""
        while not should_stop() and not self.hub.was_opened.wait(PERIOD_S):
            pass
        self._host = self._now()
        while not should_stop():
            self.hub.send(self.frame())
            time.sleep(PERIOD_S)

    def frame(self) -> bytes:
        """Carry out the orders since the last frame, and return the next one."""
        now = self._now()
        if not self._is_paused:
            self._due += min(now - self._host, _CATCH_UP_S) * self._speed / self._step
        self._host = now
        answers = [self._carry_out(order) for order in self.hub.taken()]
        return frame_of(
            self._samples(), tick=max(self._tick, self._first), is_paused=self._is_paused,
            speed=self._speed, is_over=False, answers=[own._asdict() for own in answers])

    def _samples(self) -> Samples:
        """Return the samples of the ticks that are due; at the end the bag stands still."""
        begin, end = self._tick + 1, min(int(self._due), self._last)
        every = max(1, -(-(end - begin + 1) // MOST))
        ticks = np.arange(begin, end + 1, every)
        if len(ticks):
            self._tick = int(ticks[-1])
        if self._due >= self._last:
            self._due, self._is_paused = float(self._last), True
        return Samples(begin, every, self._tracks.at(ticks))

    def _carry_out(self, order: Order) -> OrderAnswer:
        tick = max(self._tick, self._first)
        if order.what == PAUSE:
            self._is_paused = order.value
            if not self._is_paused and self._tick >= self._last:
                self._seek(self._first)
            text = 'paused' if order.value else 'plays'
        elif order.what == STEP:
            self._is_paused = True
            self._due = float(min(max(self._tick, int(self._due)) + order.value, self._last))
            text = ticks_text(order.value)
        elif order.what == SPEED:
            self._speed = order.value
            text = f'{order.value:g} times real time'
        elif order.what == SEEK:
            self._seek(round(order.value / self._step))
            text = f't = {self._due * self._step:g} s'
        else:
            return OrderAnswer(order.number, False, f'{order.what}: a bag is only played', tick)
        return OrderAnswer(order.number, True, text, tick)

    def _seek(self, tick: int) -> None:
        """Go on from a tick of the bag."""
        self._due = float(min(max(tick, self._first), self._last))
        self._tick = int(self._due) - 1


def _there(signals: Signals) -> set[str]:
    """Return the channels that a bag has."""
    found = set()
    for name in signals:
        values = signals.over_time(name).values
        found |= {name} if values.ndim == 1 else {
            f'{name}[{k}]' for k in range(values.shape[1])}
    return found
