"""1 to 24 actuators, each with its own load: one curve in one process, one in processes."""

from collections.abc import Mapping, Sequence

from isa_ros.bench.host import available_memory
from isa_ros.bench.leg import speed_row
from isa_ros.bench.limits import profile
from isa_ros.bench.rounds import Outcomes
from isa_ros.bench.row import Aim, Row
from isa_ros.bench.spec import Measured, ONE_PROCESS, PROCESSES, Spec

Curve = Sequence[tuple[int, Sequence[Measured]]]
"""(number of actuators, runs), ascending."""

Curves = Mapping[str, Curve]
"""Curves by way of running: one process or processes."""

PROCESS_BYTES = 250 * 1024 * 1024       # more than the memory of an actuator's process

IN_ONE_PROCESS = tuple(Spec(str(n), ONE_PROCESS, ticks, rounds=2) for n, ticks in (
    (1, 3000), (2, 3000), (3, 2500), (6, 2000), (12, 1200), (24, 600)))
IN_PROCESSES = tuple(Spec(str(n), PROCESSES, ticks, rounds) for n, ticks, rounds in (
    (1, 1500, 2), (2, 1500, 2), (3, 1500, 2), (6, 1000, 2), (12, 600, 2), (24, 300, 1)))
TWELVE = next(spec for spec in IN_PROCESSES if spec.plant == '12')
_AIMS = {('12', ONE_PROCESS): Aim(1000.0), ('12', PROCESSES): Aim(500.0)}


def specs() -> tuple[Spec, ...]:
    """Return the runs of both curves, without those that need more memory than available."""
    return IN_ONE_PROCESS + tuple(
        spec for spec in IN_PROCESSES if int(spec.plant) * PROCESS_BYTES < available_memory())


def growth_rows(outcomes: Outcomes) -> list[Row]:
    """Return ticks/s for each number of actuators; those of 12 have aims."""
    return [_row(spec, outcomes) for spec in IN_ONE_PROCESS + IN_PROCESSES]


def _row(spec: Spec, outcomes: Outcomes) -> Row:
    runs = outcomes.of(spec)
    if not runs:
        return Row(str(spec), None, 'ticks/s', note='not run: too little memory')
    row = speed_row(str(spec), runs)
    aim = _AIMS.get((spec.plant, spec.way))
    row = row if aim is None else row.aiming(aim)
    return row.noting(profile(runs)) if row.is_reached is False else row


def curve(specs: Sequence[Spec], outcomes: Outcomes) -> Curve:
    """Return the runs for each number of actuators, ascending."""
    return [(int(spec.plant), runs) for spec in specs if (runs := outcomes.of(spec))]
