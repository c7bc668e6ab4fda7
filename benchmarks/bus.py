"""The actuators on EtherCAT: cycles of an unmodified master over a pair of interfaces."""

from collections.abc import Callable, Mapping, Sequence
import re

from benchmarks.bus_ring import Cycles, FLOOR, measured, MeasuredRing
from isa_ros.bench.row import Aim, Row
from isa_ros.bench.spec import LEG
from isa_ros.fieldbus.request import FRAME, REAL_TIME

CYCLES, ROUNDS = 2000, 3
PLANTS = {'1': '1 actuator', LEG: 'the leg', '12': '12 actuators'}
_AIMS = {LEG: Aim(2000.0), '12': Aim(700.0)}
_LATENESS_AIM = Aim(500.0, is_most=True)    # us, of 99 % of the ticks, under SCHED_FIFO
_QUANTILES: Mapping[str, Callable[[Cycles], float]] = {
    'median': lambda cycles: cycles.median, 'p99': lambda cycles: cycles.p99}
_LATENESS = re.compile(
    r'p50 (?P<p50>\d+) us, p99 (?P<p99>\d+) us, max (?P<max>\d+) us; (?P<late>\d+) more')


def bus_rows() -> list[Row]:
    """Return the speed of each plant in frame pace, and the lateness in real-time pace."""
    rows = []
    for plant, title in PLANTS.items():
        floors, runs = [], []
        for _ in range(ROUNDS):
            floors.append(measured(MeasuredRing(plant, FLOOR, CYCLES)))
            runs.append(measured(MeasuredRing(plant, FRAME, CYCLES)))
        rows += frame_rows(title, floors, runs, _AIMS.get(plant))
    return rows + real_time_rows(measured(MeasuredRing(LEG, REAL_TIME, CYCLES)))


def frame_rows(
        title: str, floors: Sequence[Cycles | str], runs: Sequence[Cycles | str],
        aim: Aim | None) -> list[Row]:
    """Return the rows of a plant in frame pace: a cycle is a tick."""
    reasons = [one for one in (*floors, *runs) if isinstance(one, str)]
    floor, own = ([one for one in many if isinstance(one, Cycles)] for many in (floors, runs))
    if not floor or not own:
        return [Row(f'{title}, frame pace', None, 'ticks/s', note=reasons[0])]
    speed = Row.of(f'{title}, frame pace', [run.per_s for run in own], 'ticks/s')
    speed = speed.against('real time', speed.number * 1e-3)
    below = []
    for name, of in _QUANTILES.items():
        least = Row.of(
            f'floor: round trip without a plant, {name}', [of(one) * 1e6 for one in floor], 'us')
        trip = Row.of(f'round trip, {name}', [of(one) * 1e6 for one in own], 'us')
        below += [least.against('itself', 1.0),
                  trip.against('floor', least.number / trip.number)]
    if aim is not None:
        speed = speed.aiming(aim)
    if speed.is_reached is False:
        speed = speed.noting(
            f'of a cycle of {1e6 / speed.number:.0f} us: '
            + ', '.join(f'{row.name} {row.number:.0f} us' for row in below))
    if reasons:     # of a loaded host: a master gives up after its timeouts
        note = f'{len(reasons)} of {len(floors) + len(runs)} runs failed: {reasons[0]}'
        speed = speed.noting('; '.join(filter(None, [speed.note, note])))
    return [speed, *(row.under(speed) for row in below)]


def real_time_rows(run: Cycles | str) -> list[Row]:
    """Return how late the ticks of the leg begin in real-time pace."""
    name = 'the leg, real-time pace'
    if isinstance(run, str):
        return [Row(name, None, 'ticks/s', note=run)]
    found = next((_LATENESS.search(line) for line in run.log if _LATENESS.search(line)), None)
    if found is None:
        return [Row(name, None, 'us', note='the slaves have not reported their lateness')]
    note = next((line for line in run.log if 'without SCHED_FIFO' in line), '')
    speed = Row(f'{name}: cycles', run.per_s, 'ticks/s').against('real time', run.per_s * 1e-3)
    late = Row('lateness of a tick, p99', float(found['p99']), 'us')
    if not note:
        late = late.aiming(_LATENESS_AIM)
    if late.is_reached is False:
        late = late.noting('under SCHED_FIFO: other programs of that class, or a slow host')
    return [speed.noting(note), *(row.under(speed) for row in (
        Row('lateness of a tick, median', float(found['p50']), 'us'), late,
        Row('lateness of a tick, largest', float(found['max']), 'us'),
        Row('ticks more than 1 ms late', float(found['late']), '1'),
        Row('round trip, median', run.median * 1e6, 'us'),
        Row('round trip, p99', run.p99 * 1e6, 'us')))]
