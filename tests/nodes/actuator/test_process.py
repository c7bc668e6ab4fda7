"""What a process with one actuator loads."""

import json
import os
from pathlib import Path
import subprocess
import sys

import pytest
from tests.ros.domains import held_domain

ROOT = Path(__file__).parents[3]
OF_RUNS = (
    'isa_ros.config.assembly', 'isa_ros.config.robots', 'isa_ros.config.runs.body_kinds',
    'isa_ros.config.runs.run_config', 'isa_ros.nodes.lockstep', 'isa_ros.run.wire',
    'isa_ros.scenario', 'isa_ros.surroundings.bodies', 'isa_ros.surroundings.circuits',
    'isa_ros.surroundings.surroundings', 'isa_ros.surroundings.supply')
"""What a run may have beside an actuator."""
ALONE = """
import json, sys
from isa_ros.actuator.actuator import SmartActuator
from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.nodes.actuator import process
SmartActuator(default_actuator('isa_v5', 'isa_v5'), DEFAULT_TIMING)
print(json.dumps(sorted(sys.modules)))
"""
FORKING = """
import json, sys
from pathlib import Path
from isa_ros.config.paths import CONFIG, shipped
from isa_ros.nodes.bringup import bringup
from isa_ros.nodes.coordinator import runs
from isa_ros.run.options import Request
def start(*_):
    print(json.dumps(sorted(sys.modules)))
    sys.exit()
runs.Children = start
bringup(Request(config=shipped(CONFIG)['rig_linear.yaml'], out=Path('bag')))
"""
LOADING = 'import json, sys; import isa_ros.nodes.{}; print(json.dumps([*sys.modules]))'


def loaded(program: str, folder: Path = ROOT) -> set[str]:
    """Return the modules that a program loads in a process of its own."""
    return set(json.loads(subprocess.run(
        [sys.executable, '-c', program], cwd=folder, check=True, capture_output=True,
        text=True, env=os.environ | {'PYTHONPATH': str(ROOT)}).stdout))


def test_an_actuator_alone_loads_nothing_of_runs():
    modules = loaded(ALONE)
    assert {'rclpy.node', 'isa_ros.nodes.actuator.alone', 'isa_ros.actuator.kernel'} <= modules
    assert [name for name in modules for own in OF_RUNS
            if name == own or name.startswith(f'{own}.')] == []


@pytest.mark.parametrize(('module', 'expected'), [
    ('actuator.in_lockstep', {'isa_ros.nodes.lockstep.participant_end', 'isa_ros.run.wire.parts'}),
    ('actuator.of_run', {'isa_ros.config.runs.run_config', 'isa_ros.scenario.scenario'})])
def test_one_of_a_run_loads_that_too(module, expected):
    """Else the names above are no longer those of modules."""
    assert expected <= loaded(LOADING.format(module))


def test_what_forked_actuators_need_is_loaded_before():
    modules = loaded(LOADING.format('coordinator.runs'))
    assert {f'isa_ros.nodes.actuator.{name}' for name in ('in_lockstep', 'of_run')} <= modules


@pytest.mark.ros
def test_what_any_message_needs_is_loaded_before(monkeypatch, tmp_path):
    """A parser of message files, 50 ms of each process."""
    with held_domain(monkeypatch):
        assert 'rosidl_generator_py' in loaded(FORKING, tmp_path)
    assert 'rosidl_generator_py' not in loaded(LOADING.format('coordinator.runs'))


def test_the_public_name_of_nodes_is_loaded_where_it_is_used():
    from isa_ros import nodes
    from isa_ros.nodes.participant import Participant
    assert nodes.Participant is Participant
    with pytest.raises(AttributeError, match="'isa_ros.nodes' has no attribute 'Participants'"):
        nodes.Participants
