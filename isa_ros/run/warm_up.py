"""Compile the kernels of a run, or load them from the cache, before it starts."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
import os
import subprocess
import sys

from isa_ros.actuator.actuator import SmartActuator
from isa_ros.actuator.ticking import tick_kernel
from isa_ros.bag.message_chunk import Chunk, Layouts
from isa_ros.config.assembly import bodies_in_form, group_of, surroundings_in_form
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.core.kernel import IS_COMPILED
from isa_ros.core.signals import LOAD_PORT, LOAD_REPLY
from isa_ros.errors import SimulationDiverged
from isa_ros.run.output import packer_of
from isa_ros.run.quiet_setpoints import QuietSetpoints
from isa_ros.scenario.scenario import idle
from isa_ros.simulation import Simulation
import numpy as np

_OTHER = [sys.executable, '-c', f'import {__name__} as w; w.compile_surroundings()']


def warmed_up(run: RunConfig) -> list[SmartActuator]:
    """
    Return a copy of every actuator, after one tick of a copy of the whole run.

    External bodies only have their form in it: each is made once, by the run itself. If the copy
    diverges, so will the run, which reports it and records the ticks before.
    """
    if IS_COMPILED and run.bodies and len(os.sched_getaffinity(0)) > 1 \
            and not tick_kernel().is_kept():
        _compile_by_two(run)
    simulation = Simulation(idle(run), (), bodies_in_form(run))
    with suppress(SimulationDiverged):
        simulation.step()
        simulation.loop.advance_quietly(2)
    packer = packer_of(run, simulation.loop.rows.published)
    chunk = Chunk(b'', Layouts(), np.empty(0, np.uint8))
    for t_ns in (0, run.step_ns):   # with and without messages that are rare
        packer.pack(t_ns, t_ns, {})
        chunk.add(t_ns, 0, packer.all_messages())
    layout = packer.quiet_layout(run.step_ns)
    packer.recording(np.zeros(2, np.int64), layout, chunk.room(layout, 1))
    QuietSetpoints(packer, ())
    return simulation.group.actuators


def _compile_by_two(run: RunConfig) -> None:
    """Compile the actuators here, and the body and supplies in a process that keeps them."""
    with _other_process(run.to_yaml()), suppress(SimulationDiverged):
        group_of(run).advance(np.zeros(len(run.actuators), LOAD_PORT))


@contextmanager
def _other_process(configuration: str) -> Iterator['subprocess.Popen[str]']:
    """Compile the surroundings meanwhile; what that process does not keep is compiled here."""
    with subprocess.Popen(_OTHER, stdin=subprocess.PIPE, text=True,
                          stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as other:
        try:
            assert other.stdin is not None
            with suppress(BrokenPipeError), other.stdin:
                other.stdin.write(configuration)
            yield other
        except BaseException:
            other.kill()
            raise


def compile_surroundings() -> None:
    """Compile body and supplies of the configuration on standard input, of actuators at rest."""
    run = run_of_text(sys.stdin.read())
    surroundings = surroundings_in_form(run)
    surroundings.starts()
    surroundings.ports(np.zeros(len(run.actuators), LOAD_PORT))
    with suppress(SimulationDiverged):
        surroundings.advance(np.zeros(len(run.actuators), LOAD_REPLY))
