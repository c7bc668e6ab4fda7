"""Start-up time with warm caches: from the start of the command to its first tick."""

from isa_ros.bench import leg
from isa_ros.bench.loading import median_loading
from isa_ros.bench.rounds import Outcomes
from isa_ros.bench.row import Aim, Row
from isa_ros.bench.spec import median_of, Spec, TWELVE

SPECS = (*leg.SPECS, TWELVE)
_AIM = Aim(4.0, is_most=True)


def startup_rows(outcomes: Outcomes) -> list[Row]:
    """Return the time to tick 0 with its parts, and that of one actuator's process alone."""
    loading = median_loading()
    rows = [
        Row('floor: Python imports numba and rclpy', loading.floor, 's', 'itself', 1.0),
        Row('an actuator alone: imports', loading.imports, 's', 'floor',
            loading.floor / loading.imports),
        Row('an actuator alone: kernels from the cache', loading.kernels, 's', 'floor',
            loading.floor / loading.kernels)]
    for spec in SPECS:
        rows += _rows(spec, outcomes, loading.floor)
    return rows


def _rows(spec: Spec, outcomes: Outcomes, floor: float) -> list[Row]:
    runs = outcomes.of(spec)
    if not runs:
        return []
    parts = median_of([run.startup for run in runs])
    row = Row.of(f'{spec}: to tick 0', [sum(run.startup.values()) for run in runs], 's')
    row = row.against('floor', floor / row.number)
    if spec == leg.IN_PROCESSES:
        row = row.aiming(_AIM)
        row = row.noting(
            f'start-up: {leg.in_parts(parts, 1.0, "s")}') if row.is_reached is False else row
    return [row, *(Row(part, spent, 's', 'the whole', spent / row.number).under(row)
                   for part, spent in parts.items())]
