"""Start-up time with warm caches: from the start of the command to its first tick."""

from isa_ros.bench import leg
from isa_ros.bench.loading import Loading, median_loading
from isa_ros.bench.parts import divided
from isa_ros.bench.rounds import Outcomes
from isa_ros.bench.row import Aim, Row
from isa_ros.bench.spec import parts_of_median, Spec, TWELVE

SPECS = (*leg.SPECS, TWELVE)
_AIM, _ALONE_AIM = Aim(4.0, is_most=True), Aim(0.4, is_most=True)
SHARE = 0.05
"""Of a start-up, that its parts may leave."""


def startup_rows(outcomes: Outcomes) -> list[Row]:
    """Return the time to tick 0 with its parts, and that of one actuator's process alone."""
    loading = median_loading()
    rows = [
        Row('floor: Python imports numpy and rclpy.node', loading.floor, 's', 'itself', 1.0),
        *_alone(loading)]
    for spec in SPECS:
        rows += _rows(spec, outcomes, loading.floor)
    return rows


def _alone(loading: Loading) -> list[Row]:
    """Return the time of a lone actuator's process to its first tick, and its parts."""
    row = Row('an actuator alone: to its first tick', loading.whole, 's').against(
        'floor', loading.floor / loading.whole).aiming(_ALONE_AIM)
    parts = {'imports': loading.imports, 'kernels from the cache': loading.kernels}
    if row.is_reached is False:
        row = row.noting(f'start-up: {leg.in_parts(parts, 1.0, "s")}')
    return [row, *divided(row, parts, SHARE, '')]


def _rows(spec: Spec, outcomes: Outcomes, floor: float) -> list[Row]:
    runs = outcomes.of(spec)
    if not runs:
        return []
    parts = parts_of_median(
        [run.to_tick_0 for run in runs], [run.startup for run in runs])
    row = Row.of(f'{spec}: to tick 0', [run.to_tick_0 for run in runs], 's')
    row = row.against('floor', floor / row.number)
    if spec == leg.IN_PROCESSES:
        row = row.aiming(_AIM)
        row = row.noting(
            f'start-up: {leg.in_parts(parts, 1.0, "s")}') if row.is_reached is False else row
    return [row, *divided(row, parts, SHARE, '')]
