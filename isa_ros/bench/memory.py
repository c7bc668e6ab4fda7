"""Memory of every process, and the memory added by one more actuator."""

from collections.abc import Sequence
from statistics import median

from isa_ros.bench import growth, leg
from isa_ros.bench.loading import Loading, median_loading
from isa_ros.bench.rounds import Outcomes
from isa_ros.bench.row import Row
from isa_ros.bench.spec import Measured, Spec

_MIB = 1024.0 * 1024.0


def specs() -> tuple[Spec, ...]:
    """Return the runs whose memory is evaluated."""
    return leg.SPECS + growth.specs()


def memory_rows(outcomes: Outcomes) -> list[Row]:
    """Return resident and proportional memory, compared with Python with numba and rclpy."""
    loading = median_loading()
    rows = [Row('floor: Python with numba and rclpy, resident', loading.floor_bytes / _MIB, 'MiB',
                'itself', 1.0)]
    for spec in leg.SPECS:
        rows += _process_rows(spec, outcomes.of(spec), loading)
    for specs, way in ((growth.IN_ONE_PROCESS, 'in one process'),
                       (growth.IN_PROCESSES, 'in processes')):
        rows.append(_added_row(way, growth.curve(specs, outcomes)))
    return rows


def _process_rows(spec: Spec, runs: Sequence[Measured], loading: Loading) -> list[Row]:
    """Return the memory of the coordinator's process, of an actuator's, and of all processes."""
    rows = []
    actuators = [size for run in runs for size in run.memory[1:]]
    for name, sizes in (('coordinator', [run.memory[0] for run in runs]),
                        ('an actuator', actuators)):
        if not sizes:
            continue
        rows += [
            Row.of(f'leg, {spec.way}: {name}, resident', [s.resident / _MIB for s in sizes],
                   'MiB').against('floor', loading.floor_bytes / median(
                       s.resident for s in sizes)),
            Row.of(f'leg, {spec.way}: {name}, proportional',
                   [s.proportional / _MIB for s in sizes], 'MiB')]
    return [*rows, Row.of(f'leg, {spec.way}: all together, proportional',
                          [total(run) / _MIB for run in runs], 'MiB')]


def total(run: Measured) -> int:
    """Return the proportional memory of all processes of a run, bytes."""
    return sum(size.proportional for size in run.memory)


def _added_row(way: str, curve: growth.Curve) -> Row:
    """Return the proportional memory per added actuator, from the fewest to the most."""
    name = f'one actuator more, {way}'
    if len(curve) < 2:
        return Row(name, None, 'MiB', note='not run')
    (fewest, first), (most, last) = curve[0], curve[-1]
    added = (median(map(total, last)) - median(map(total, first))) / (most - fewest)
    return Row(f'{name}, {fewest} to {most}', added / _MIB, 'MiB')
