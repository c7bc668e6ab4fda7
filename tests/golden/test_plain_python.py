"""Kernels as plain functions, `NUMBA_DISABLE_JIT=1`, as in a debugger: the same messages."""

from importlib import import_module
import os
from pathlib import Path
import pkgutil
import subprocess
import sys

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
PROGRAM = """
import json, sys
from isa_ros.config.paths import CONFIG, SCENARIOS, shipped
from isa_ros.config.runs.run_file import load_run
from isa_ros.run.warm_up import warmed_up
from isa_ros.scenario.scenario import load_scenario
from tests.golden import message_digests
message_digests.SECONDS = 0.02
run = load_run(shipped(CONFIG)[sys.argv[1]])
warmed_up(run)
print(json.dumps(message_digests.digests(load_scenario(shipped(SCENARIOS)[sys.argv[2]], run))))
"""


DIVERGING = """
import math
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.run_file import load_run
from isa_ros.errors import SimulationDiverged
from isa_ros.scenario.scenario import idle
from isa_ros.simulation import Simulation
simulation = Simulation(idle(load_run(find('rig_linear', CONFIG))))
simulation.step()
simulation.group.actuators[0].memory.continuous['plant']['chambers']['p_b'][0] = math.inf
try:
    simulation.step()
except SimulationDiverged as error:
    print(error)
"""


def printed(program: str, is_disabled: str, *arguments: str) -> bytes:
    """Return what a program prints, in a process of its own."""
    return subprocess.run(
        [sys.executable, '-W', 'ignore', '-c', program, *arguments], cwd=ROOT, check=True,
        timeout=600, env={**os.environ, 'NUMBA_DISABLE_JIT': is_disabled},
        stdout=subprocess.PIPE).stdout


def digests(config: str, scenario: str, is_disabled: str) -> bytes:
    """Return digests of 20 ticks."""
    return printed(PROGRAM, is_disabled, config, scenario)


@pytest.mark.slow
@pytest.mark.parametrize(('config', 'scenario'), [
    ('leg.yaml', 'drop.yaml'), ('crane_circuit.yaml', 'crane_circuit.yaml')])
def test_20_ticks_are_the_same_bytes(config, scenario):
    plain = digests(config, scenario, '1')
    assert plain.count(b'"') > 40    # of many topics
    assert plain == digests(config, scenario, '0')


@pytest.mark.slow
def test_a_run_that_diverges_ends_with_the_same_sentence():
    """All that a tick computes after the state has diverged takes a nan, and none raises."""
    plain = printed(DIVERGING, '1').decode()
    assert plain == (
        'ram: plant.chambers.p_a = nan at t = 0.002000 s, must be finite: the simulation '
        'diverged\n')
    assert plain == printed(DIVERGING, '0').decode()


def records() -> dict[str, np.dtype]:
    """Return all records that modules of the package declare, by name."""
    found = {}
    for package in ('actuator', 'core', 'loads', 'plant', 'reu', 'run', 'surroundings'):
        folder = import_module(f'isa_ros.{package}')
        for module in pkgutil.walk_packages(folder.__path__, f'{folder.__name__}.'):
            found.update({f'{module.name}.{name}': value
                          for name, value in vars(import_module(module.name)).items()
                          if isinstance(value, np.dtype) and value.names})
    return found


def test_no_field_is_hidden_by_a_method_of_numpy():
    """Plain Python takes the method: `record.dump` writes a file."""
    found = records()
    assert 'isa_ros.surroundings.supply_tick.IDEAL' in found and len(found) > 100
    hidden = set(dir(np.record))
    assert {name: sorted(hidden.intersection(own.names)) for name, own in found.items()
            if hidden.intersection(own.names)} == {}
