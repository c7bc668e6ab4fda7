"""Simulations advanced by calls of quiet ticks."""

from collections.abc import Callable
from itertools import cycle
from pathlib import Path

from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.run.output import packer_of, RunOutput
from isa_ros.run.provenance import provenance_of
from isa_ros.scripting.run import load, Run
from isa_ros.simulation import Simulation
from isa_ros.tick.exchange import Rows, RowSink
from isa_ros.tick.trips import TripLog

PATTERNS = ((1,), (2,), (3,), (7,), (20,), (100,), (1, 50, 3, 9), (1_000_000,))
"""Ticks of successive calls."""


def advance(simulation: Simulation, n_ticks: int, pattern: tuple[int, ...]) -> int:
    """Advance to a tick by calls of quiet ticks, each with a single one behind; return these."""
    loop, single = simulation.loop, 0
    loop.begin()
    for most in cycle(pattern):
        loop.advance_quietly(min(n_ticks - 1, loop.ticks + most - 1))
        loop.advance()
        single += 1
        if loop.ticks == n_ticks:
            loop.finish()
            loop.end()
            return single
    raise AssertionError


def bag_of(directory: Path, run: Run, n_ticks: int, pattern: tuple[int, ...],
           act: Callable[[Simulation], object] = lambda simulation: None
           ) -> tuple[list[tuple[object, ...]], int]:
    """Return all messages of the bag of a run, and the number of single ticks."""
    simulation = run.simulation()
    act(simulation)
    config = simulation.scenario.run
    packer = packer_of(config, simulation.loop.rows.published)
    with BagWriter(directory, packer.topics, provenance_of(simulation.scenario)) as bag:
        simulation.loop.sinks = (
            RunOutput(packer, config.step_ns, bag),
            TripLog([(own.name, own.sheet.is_rotary) for own in config.actuators]))
        single = advance(simulation, n_ticks, pattern)
    return [(own.topic, own.sequence, own.t_ns, own.data)
            for own in Bag(directory).messages()], single


class Counting(RowSink):
    """Counts the ticks that it takes, and those that kernels took."""

    def __init__(self, n: int) -> None:
        self.n, self.taken, self.quiet = n, [], 0

    def quiet_ticks(self, tick: int) -> int:
        return self.n

    def take(self, tick: int, rows: Rows) -> None:
        self.taken.append(tick)

    def end_quiet(self, tick: int, n_ticks: int) -> None:
        self.quiet += n_ticks


def begun(run: Run) -> tuple[Simulation, Counting]:
    """Return a simulation at t = 0, and the sink of its rows."""
    simulation, sink = run.simulation(), Counting(1000)
    simulation.loop.sinks = (sink,)
    simulation.loop.begin()
    return simulation, sink


def counted(n: int, n_ticks: int = 60, **scenario: object) -> Counting:
    simulation = load('rig_linear', **scenario).simulation()
    sink = Counting(n)
    simulation.loop.sinks = (sink,)
    advance(simulation, n_ticks, (1_000_000,))
    return sink
