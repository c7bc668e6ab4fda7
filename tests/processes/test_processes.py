"""The process list of a run, and the end of its processes."""

from dataclasses import replace
import errno
import os
from pathlib import Path
import signal
import subprocess
import time

from isa_ros.config.runs.run_file import load_run
from isa_ros.errors import ConfigError, RunError
from isa_ros.processes import actuator_host, processes
from isa_ros.processes.processes import actuator_processes, Children, Process, run_processes
import pytest

CONFIG = Path(__file__).parents[2] / 'config' / 'leg.yaml'
DEADLINE_S = 30.0
SLEEPER = 'import signal; signal.pause()'


@pytest.fixture
def sleeper(monkeypatch, tmp_path):
    """Return the process of a module that waits for a signal."""
    (tmp_path / 'sleeper.py').write_text(SLEEPER)
    monkeypatch.setenv('PYTHONPATH', str(tmp_path))
    monkeypatch.setitem(processes.MODULES, 'sleeper', 'sleeper')
    return Process('haa', 'sleeper', ())


def wait_for(condition):
    """Return the first true value of ``condition``."""
    deadline = time.monotonic() + DEADLINE_S
    while not (value := condition()):
        assert time.monotonic() < deadline
    return value


def test_one_process_per_actuator():
    found = actuator_processes(load_run(CONFIG), CONFIG, None)
    assert [(p.name, p.executable) for p in found] == [
        ('haa', 'actuator'), ('hfe', 'actuator'), ('kfe', 'actuator')]
    assert found[0].parameters == (('lockstep', True), ('config_file', str(CONFIG)))


@pytest.mark.parametrize('elsewhere, here', [
    ((), ['haa', 'hfe', 'kfe']), (('hfe',), ['haa', 'kfe']), (('all',), []),
    (('kfe', 'haa', 'hfe'), [])])
def test_this_host_starts_what_no_other_does(elsewhere, here):
    run = load_run(CONFIG)
    found = actuator_processes(run, CONFIG, None, run.names_here(elsewhere))
    assert [process.name for process in found] == here


def test_arguments_are_yaml_that_keeps_its_type():
    """A path with blanks and a text that looks like a number stay strings."""
    process = Process('haa', 'actuator', (
        ('config_file', '/my files/1.5'), ('out', '7'), ('lockstep', True), ('duration', 2.0)))
    assert process.ros_arguments('left') == [
        '--ros-args', '-r', '__node:=haa', '-r', '__ns:=/left',
        '-p', 'config_file:="/my files/1.5"', '-p', 'out:="7"', '-p', 'lockstep:=true',
        '-p', 'duration:=2.0']


@pytest.mark.parametrize('namespace', ['lab', '/lab', '/lab/'])
def test_a_node_of_a_robot_is_in_its_namespace_below_that_of_the_run(namespace):
    process = Process('r1/haa', 'actuator', ())
    assert process.placed(namespace) == ('lab/r1', 'haa')
    assert process.ros_arguments(namespace) == [
        '--ros-args', '-r', '__node:=haa', '-r', '__ns:=/lab/r1']
    assert process.placed('') == ('r1', 'haa')


def test_all_processes_of_a_run_have_the_same_files():
    found = run_processes(load_run(CONFIG), CONFIG, Path('/drop.yaml'), {'duration': 2.0})
    assert [p.name for p in found] == ['haa', 'hfe', 'kfe', 'coordinator']
    files = (('config_file', str(CONFIG)), ('scenario_file', '/drop.yaml'))
    assert found[-1].parameters == (*files, ('duration', 2.0))
    assert all(p.parameters == (('lockstep', True), *files) for p in found[:-1])


def test_in_process_the_coordinator_is_alone():
    found = run_processes(load_run(CONFIG), CONFIG, None, {'in_process': True})
    assert [p.executable for p in found] == ['coordinator']
    assert found[0].parameters == (('config_file', str(CONFIG)), ('in_process', True))


def test_children_end_with_the_context(sleeper):
    with Children([sleeper]) as children:
        pid = children.pids['haa']
        assert children.lost() is None
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


def test_a_killed_child_is_named_with_its_signal(sleeper):
    with Children([sleeper]) as children:
        pid = children.pids['haa']
        os.kill(pid, signal.SIGKILL)
        lost = wait_for(children.lost)
    assert lost == f'haa: its process {pid} was ended by SIGKILL'


def test_a_child_that_does_not_end_is_killed(monkeypatch, tmp_path, sleeper):
    """SIGTERM is ignored; after the grace period the process has ended."""
    ready = tmp_path / 'ready'
    (tmp_path / 'sleeper.py').write_text(
        'import pathlib, signal\n'
        'signal.signal(signal.SIGTERM, signal.SIG_IGN)\n'
        f'pathlib.Path({str(ready)!r}).touch()\n'
        'while True:\n    signal.pause()\n')
    monkeypatch.setattr(processes, 'END_S', 0.1)
    with Children([sleeper]) as children:
        pid = children.pids['haa']
        wait_for(ready.exists)
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


def test_a_stopped_child_ends_by_itself(sleeper):
    """A signal does not reach a stopped process before it is continued."""
    with Children([sleeper]) as children:
        process = children._running['haa']
        os.kill(process.pid, signal.SIGSTOP)
        wait_for(lambda: ') T ' in Path(f'/proc/{process.pid}/stat').read_text())
    assert process.returncode == -signal.SIGTERM


def test_children_before_one_that_cannot_be_started_are_ended(monkeypatch, sleeper):
    started = []

    def start_one(*arguments, **options):
        if started:
            raise OSError(errno.EAGAIN, os.strerror(errno.EAGAIN))
        started.append(popen(*arguments, **options))
        return started[0]
    popen = subprocess.Popen
    monkeypatch.setattr(subprocess, 'Popen', start_one)
    with pytest.raises(RunError, match='kfe: cannot be started, Resource temporarily unavail'):
        with Children([sleeper, replace(sleeper, name='kfe')]):
            pytest.fail('it started')
    assert started[0].returncode == -signal.SIGTERM


def test_no_domain_is_refused_before_an_actuator_starts(monkeypatch):
    """Once: each of them would refuse it again, and the middleware in words of its own."""
    monkeypatch.setenv('ROS_DOMAIN_ID', '300')
    monkeypatch.setattr(actuator_host, 'Children', None)
    with pytest.raises(ConfigError, match="^ROS_DOMAIN_ID = '300', must be an integer from 0 to"):
        actuator_host.host_actuators(CONFIG, None, [])
