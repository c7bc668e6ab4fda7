"""The leg's drop, recording: three actuators in processes of their own, and in one."""

from collections.abc import Sequence

from isa_ros.analysis.bench.floor import pipe_exchange, WORKERS
from isa_ros.analysis.bench.limits import busy, cores, profile
from isa_ros.analysis.bench.rounds import Outcomes
from isa_ros.analysis.bench.row import Aim, Row
from isa_ros.analysis.bench.spec import (
    LEG, Measured, median_of, ONE_PROCESS, PROCESSES, Spec)

IN_PROCESSES = Spec(LEG, PROCESSES, 2000)
IN_ONE_PROCESS = Spec(LEG, ONE_PROCESS, 3000)
SPECS = (IN_PROCESSES, IN_ONE_PROCESS)
_AIMS = {IN_PROCESSES: Aim(1500.0), IN_ONE_PROCESS: Aim(4000.0)}


def leg_rows(outcomes: Outcomes) -> list[Row]:
    """
    Return the speed of both ways beside their aims, and where a tick goes.

    In processes the recorder works while the actuators do, and ``actuators`` is the wait for
    them.
    """
    pipe = pipe_exchange()
    rows = [Row(f'floor: {WORKERS} workers on pipes, no work', pipe * 1e6, 'us', 'itself', 1.0)]
    for spec in SPECS:
        runs = outcomes.of(spec)
        speed = speed_row(f'leg, {spec.way}', runs).aiming(_AIMS[spec])
        rows.append(speed.noting(profile(runs)) if speed.is_reached is False else speed)
        rows += [row.under(speed) for row in tick_rows(runs, pipe)]
    return rows


def speed_row(name: str, runs: Sequence[Measured]) -> Row:
    """Return ticks/s against real time."""
    row = Row.of(name, [run.ticks_per_s for run in runs], 'ticks/s')
    return row.against('real time', row.number * 1e-3)


def tick_rows(runs: Sequence[Measured], pipe: float) -> list[Row]:
    """Return what a tick takes, of the host's time and of its processors'."""
    row = Row.of('a tick', [run.tick * 1e6 for run in runs], 'us')
    tick = row.number * 1e-6
    rows = [row.against('pipe floor', pipe / tick)]
    rows += [Row(f'of it {phase}', spent * 1e6, 'us', 'that tick', spent / tick)
             for phase, spent in median_of([run.phases for run in runs]).items()]
    rows += [Row(f'processor time of a tick, {part}', spent * 1e6, 'us', 'that tick',
                 spent / tick)
             for part, spent in median_of([run.processor for run in runs]).items()]
    share = busy(runs)
    return [*rows, Row(f'{cores()} cores in use', 100.0 * share, '%', 'all of them', share)]
