"""Limits of a run, from the laps of its coordinator and the processor time of its processes."""

from collections.abc import Mapping, Sequence
import os
from statistics import median

from isa_ros.bench.spec import Measured, median_of
from isa_ros.text.table import digits


def in_parts(parts: Mapping[str, float], scale: float, unit: str) -> str:
    """Return parts with their values, the largest first."""
    by_size = sorted(parts.items(), key=lambda part: -part[1])
    return ', '.join(f'{name} {digits(value * scale, 3)} {unit}' for name, value in by_size)


def profile(runs: Sequence[Measured]) -> str:
    """Return the parts of a tick, in one sentence; medians over the runs."""
    tick = median(run.tick for run in runs)
    phases, processor = (
        median_of([run.phases for run in runs]), median_of([run.processor for run in runs]))
    return (f'of a tick of {tick * 1e6:.0f} us: {in_parts(phases, 1e6, "us")}; processor time of '
            f'a tick: {in_parts(processor, 1e6, "us")}, together {busy(runs):.0%} of '
            f'{cores()} cores')


def startup_profile(runs: Sequence[Measured]) -> str:
    """Return the parts of the start-up, in one sentence; medians over the runs."""
    return f'start-up: {in_parts(median_of([run.startup for run in runs]), 1.0, "s")}'


def busy(runs: Sequence[Measured]) -> float:
    """Return the share of all cores that the processes of a run use."""
    tick = median(run.tick for run in runs)
    spent = median_of([run.processor for run in runs])
    return sum(spent.values()) / (tick * cores())


def cores() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0))
