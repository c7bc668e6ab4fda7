"""A participant that does not start, or fails with an error of its own, is reported."""

from pathlib import Path
import re
import signal

import pytest
from tests.ros.faults import assert_replays, Fault
from tests.ros.started import actuator, bringup, coordinator, RIG, Started, wait_for

pytestmark = [pytest.mark.ros, pytest.mark.slow]
START_S = 3.0  # start of the coordinator's node, during which a signal is pending

BREAKS_AT_START = "sys.modules['isa_ros.nodes.actuator.process'].init_ros = None"
BY_PYTHON = """
from isa_ros.nodes.lockstep.steady_ticks import SteadyTicks
SteadyTicks.are_next = False
"""
BREAKS_AT_TICK = BY_PYTHON + """
from isa_ros.actuator import actuator
tick = actuator.SmartActuator.tick
def breaking(self, *port):
    if self.t_ns == 100_000_000:
        raise RuntimeError('an error of its own')
    tick(self, *port)
actuator.SmartActuator.tick = breaking
"""
DIVERGES_AT_TICK = BY_PYTHON + """
from isa_ros.actuator.actuator import SmartActuator
advance = SmartActuator.tick
def tick(self, port=None):
    if self.t_ns == 100_000_000:
        self.memory.continuous['plant']['chambers']['p_a'][0] = float('nan')
    advance(self, port)
SmartActuator.tick = tick
"""


@pytest.fixture
def break_actuators(monkeypatch, tmp_path):
    """Return a function that adds lines to the start of every copy of a bring-up."""
    def add(lines: str) -> None:
        indented = '\n'.join(f'    {line}' for line in lines.strip().splitlines())
        (tmp_path / 'sitecustomize.py').write_text(
            f'import os, sys\ndef break_it():\n{indented}\n'
            'os.register_at_fork(after_in_child=break_it)\n')
        monkeypatch.setenv('PYTHONPATH', str(tmp_path))
    return add


def wait_for_children(run: Started) -> None:
    """Wait until the processes of the actuators exist."""
    wait_for(lambda: run.children() or not run.is_running(), 'children')
    assert run.is_running(), run.errors


def last_line(run: Started) -> str:
    """Return the command's message, which follows the line of the broken node."""
    return run.errors.splitlines()[-1]


def test_an_actuator_that_does_not_start_is_named(domain, tmp_path, break_actuators):
    break_actuators(BREAKS_AT_START)
    bag = tmp_path / 'bag'
    with bringup(bag, config=RIG) as run:
        assert run.exit_code() == 3
    assert last_line(run).startswith('isa: rotor: its process ')
    assert last_line(run).endswith(' ended with exit code 70 before tick 0')
    assert not bag.exists()


def test_an_actuator_that_raises_is_named(domain, tmp_path, break_actuators):
    break_actuators(BREAKS_AT_TICK)
    bag = tmp_path / 'bag'
    with bringup(bag, config=RIG) as run:
        assert run.exit_code() == 3
    assert re.fullmatch(
        r'isa: rotor: refused tick 100: RuntimeError: an error of its own \(\w+\.py:\d+\)',
        last_line(run))
    assert assert_replays(bag) == 100


def test_an_actuator_that_diverges_is_named_with_state_and_time(
        domain, tmp_path, break_actuators):
    """A pressure is no number: no value that a run file may have leads there."""
    break_actuators(DIVERGES_AT_TICK)
    bag = tmp_path / 'bag'
    with bringup(bag, config=RIG) as run:
        assert run.exit_code() == 4
    assert assert_replays(bag) == 100
    lines = run.errors.splitlines()
    assert len(lines) == 1, lines
    line = lines[0]
    assert line.startswith('isa: rotor: plant.')
    assert line.endswith(' at t = 0.101000 s, must be finite: the simulation diverged')


@pytest.mark.parametrize('number', [signal.SIGTERM, signal.SIGINT])
def test_a_signal_before_tick_0_ends_the_run(domain, tmp_path, number):
    """One of two actuators is never started, so that the run waits."""
    bag, config = tmp_path / 'bag', with_another_actuator(tmp_path / 'two.yaml')
    with bringup(bag, '--elsewhere', 'other', config=config) as run:
        wait_for_children(run)
        fault = Fault(run, None)
        run.signal(number)
        ended = fault.ended(START_S)
    assert ended.exit_code == 130
    assert ended.line == 'isa: stopped before tick 0'
    assert not bag.exists()


def test_a_participant_that_was_never_started_is_named(observer, tmp_path):
    """One of two actuators is started."""
    config = with_another_actuator(tmp_path / 'two.yaml')
    bag = tmp_path / 'bag'
    with actuator(tmp_path / 'rotor.log', 'rotor', config_file=config, lockstep=True):
        wait_for(lambda: observer.count_publishers('/rotor/joint_states'), 'the actuator')
        with coordinator(tmp_path / 'coordinator.log', config_file=config, out=bag,
                         join_timeout_s=3.0) as run:
            assert run.exit_code() == 3
    assert run.errors == (
        'coordinator: other: no answer before tick 0 after 3 s; start it with lockstep:=true in '
        'this ROS_DOMAIN_ID and namespace, /\n')
    assert not bag.exists()


def with_another_actuator(path: Path) -> Path:
    """Return the rig's configuration with a second actuator."""
    lines = RIG.read_text().splitlines()
    line, = (line for line in lines if line.startswith('  rotor:'))
    path.write_text('\n'.join([*lines, line.replace('rotor:', 'other:')]))
    return path
