"""Compile the kernels of a run, or load them from the cache, before it starts."""

from contextlib import suppress

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.bag.message_chunk import Chunk, Layouts
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.errors import SimulationDiverged
from isa_ros.run.narrator import packer_of
from isa_ros.scenario.scenario import idle
from isa_ros.simulation import Simulation
import numpy as np


def warmed_up(run: RunConfig) -> list[SmartActuator]:
    """
    Return a copy of every actuator, after one tick of a copy of the whole run.

    If the copy diverges, so will the run, which reports it and records the ticks before.
    """
    simulation = Simulation(idle(run))
    with suppress(SimulationDiverged):
        simulation.step()
    packer = packer_of(run, simulation.loop.rows.shown)
    chunk = Chunk(b'', Layouts(), np.empty(0, np.uint8))
    for t_ns in (0, run.step_ns):   # with and without messages that are rare
        packer.pack(t_ns, t_ns, {})
        chunk.add(t_ns, 0, packer.all_messages())
    return simulation.group.actuators
