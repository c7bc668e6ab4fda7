"""Parts of a tick of the leg, without ROS."""

from itertools import count, islice
from pathlib import Path
import tempfile

from isa_ros.bag.writer import BagWriter
from isa_ros.bench.rigs import request_of
from isa_ros.bench.row import Row, seconds
from isa_ros.bench.spec import LEG, ONE_PROCESS, Spec
from isa_ros.config.assembly import group_of, surroundings_of
from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.signals import LOAD_PORT
from isa_ros.run.output import packer_of
from isa_ros.run.provenance import provenance_of
from isa_ros.run.session import prepare
from isa_ros.scenario.scenario import load_scenario, Scenario
from isa_ros.simulation import Simulation
import numpy as np

TICKS = 500
PLANT, MESSAGES = 'three actuators: plant + REU', 'messages of actuators, leg and supply'
_DROP = Spec(LEG, ONE_PROCESS, TICKS)


def tick_parts() -> list[Row]:
    """Measure the parts of the leg's tick, without ROS; the ratio is to the whole tick."""
    drop = leg_drop()
    parts = actuator_parts()
    surroundings = surroundings_of(drop.run)
    ports = np.zeros(len(drop.run.actuators), LOAD_PORT)
    replies = group_of(drop.run).replies
    replies['mean_forces'] = surroundings.starts()['force'][:, None]

    def leg() -> None:
        for _ in range(TICKS):
            surroundings.ports(ports)
            surroundings.advance(replies)
    parts['leg and supply'] = seconds(leg, TICKS)
    parts['recorder'] = _recorder_seconds(drop)
    whole = sum(parts.values())
    return [Row(f'tick of the leg: {name}', value * 1e6, 'us', 'sum of the parts', value / whole)
            for name, value in parts.items()]


def leg_drop() -> Scenario:
    """Return the shipped drop of the shipped leg."""
    return load_scenario(find('drop.yaml', SCENARIOS), load_run(find('leg.yaml', CONFIG)))


def actuator_parts() -> dict[str, float]:
    """Return the time of the leg's actuators and messages for a tick, in s."""
    simulation = Simulation(leg_drop())
    ports = np.zeros(len(simulation.names), LOAD_PORT)
    simulation.surroundings.ports(ports)
    packer = packer_of(simulation.scenario.run, simulation.loop.rows.published)

    def plants() -> None:
        for _ in range(TICKS):
            simulation.group.advance(ports)

    def messages() -> None:
        for tick in range(TICKS):
            packer.pack(tick, tick, {})
            packer.all_messages()
    return {PLANT: seconds(plants, TICKS), MESSAGES: seconds(messages, TICKS)}


def _recorder_seconds(drop: Scenario) -> float:
    """Return the time to record one tick's messages, in s."""
    simulation = Simulation(drop)
    rows = simulation.loop.rows.published
    simulation.step()
    packer = packer_of(drop.run, rows)
    packer.pack(0, 0, {})
    messages = packer.all_messages()
    with tempfile.TemporaryDirectory() as directory:
        session = prepare(request_of(_DROP, Path(directory)))
        ticks = count()
        with BagWriter(session.out, packer.topics, provenance_of(session.scenario)) as bag:
            def work() -> None:
                for tick in islice(ticks, TICKS):
                    bag.write_tick(tick * session.run.step_ns, tick, messages)
            return seconds(work, TICKS)
