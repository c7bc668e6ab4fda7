"""The topics of runs, from those that their bags have."""

from collections.abc import Iterator, Mapping, Sequence

from isa_ros.core.topic import Topic
from isa_ros.run.local_run import LocalRun
from isa_ros.scripting.run import load
from scripts.reference.markup import code, page, table

RUNS = ('leg', 'rig_temperature', 'crane_circuit', 'quadruped', 'press')
_HEAD = """\
What the bag of a run has, and what nodes publish, with the names of actuators, supplies,
bodies, parts, feet and inertial units replaced: ACTUATOR, SUPPLY, BODY, PART, FOOT, UNIT. They
are those of the runs {runs}. Units and signs of the numbers are those of the
[signals](../signals.md), of which the messages have a choice."""
_TAIL = """\
Kept topics are `transient_local`: a later subscription receives the last messages too. Inputs
are `~/setpoint` of every actuator, `/joint_command` of a run with a leg, and services."""


def topics_page() -> str:
    """Return the page."""
    found: dict[str, tuple[Topic, list[str]]] = {}
    for name in RUNS:
        run = load(name).configuration
        places = {f'/{own.name}/': '/ACTUATOR/' for own in run.actuators}
        places |= {f'/{own.name}/': '/SUPPLY/' for own in run.supplies}
        places |= {f'/{own.name}/': '/BODY/' for own in run.bodies}
        supplies = [own.name for own in run.supplies]
        for topic in LocalRun(run).topics:
            own = _general(topic.name, places, supplies)
            found.setdefault(own, (topic, []))[1].append(name)
    rows = [[code(name), code(topic.type_name), 'kept' if topic.qos.is_kept else '',
             ', '.join(dict.fromkeys(runs))] for name, (topic, runs) in sorted(found.items())]
    return page('Topics', _HEAD.format(runs=', '.join(map(code, RUNS))),
                table(['topic', 'type', '', 'in the bag of'], rows), _TAIL)


def _general(name: str, places: Mapping[str, str], supplies: Sequence[str]) -> str:
    for place, general in sorted(places.items(), key=lambda own: -len(own[0])):
        name = name.replace(place, general, 1) if name.startswith(place) else name
    return next(_named(name, supplies), name)


def _named(name: str, supplies: Sequence[str]) -> Iterator[str]:
    for place, of in (('/ground_contact', 'FOOT'), ('/imu', 'UNIT')):
        if name.endswith(place) and not name.startswith('/coordinator/'):
            yield f'/{of}{place}'
    for supply in supplies:
        if name == f'/coordinator/{supply}_pressure':
            yield '/coordinator/SUPPLY_pressure'
    for ending in ('_pressure', '_gas_temperature'):
        if name.startswith('/SUPPLY/') and name.endswith(ending):
            yield f'/SUPPLY/PART{ending}'
