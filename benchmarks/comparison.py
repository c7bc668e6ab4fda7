"""Leg and twelve actuators with other middlewares: same work, same bag, another exchange."""

from benchmarks.peers.catalogue import installed, Peer, PEERS
from isa_ros.bench.leg import IN_PROCESSES, speed_row
from isa_ros.bench.leg import profile
from isa_ros.bench.rounds import Outcomes
from isa_ros.bench.row import Aim, Row
from isa_ros.bench.spec import Spec, TWELVE

REQUIREMENTS = 'requirements-bench.txt'
FLOOR = PEERS[0]
OURS = {'': IN_PROCESSES, '12 actuators, ': TWELVE}
"""The runs of this package that peers are compared with, by the prefix of their rows."""

_AIMS = {'helics': Aim(1.8), 'zeromq': Aim(2.5, is_most=True)}


def over(peer: Peer, ours: Spec) -> Spec:
    """Return the run over a peer; with twelve workers, which start slowly, one round."""
    if ours is TWELVE:
        return Spec(ours.plant, peer.name, ours.ticks // 2, rounds=1)
    return Spec(ours.plant, peer.name, ours.ticks, ours.rounds)


def specs() -> tuple[Spec, ...]:
    """Return the runs of this package, and those over the installed peers."""
    return tuple(spec for ours in OURS.values() for spec in (
        ours, *(over(peer, ours) for peer in installed())))


def comparison_rows(outcomes: Outcomes) -> list[Row]:
    """Return ticks/s over each installed peer, and the ratios to isa_ros in the same rounds."""
    rows = [row for before, ours in OURS.items() for row in _rows(before, ours, outcomes)]
    absent = ', '.join(peer.title for peer in PEERS if peer not in installed())
    if rows and absent:
        rows[0] = rows[0].noting(f'not installed: {absent}: {REQUIREMENTS}')
    return rows


def _rows(before: str, ours: Spec, outcomes: Outcomes) -> list[Row]:
    floor, own = outcomes.of(over(FLOOR, ours)), outcomes.of(ours)
    if not own:
        return []
    rows = [speed_row(f'{before}isa_ros: shared memory, topics for subscribers', own)]
    ratios = []
    for peer in installed():
        spec = over(peer, ours)
        theirs = outcomes.of(spec)
        if not theirs:
            rows.append(Row(
                f'{before}{peer.title}', None, 'ticks/s', note=outcomes.reason(spec)))
            continue
        rows.append(speed_row(f'{before}{peer.title}', theirs))
        if peer is not FLOOR:
            ratios.append(_ratio_row(before, peer, ours, outcomes))
    if floor:
        pipes = speed_row('', floor).number
        rows = [row if row.value is None else row.against(FLOOR.title, row.value / pipes)
                for row in rows]
    return rows + ratios


def _ratio_row(before: str, peer: Peer, ours: Spec, outcomes: Outcomes) -> Row:
    """Return the ratio of isa_ros to a peer; the inverse if the aim is an upper bound of it."""
    own, theirs = outcomes.of(ours), outcomes.of(over(peer, ours))
    aim = _AIMS.get(peer.name)
    if aim is not None and aim.is_most:
        ratios = [b.ticks_per_s / a.ticks_per_s for a, b in zip(own, theirs)]
        row = Row.of(f'{before}{peer.title} over isa_ros', ratios, 'times').aiming(aim)
    else:
        ratios = [a.ticks_per_s / b.ticks_per_s for a, b in zip(own, theirs)]
        row = Row.of(f'{before}isa_ros over {peer.title}', ratios, 'times')
        row = row if aim is None else row.aiming(aim)
    return row.noting(profile(own)) if row.is_reached is False else row
