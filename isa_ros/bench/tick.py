"""Parts of a tick of the leg in one process, recorded, without ROS, in time of the processor."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import count, islice
from pathlib import Path
import tempfile

from isa_ros.bag.packed import Packed
from isa_ros.bag.writer import BagWriter
from isa_ros.bench.parts import divided, in_turn, Work
from isa_ros.bench.recording import recording
from isa_ros.bench.row import Row
from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.run.output import packer_of
from isa_ros.run.packing import Packer
from isa_ros.run.provenance import provenance_of
from isa_ros.scenario.scenario import load_scenario, Scenario
from isa_ros.simulation import Simulation

BEGUN = 1000    # ticks, after which the leg stands
TICKS = 500
SHARE = 0.25
"""Of a tick, that its parts may leave: the loop itself, and caches that others have used."""
ACTUATORS = 'actuators'


def tick_parts() -> list[Row]:
    """Measure a whole tick and its parts, which do the same work one by one."""
    drop = leg_drop()
    whole, alone = Simulation(drop), Simulation(drop)
    packer = packer_of(drop.run, alone.loop.rows.published)
    with recording(whole), _recorder(drop, packer) as record:
        _stepped(whole, BEGUN)
        _stepped(alone, BEGUN)
        times = in_turn({
            'whole': Work(lambda: _stepped(whole, TICKS)), **works_of(alone),
            'messages': Work(packing(packer, drop.run.step_ns)), 'recorder': Work(record)}, TICKS)
    row = Row('a tick of the leg', 1e6 * times.pop('whole'), 'us')
    return [row, *divided(row, times, SHARE)]


def _stepped(simulation: Simulation, n_ticks: int) -> None:
    for _ in range(n_ticks):
        simulation.step()


def leg_drop() -> Scenario:
    """Return the shipped drop of the shipped leg."""
    return load_scenario(find('drop.yaml', SCENARIOS), load_run(find('leg.yaml', CONFIG)))


def works_of(simulation: Simulation) -> dict[str, Work]:
    """Return what a tick calls of actuators and surroundings, over the next `TICKS` ticks."""
    group, surroundings, rows = simulation.group, simulation.surroundings, simulation.loop.rows
    of_group, of_surroundings = group.snapshot(), surroundings.snapshot()
    given = [(rows.ports.copy(), rows.commands.copy(), rows.replies.copy())
             for _ in range(TICKS) if simulation.step()]

    def fill() -> None:
        for _ in range(TICKS):
            surroundings.ports(rows.ports)

    def advance_actuators() -> None:
        for port, commands, _ in given:
            group.advance(port, commands)

    def advance_surroundings() -> None:
        for _, _, replies in given:
            rows.replies[:] = replies   # kernels are bound to these rows
            surroundings.advance(rows.replies)
    return {'ports': Work(fill),
            ACTUATORS: Work(advance_actuators, lambda: group.restore(of_group)),
            'body and supply': Work(
                advance_surroundings, lambda: surroundings.restore(of_surroundings))}


def packing(packer: Packer, step_ns: int) -> Callable[[], None]:
    """
    Return what packs the messages of `TICKS` ticks, those of each second once a second.

    Ticks follow those before: at t = 0 all messages of each second are there.
    """
    ticks = count(2)

    def pack() -> None:
        for tick in islice(ticks, TICKS):
            packer.pack(tick * step_ns, (tick - 1) * step_ns, {})
            packer.all_messages()
    return pack


@contextmanager
def _recorder(drop: Scenario, packer: Packer) -> Iterator[Callable[[], None]]:
    """Yield what records the messages of `TICKS` ticks."""
    step_ns, ticks = drop.run.step_ns, count()
    packer.pack(NS_PER_SECOND // 2, NS_PER_SECOND // 2 - step_ns, {})
    packed = packer.all_messages()
    messages = Packed(packed.block.copy(), packed.layout)
    with tempfile.TemporaryDirectory(prefix='isa_bench_') as folder, BagWriter(
            Path(folder) / 'bag', packer.topics, provenance_of(drop)) as bag:
        def record() -> None:
            for tick in islice(ticks, TICKS):
                bag.write_tick(tick * step_ns, tick, messages)
        yield record
