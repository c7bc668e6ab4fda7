"""Simulations that record a bag, without ROS."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
import tempfile

from isa_ros.bag.writer import BagWriter
from isa_ros.run.outlets import Outlets
from isa_ros.run.output import packer_of, RunOutput
from isa_ros.run.provenance import provenance_of
from isa_ros.run.thinning import Thinning
from isa_ros.simulation import Simulation


@contextmanager
def recording(simulation: Simulation) -> Iterator[None]:
    """Let a simulation at t = 0 record what its ticks give."""
    loop, run = simulation.loop, simulation.scenario.run
    packer = packer_of(run, loop.rows.published)
    thinning = Thinning(run.record, packer.topics)
    with tempfile.TemporaryDirectory(prefix='isa_bench_') as folder, BagWriter(
            Path(folder) / 'bag', thinning.topics, provenance_of(simulation.scenario),
            storage=run.record.storage) as bag:
        loop.sinks = (RunOutput(packer, run.step_ns, thinning.recorder(bag), Outlets()),)
        loop.begin()
        yield
        loop.end()
        loop.sinks = ()
