"""Measure a run in its coordinator's process: laps, start-up, memory, processor time."""

from dataclasses import replace
import os
import time

from isa_ros.bench.host import children_of, memory_of, processor_seconds_of
from isa_ros.bench.spec import (
    ACTUATORS, COORDINATOR, JOINED, Measured, PREPARED, ProcessMemory, RECORDER)
from isa_ros.errors import RunError
from isa_ros.run.options import Request
from isa_ros.run.pacing import JOINING, Laps, RunProgress, STARTING
from isa_ros.tick.tick_loop import BEFORE_TICKS


class FirstLaps(Laps):
    """
    Laps with the first end of each phase, and the processor time before the ticks.

    `BEFORE_TICKS` is that of the ticks alone: without the time before the first one.
    """

    def __init__(self) -> None:
        super().__init__()
        self.first: dict[str, float] = {}
        self.spent_before: dict[str, float] = {}

    def lap(self, phase: str) -> None:
        """Add the time since the last call; at the first tick, store the processor time."""
        if phase not in self.first:
            self.first[phase] = time.monotonic()
            if phase == BEFORE_TICKS:
                self.spent_before = processor_seconds()
                super().lap(phase)
                self.spent[phase] = 0.0
                return
        super().lap(phase)


class Watch:
    """
    Measures one run; ``startup`` are the parts of the start-up before it.

    ``started``: monotonic clock at the start of its process.
    """

    def __init__(self, startup: dict[str, float], started: float) -> None:
        self._startup, self._started = startup, started
        self._laps = FirstLaps()
        self._begun = time.monotonic()
        self._factor = 0.0
        self._memory: list[ProcessMemory] = []
        self._spent: dict[str, float] = {}

    def request(self, request: Request) -> Request:
        """Return the request with these laps."""
        return replace(request, laps=self._laps)

    def report(self, progress: RunProgress) -> None:
        """Measure memory and processor time at the end of the run, while its processes exist."""
        if not progress.is_last:
            return
        self._factor = progress.real_time_factor
        after, before = processor_seconds(), self._laps.spent_before
        self._spent = {part: after[part] - before[part] for part in before}
        me = os.getpid()
        self._memory = [memory_of(pid) for pid in (me, *children_of(me))]

    def measured(self, ticks: int) -> Measured:
        """
        Return the measured values of a run of ``ticks`` ticks.

        Raises
        ------
        RunError
            The run ended before its first tick.

        """
        first = self._laps.first
        if BEFORE_TICKS not in first or not self._factor:
            raise RunError('the run ended before its first tick')
        parts, begun = dict(self._startup), self._begun
        for part, phase in ((PREPARED, STARTING), (JOINED, JOINING), (RECORDER, BEFORE_TICKS)):
            parts[part] = first[phase] - begun
            begun = first[phase]
        return Measured(
            ticks_per_s=1e3 * self._factor, startup=parts,
            to_tick_0=first[BEFORE_TICKS] - self._started,
            phases={phase: spent / ticks for phase, spent in self._laps.spent.items()
                    if phase not in (STARTING, JOINING)},
            processor={part: spent / ticks for part, spent in self._spent.items()},
            memory=self._memory)


def processor_seconds() -> dict[str, float]:
    """Return the processor time so far of this process, and of its children together."""
    spent = {COORDINATOR: time.process_time()}
    children = children_of(os.getpid())
    if children:
        spent[ACTUATORS] = sum(processor_seconds_of(child) for child in children)
    return spent
