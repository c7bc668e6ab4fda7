"""The leg over other middlewares: the same work and the same bag, another exchange."""

from isa_ros.analysis.bench.leg import IN_PROCESSES, speed_row
from isa_ros.analysis.bench.limits import profile
from isa_ros.analysis.bench.peers.catalogue import PEERS
from isa_ros.analysis.bench.rounds import Outcomes
from isa_ros.analysis.bench.row import Aim, Row
from isa_ros.analysis.bench.spec import LEG, Spec

REQUIREMENTS = 'requirements-bench.txt'
FLOOR = PEERS[0]
_SPECS = {peer: Spec(LEG, peer.name, IN_PROCESSES.ticks) for peer in PEERS}
SPECS = (IN_PROCESSES, *_SPECS.values())
_AIMS = {'helics': Aim(1.8), 'zeromq': Aim(2.5, is_most=True)}


def comparison_rows(outcomes: Outcomes) -> list[Row]:
    """Return ticks/s over each peer, and the ratios of the same rounds to isa_ros."""
    floor, ours = outcomes.of(_SPECS[FLOOR]), outcomes.of(IN_PROCESSES)
    rows, ratios = [speed_row('isa_ros: Unix sockets, topics for who listens', ours)], []
    for peer, spec in _SPECS.items():
        theirs = outcomes.of(spec)
        if not theirs:
            rows.append(Row(peer.title, None, 'ticks/s', note=_reason(outcomes.reason(spec))))
            continue
        rows.append(speed_row(peer.title, theirs))
        if peer is not FLOOR:
            ratios.append(_ratio_row(peer.name, peer.title, outcomes))
    if floor:
        pipes = speed_row('', floor).number
        rows = [row if row.value is None else row.against(FLOOR.title, row.value / pipes)
                for row in rows]
    return rows + ratios


def _reason(reason: str) -> str:
    return f'{reason}: {REQUIREMENTS}' if reason == 'not installed' else reason


def _ratio_row(name: str, title: str, outcomes: Outcomes) -> Row:
    """Return ours over theirs, or theirs over ours where that is what the aim bounds."""
    ours = outcomes.of(IN_PROCESSES)
    theirs = outcomes.of(Spec(LEG, name, IN_PROCESSES.ticks))
    aim = _AIMS.get(name)
    if aim is not None and aim.is_most:
        ratios = [b.ticks_per_s / a.ticks_per_s for a, b in zip(ours, theirs)]
        row = Row.of(f'{title} over isa_ros', ratios, 'times').aiming(aim)
    else:
        ratios = [a.ticks_per_s / b.ticks_per_s for a, b in zip(ours, theirs)]
        row = Row.of(f'isa_ros over {title}', ratios, 'times')
        row = row if aim is None else row.aiming(aim)
    return row.noting(profile(ours)) if row.is_reached is False else row
