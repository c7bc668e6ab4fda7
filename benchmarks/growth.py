"""1 to 24 actuators, each with its own load: one curve in one process, one in processes."""

from statistics import median

from benchmarks.growth_figure import Curve, growth_figure
from isa_ros.bench.host import available_memory
from isa_ros.bench.leg import profile, speed_row
from isa_ros.bench.memory import MIB, total
from isa_ros.bench.page import BenchDrawing
from isa_ros.bench.rounds import Outcomes
from isa_ros.bench.row import Aim, Row
from isa_ros.bench.spec import ONE_PROCESS, PROCESSES, Spec

PROCESS_BYTES = 250 * 1024 * 1024       # more than the memory of an actuator's process

IN_ONE_PROCESS = tuple(Spec(str(n), ONE_PROCESS, ticks, rounds=2) for n, ticks in (
    (1, 3000), (2, 3000), (3, 2500), (6, 2000), (12, 1200), (24, 600)))
IN_PROCESSES = tuple(Spec(str(n), PROCESSES, ticks, rounds) for n, ticks, rounds in (
    (1, 1500, 2), (2, 1500, 2), (3, 1500, 2), (6, 1000, 2), (12, 600, 2), (24, 300, 1)))
_AIMS = {('12', ONE_PROCESS): Aim(1000.0), ('12', PROCESSES): Aim(500.0)}


def specs() -> tuple[Spec, ...]:
    """Return the runs of both curves, without those that need more memory than available."""
    return IN_ONE_PROCESS + tuple(
        spec for spec in IN_PROCESSES if int(spec.plant) * PROCESS_BYTES < available_memory())


def growth_rows(outcomes: Outcomes) -> list[Row]:
    """Return ticks/s for each number of actuators, and the memory added by one more."""
    return [*(_row(spec, outcomes) for spec in IN_ONE_PROCESS + IN_PROCESSES),
            *(_added_row(way, curve) for way, curve in curves(outcomes).items())]


def drawing(outcomes: Outcomes) -> BenchDrawing | None:
    """Return the figure of both curves, None if one of them was not run."""
    found = curves(outcomes)
    if not all(len(curve) > 1 for curve in found.values()):
        return None
    return BenchDrawing('Ticks per second over the number of actuators', growth_figure(found))


def curves(outcomes: Outcomes) -> dict[str, Curve]:
    """Return the runs for each number of actuators, ascending, by way of running."""
    return {name: [(int(spec.plant), runs) for spec in specs if (runs := outcomes.of(spec))]
            for name, specs in (('one process', IN_ONE_PROCESS), ('processes', IN_PROCESSES))}


def _row(spec: Spec, outcomes: Outcomes) -> Row:
    runs = outcomes.of(spec)
    if not runs:
        return Row(str(spec), None, 'ticks/s', note='not run: too little memory')
    row = speed_row(str(spec), runs)
    aim = _AIMS.get((spec.plant, spec.way))
    row = row if aim is None else row.aiming(aim)
    return row.noting(profile(runs)) if row.is_reached is False else row


def _added_row(way: str, curve: Curve) -> Row:
    """Return the proportional memory per added actuator, from the fewest to the most."""
    name = f'one actuator more, in {way}'
    if len(curve) < 2:
        return Row(name, None, 'MiB', note='not run')
    (fewest, first), (most, last) = curve[0], curve[-1]
    added = (median(map(total, last)) - median(map(total, first))) / (most - fewest)
    return Row(f'{name}, {fewest} to {most}', added / MIB, 'MiB')
