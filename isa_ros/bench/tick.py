"""What a tick of the leg is made of, without ROS."""

from itertools import count, islice
from pathlib import Path
import tempfile

from isa_ros.bag.writer import BagWriter
from isa_ros.bench.rigs import request_of
from isa_ros.bench.row import Row, seconds
from isa_ros.bench.spec import LEG, ONE_PROCESS, Spec
from isa_ros.config.default_actuator import DEFAULT_TIMING
from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.config.run_config import RunConfig
from isa_ros.config.run_file import load_run
from isa_ros.run.exchange import Rows
from isa_ros.run.group import ActuatorGroup
from isa_ros.run.session import prepare, provenance
from isa_ros.run.topics import topics_of
from isa_ros.scenario.scenario import load_scenario
from isa_ros.surroundings.surroundings import SharedLoad

TICKS = 500
PLANT, MESSAGES = 'three actuators: plant + REU', 'three actuators: their messages'
_DROP = Spec(LEG, ONE_PROCESS, TICKS)


def tick_parts() -> list[Row]:
    """Measure what the leg's tick is made of, without ROS; the ratio is to a whole tick."""
    run = _drop()
    load = SharedLoad(run)
    parts = actuator_parts()
    starts, rows = load.starts(run), Rows(len(run.actuators))
    rows.replies['mean_forces'] = starts['force'][:, None]

    def leg() -> None:
        for _ in range(TICKS):
            load.ports(rows.ports)
            load.advance(rows.replies)
    parts['leg and supply'] = seconds(leg, TICKS)
    parts['leg and supply: their messages'] = seconds(
        lambda: [(load.messages(k), load.clock(k)) for k in range(TICKS)], TICKS)
    parts['recorder'] = _recorder_seconds()
    whole = sum(parts.values())
    return [Row(f'tick of the leg: {name}', value * 1e6, 'us', 'sum of the parts', value / whole)
            for name, value in parts.items()]


def _drop() -> RunConfig:
    return load_scenario(find('drop.yaml', SCENARIOS), load_run(find('leg.yaml', CONFIG))).run


def actuator_parts() -> dict[str, float]:
    """Return the time that the leg's actuators take for a tick, all in one process, in s."""
    run = _drop()
    load, rows = SharedLoad(run), Rows(len(run.actuators))
    load.ports(rows.ports)
    group = _group(run, load)

    def plants() -> None:
        for _ in range(TICKS):
            group.advance(rows.ports)

    def messages() -> None:
        for _ in range(TICKS):
            group.states()
    return {PLANT: seconds(plants, TICKS), MESSAGES: seconds(messages, TICKS)}


def _group(run: RunConfig, load: SharedLoad) -> ActuatorGroup:
    """Return the actuators of a run at its start."""
    group = ActuatorGroup(run.actuators, DEFAULT_TIMING)
    for member, start in zip(group.members, load.starts(run)):
        member.start(start)
    return group


def _recorder_seconds() -> float:
    """Return the time of one tick's 22 messages in the recorder, in s."""
    with tempfile.TemporaryDirectory() as directory:
        session = prepare(request_of(_DROP, Path(directory)))
        load, rows = SharedLoad(session.run), Rows(len(session.run.actuators))
        load.ports(rows.ports)
        group = _group(session.run, load)
        order, topics = topics_of(session.run, load)
        messages = order.merge(
            [*((*applied, *states)
               for applied, states in zip(group.advance(rows.ports), group.states())),
             [load.clock(0)], load.messages(0)])
        ticks = count()
        with BagWriter(session.out, topics, provenance(session)) as bag:
            def work() -> None:
                for tick in islice(ticks, TICKS):
                    bag.write_tick(tick * session.run.step_ns, tick, messages)
            return seconds(work, TICKS)
