"""Memory of every process of the leg."""

from collections.abc import Sequence
from statistics import median

from isa_ros.bench import leg
from isa_ros.bench.loading import Loading, median_loading
from isa_ros.bench.rounds import Outcomes
from isa_ros.bench.row import Row
from isa_ros.bench.spec import Measured, Spec

MIB = 1024.0 * 1024.0


def memory_rows(outcomes: Outcomes) -> list[Row]:
    """Return resident and proportional memory, compared with Python with numpy and rclpy.node."""
    loading = median_loading()
    rows = [Row('floor: Python with numpy and rclpy.node, resident', loading.floor_bytes / MIB,
                'MiB', 'itself', 1.0)]
    for spec in leg.SPECS:
        rows += _process_rows(spec, outcomes.of(spec), loading)
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
            Row.of(f'leg, {spec.way}: {name}, resident', [s.resident / MIB for s in sizes],
                   'MiB').against('floor', loading.floor_bytes / median(
                       s.resident for s in sizes)),
            Row.of(f'leg, {spec.way}: {name}, proportional',
                   [s.proportional / MIB for s in sizes], 'MiB')]
    return [*rows, Row.of(f'leg, {spec.way}: all together, proportional',
                          [total(run) / MIB for run in runs], 'MiB')]


def total(run: Measured) -> int:
    """Return the proportional memory of all processes of a run, bytes."""
    return sum(size.proportional for size in run.memory)
