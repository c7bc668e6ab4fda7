"""
The leg's drop, recorded: three actuators in separate processes, and in one; a quadruped's trot.

Limits of a run are found from the laps of its coordinator and the processor time of its processes.
"""

from collections.abc import Mapping, Sequence
import os
from statistics import median

from isa_ros.bench.floor import pipe_exchange, WORKERS
from isa_ros.bench.parts import divided
from isa_ros.bench.rounds import Outcomes
from isa_ros.bench.row import Aim, Row
from isa_ros.bench.spec import (
    LEG, Measured, median_of, ONE_PROCESS, parts_of_median, PROCESSES, QUADRUPED, Spec)
from isa_ros.text.table import digits

IN_PROCESSES = Spec(LEG, PROCESSES, 2000)
IN_ONE_PROCESS = Spec(LEG, ONE_PROCESS, 3000)
TROTTING = Spec(QUADRUPED, PROCESSES, 4000)
SPECS = (IN_PROCESSES, IN_ONE_PROCESS)
SHARE = 0.1
"""Of a tick, that the laps of its coordinator may leave, or be too much."""
_ALL_CORES = 1.02
"""Of all cores, that a run can use; clocks of processes are read one after another."""
_AIMS = {IN_PROCESSES: Aim(1500.0), IN_ONE_PROCESS: Aim(4000.0)}


def leg_rows(outcomes: Outcomes) -> list[Row]:
    """
    Return the speed of both ways of running with their aims, and the parts of a tick.

    In processes the recorder works at the same time as the actuators, and ``actuators`` is the
    wait for them.
    """
    pipe = pipe_exchange()
    rows = [Row(f'floor: {WORKERS} workers on pipes, no work', pipe * 1e6, 'us', 'itself', 1.0)]
    for spec in SPECS:
        runs = outcomes.of(spec)
        speed = speed_row(f'leg, {spec.way}', runs).aiming(_AIMS[spec])
        below = tick_rows(runs, pipe)
        rows.append(speed.noting(profile(runs)) if speed.is_reached is False else speed)
        rows += [row.under(speed) for row in below]
    return rows


def quadruped_rows(outcomes: Outcomes) -> list[Row]:
    """Return the speed of the quadruped's trot in processes, and the parts of its tick."""
    runs = outcomes.of(TROTTING)
    speed = speed_row(f'{TROTTING}, recording, with its controller', runs).aiming(Aim(1000.0))
    below = tick_rows(runs, pipe_exchange())
    speed = speed.noting(profile(runs)) if speed.is_reached is False else speed
    return [speed, *(row.under(speed) for row in below)]


def speed_row(name: str, runs: Sequence[Measured]) -> Row:
    """Return ticks/s with the ratio to real time."""
    row = Row.of(name, [run.ticks_per_s for run in runs], 'ticks/s')
    return row.against('real time', row.number * 1e-3)


def tick_rows(runs: Sequence[Measured], pipe: float) -> list[Row]:
    """Return the host time and the processor time of a tick, with their parts."""
    row = Row.of('a tick', [run.tick * 1e6 for run in runs], 'us')
    tick = row.number * 1e-6
    rows = [row.against('pipe floor', pipe / tick)]
    rows += divided(row, parts_of_median(
        [run.tick for run in runs], [run.phases for run in runs]), SHARE)
    rows += [Row(f'processor time of a tick, {part}', spent * 1e6, 'us', 'that tick',
                 spent / tick)
             for part, spent in median_of([run.processor for run in runs]).items()]
    share = busy(runs)
    return [*rows, Row(f'{cores()} cores in use', 100.0 * share, '%', 'all of them', share,
                       most_share=_ALL_CORES)]


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


def busy(runs: Sequence[Measured]) -> float:
    """Return the share of all cores that the processes of a run use."""
    tick = median(run.tick for run in runs)
    spent = median_of([run.processor for run in runs])
    return sum(spent.values()) / (tick * cores())


def cores() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0))
