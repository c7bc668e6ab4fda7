"""What a tick of the leg is made of, without ROS."""

from collections.abc import Sequence
from itertools import count, islice
from pathlib import Path
import tempfile

from isa_ros.analysis.bench.rigs import request_of
from isa_ros.analysis.bench.row import Row, seconds
from isa_ros.analysis.bench.spec import LEG, ONE_PROCESS, Spec
from isa_ros.bag.writer import BagWriter
from isa_ros.config import load_run
from isa_ros.default_actuator import DEFAULT_TIMING
from isa_ros.exchange import Rows
from isa_ros.paths import CONFIG, find, SCENARIOS
from isa_ros.run import prepare, provenance
from isa_ros.scenario import load_scenario
from isa_ros.shared_load import SharedLoad
from isa_ros.stepping import SteppedActuator
from isa_ros.topics import topics_of

TICKS = 500
_DROP = Spec(LEG, ONE_PROCESS, TICKS)


def tick_parts() -> list[Row]:
    """Measure what the leg's tick is made of, without ROS; the ratio is to a whole tick."""
    run = load_scenario(find('drop.yaml', SCENARIOS), load_run(find('leg.yaml', CONFIG))).run
    timing = DEFAULT_TIMING
    load = SharedLoad(run)
    starts, rows = load.starts(run), Rows(len(run.actuators))
    ports, replies = rows.ports, rows.replies
    load.ports(ports)
    parts = {}
    stepped = [SteppedActuator(config, timing) for config in run.actuators]
    for actuator, start in zip(stepped, starts):
        actuator.start(start)

    def kernels_only() -> None:
        for _ in range(TICKS):
            for k, actuator in enumerate(stepped):
                actuator.actuator.tick(ports[k])

    def with_messages() -> None:
        for _ in range(TICKS):
            for k, actuator in enumerate(stepped):
                actuator.advance(ports[k])
                actuator.states()
    parts['three actuators: plant + REU'] = seconds(kernels_only, TICKS)
    for k, actuator in enumerate(stepped):
        actuator.start(starts[k])
    parts['three actuators: their messages'] = (
        seconds(with_messages, TICKS) - parts['three actuators: plant + REU'])

    def leg() -> None:
        for _ in range(TICKS):
            load.ports(ports)
            load.advance(replies)
    replies['mean_forces'] = starts['force'][:, None]
    parts['leg and supply'] = seconds(leg, TICKS)
    parts['leg and supply: their messages'] = seconds(
        lambda: [(load.messages(k), load.clock(k)) for k in range(TICKS)], TICKS)
    parts['recorder'] = _recorder_seconds(load, stepped)
    whole = sum(parts.values())
    return [Row(f'tick of the leg: {name}', value * 1e6, 'us', 'sum of the parts', value / whole)
            for name, value in parts.items()]


def _recorder_seconds(load: SharedLoad, stepped: Sequence[SteppedActuator]) -> float:
    """Return the time of one tick's 22 messages in the recorder, in s."""
    with tempfile.TemporaryDirectory() as directory:
        session = prepare(request_of(_DROP, Path(directory)))
        order, topics = topics_of(session.run, load)
        messages = order.merge(
            [*((*actuator.advance(None), *actuator.states()) for actuator in stepped),
             [load.clock(0)], load.messages(0)])
        ticks = count()
        with BagWriter(session.out, topics, provenance(session)) as bag:
            def work() -> None:
                for tick in islice(ticks, TICKS):
                    bag.write_tick(tick * session.run.step_ns, tick, messages)
            return seconds(work, TICKS)
