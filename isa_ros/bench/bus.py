"""The actuators on EtherCAT: cycles of an unmodified master over a pair of interfaces."""

import re

from isa_ros.bench.bus_ring import Cycles, FLOOR, measured, missing, Ring
from isa_ros.bench.row import Aim, Row
from isa_ros.bench.spec import LEG
from isa_ros.fieldbus.request import FRAME, REAL_TIME

CYCLES = 2000
PLANTS = {'1': '1 actuator', LEG: 'the leg', '12': '12 actuators'}
_AIMS = {LEG: Aim(2000.0), '12': Aim(700.0)}
_LATENESS = re.compile(
    r'p50 (?P<p50>\d+) us, p99 (?P<p99>\d+) us, max (?P<max>\d+) us; (?P<late>\d+) more')


def bus_rows() -> list[Row]:
    """Return the speed of each plant in frame pace, and the lateness in real-time pace."""
    reason = missing()
    if reason:
        return [Row('cycles of a master', None, 'ticks/s', note=reason)]
    rows = []
    for plant, title in PLANTS.items():
        rows += frame_rows(
            title, measured(Ring(plant, FLOOR, CYCLES)), measured(Ring(plant, FRAME, CYCLES)),
            _AIMS.get(plant))
    return rows + real_time_rows(measured(Ring(LEG, REAL_TIME, CYCLES)))


def frame_rows(
        title: str, floor: Cycles | str, run: Cycles | str, aim: Aim | None) -> list[Row]:
    """Return the rows of a plant in frame pace: a cycle is a tick."""
    if isinstance(floor, str) or isinstance(run, str):
        reasons = [one for one in (floor, run) if isinstance(one, str)]
        return [Row(f'{title}, frame pace', None, 'ticks/s', note=reasons[0])]
    speed = Row(f'{title}, frame pace', run.per_s, 'ticks/s').against(
        'real time', run.per_s * 1e-3)
    speed = speed if aim is None else speed.aiming(aim)
    return [speed, *(row.under(speed) for row in (
        Row('floor: round trip without a plant, median', floor.median * 1e6, 'us', 'itself', 1.0),
        Row('round trip, median', run.median * 1e6, 'us').against(
            'floor', floor.median / run.median),
        Row('floor: round trip without a plant, p99', floor.p99 * 1e6, 'us', 'itself', 1.0),
        Row('round trip, p99', run.p99 * 1e6, 'us').against('floor', floor.p99 / run.p99)))]


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
    return [speed.noting(note), *(row.under(speed) for row in (
        Row('lateness of a tick, median', float(found['p50']), 'us'),
        Row('lateness of a tick, p99', float(found['p99']), 'us'),
        Row('lateness of a tick, largest', float(found['max']), 'us'),
        Row('ticks more than 1 ms late', float(found['late']), '1'),
        Row('round trip, median', run.median * 1e6, 'us'),
        Row('round trip, p99', run.p99 * 1e6, 'us')))]
