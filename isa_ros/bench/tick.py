"""Parts of a tick of the leg, without ROS."""

from collections.abc import Callable
from itertools import count, islice
from pathlib import Path
import tempfile

from isa_ros.bag.provenance import provenance_of
from isa_ros.bag.writer import BagWriter
from isa_ros.bench.rigs import request_of
from isa_ros.bench.row import Row, seconds
from isa_ros.bench.spec import LEG, ONE_PROCESS, Spec
from isa_ros.config.assembly import group_of, surroundings_of
from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.config.run_file import load_run
from isa_ros.controller import Controller, Setpoint, State
from isa_ros.core.signals import LOAD_PORT
from isa_ros.run.local_run import shown
from isa_ros.run.narrator import packer_of, topics_of
from isa_ros.run.session import prepare
from isa_ros.scenario.scenario import load_scenario, Scenario
from isa_ros.simulation import Simulation
import numpy as np

TICKS = 500
PLANT, MESSAGES = 'three actuators: plant + REU', 'messages of actuators, leg and supply'
_DROP = Spec(LEG, ONE_PROCESS, TICKS)


def tick_parts() -> list[Row]:
    """Measure the parts of the leg's tick, without ROS; the ratio is to the whole tick."""
    drop = _drop()
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


class _Holder(Controller):
    """Commands one actuator to hold its position, at every tick."""

    def step(self, state: State) -> dict[str, Setpoint]:
        return {'kfe': Setpoint(position=state.actuators['kfe'].position)}


def memory_rows() -> list[Row]:
    """Measure the leg's drop in memory, its kernels alone, and the time a controller adds."""
    drop = _drop()
    kernels = _kernel_seconds(drop)
    alone = _simulated(Simulation(drop))
    controlled = _simulated(Simulation(drop, [_Holder()]))
    return [
        Row('floor: the kernel of three actuators', kernels * 1e6, 'us', 'itself', 1.0),
        Row('leg in memory, a tick', alone * 1e6, 'us', 'that kernel', kernels / alone),
        Row('a controller in memory adds', (controlled - alone) * 1e6, 'us', 'that kernel',
            kernels / max(controlled - alone, 1e-9))]


def _simulated(simulation: Simulation) -> float:
    """Return the time per tick of the first `TICKS` ticks, in s."""
    def work() -> None:
        simulation.reset()
        for _ in range(TICKS):
            simulation.step()
    return seconds(work, TICKS, of_cpu=True)


def _kernel_seconds(drop: Scenario) -> float:
    """Return the time of the actuators' kernel alone, with the ports of the real ticks, in s."""
    simulation = Simulation(drop)
    ports: list[np.ndarray] = []
    take: Callable[[np.ndarray], None] = simulation.surroundings.ports
    for _ in range(TICKS):
        port = np.zeros(len(simulation.names), LOAD_PORT)
        take(port)
        ports.append(port)
        simulation.step()
    group, starts = group_of(drop.run), surroundings_of(drop.run).starts()

    def work() -> None:
        group.start(starts)
        for port in ports:
            group.advance(port)
    return seconds(work, TICKS, of_cpu=True)


def _drop() -> Scenario:
    return load_scenario(find('drop.yaml', SCENARIOS), load_run(find('leg.yaml', CONFIG)))


def actuator_parts() -> dict[str, float]:
    """Return the time of the leg's actuators and messages for a tick, in s."""
    simulation = Simulation(_drop())
    ports = np.zeros(len(simulation.names), LOAD_PORT)
    simulation.surroundings.ports(ports)
    packer = packer_of(simulation.scenario.run, shown(simulation))

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
    rows = shown(simulation)
    simulation.step()
    packer = packer_of(drop.run, rows)
    packer.pack(0, 0, {})
    messages = packer.all_messages()
    with tempfile.TemporaryDirectory() as directory:
        session = prepare(request_of(_DROP, Path(directory)))
        ticks = count()
        with BagWriter(
                session.out, topics_of(drop.run, rows), provenance_of(session.scenario)) as bag:
            def work() -> None:
                for tick in islice(ticks, TICKS):
                    bag.write_tick(tick * session.run.step_ns, tick, messages)
            return seconds(work, TICKS)
