"""Scenarios that are run, recorded, replayed and recorded again."""

from pathlib import Path

from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.replay.replay import Rerun
from isa_ros.scenario.scenario import Scenario
from isa_ros.scripting.result import Result, simulated
from isa_ros.simulation import Simulation


def result_of(scenario: Scenario) -> Result:
    assert scenario.n_ticks is not None
    return simulated(Simulation(scenario), scenario.n_ticks)


def content(bag: Path) -> bytes:
    path, = bag.glob('*.mcap')
    return path.read_bytes()


def replayed(bag: Path, out: Path) -> bytes:
    """Return the bytes of the bag that a replay records."""
    again = Rerun(Bag(bag))
    with BagWriter(out, again.topics, Bag(bag).provenance) as writer:
        again.simulate(writer)
    return content(out)
