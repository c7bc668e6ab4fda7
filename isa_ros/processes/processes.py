"""The processes of one run, as bring-up and launch files start them, and child processes."""

from collections.abc import Callable, Mapping, Sequence
import json
import os
from pathlib import Path
import signal
import subprocess
import sys
import time

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.text.names import parted, placed
from isa_ros.core.frozen import frozen
from isa_ros.core.parent import PARENT_VARIABLE
from isa_ros.errors import RunError
from isa_ros.processes.forked import can_fork, Forked
from isa_ros.run.options import all_changes, OPTION_OF

MODULES = {
    'actuator': 'isa_ros.programs.actuator',
    'coordinator': 'isa_ros.programs.coordinator',
}
"""Module of each executable."""

END_S = 3.0
"""Host time from SIGTERM to SIGKILL."""

_POLL_S = 0.01
_ROOT = Path(__file__).parents[2]

ParameterValue = bool | int | float | str | list[str] | tuple[str, ...]


@frozen
class Process:
    """One node in a process of its own."""

    name: str
    executable: str
    parameters: tuple[tuple[str, ParameterValue], ...]

    def placed(self, namespace: str) -> tuple[str, str]:
        """Return namespace and name of the node of a run in a namespace, without a slash at it."""
        return parted(placed(namespace.strip('/'), self.name))

    def ros_arguments(self, namespace: str = '') -> list[str]:
        """Return the arguments that set name, namespace and parameters."""
        above, name = self.placed(namespace)
        arguments = ['--ros-args', '-r', f'__node:={name}']
        if above:
            arguments += ['-r', f'__ns:=/{above}']
        for key, value in self.parameters:
            arguments += ['-p', f'{key}:={json.dumps(value)}']
        return arguments


def actuator_processes(
        run: RunConfig, config: Path, scenario: Path | None,
        names: Sequence[str] | None = None, changes: Sequence[str] = ()) -> tuple[Process, ...]:
    """
    Return the processes of the named actuators (None: all), in the order of the file.

    ``changes`` are those of a `Request`.
    """
    files: list[tuple[str, ParameterValue]] = [('config_file', str(config.resolve()))]
    if scenario is not None:
        files.append(('scenario_file', str(scenario.resolve())))
    if changes:
        files.append(('set', tuple(changes)))
    return tuple(
        Process(actuator.name, 'actuator', (('lockstep', True), *files))
        for actuator in run.actuators if names is None or actuator.name in names)


def run_processes(
        run: RunConfig, config: Path, scenario: Path | None,
        options: Mapping[str, ParameterValue],
        elsewhere: Sequence[str] = ()) -> tuple[Process, ...]:
    """
    Return every process of a run, the coordinator last.

    ``options`` are parameters of the coordinator; with ``in_process`` it is the only process. Its
    changes, seed and start time are also those of the actuators.
    ``elsewhere`` are the actuators that are started on another host.
    """
    files = [('config_file', str(config.resolve()))]
    if scenario is not None:
        files.append(('scenario_file', str(scenario.resolve())))
    coordinator = Process('coordinator', 'coordinator', (*files, *options.items()))
    if options.get('in_process'):
        return (coordinator,)
    names = run.names_here(elsewhere)
    return (*actuator_processes(run, config, scenario, names, _changes_in(options)), coordinator)


def _changes_in(options: Mapping[str, ParameterValue]) -> tuple[str, ...]:
    """Return the changes in parameters of the coordinator, as those of a `Request`."""
    request = {name: OPTION_OF[name].of_parameter(options[name])
               for name in ('set', 'seed', 'start_time') if name in options}
    return all_changes(
        request.get('set', ()), request.get('seed'), request.get('start_time'))


class Children:
    """
    Processes that end with this one; a context manager.

    ``work`` runs an executable with its arguments: if this process can be forked, processes
    are copies of it that call ``work``; otherwise, and with None, they are started anew.

    Raises
    ------
    RunError
        A process cannot be started; those already started are ended.

    """

    def __init__(
            self, processes: Sequence[Process], namespace: str = '',
            work: Callable[[Sequence[str]], int] | None = None) -> None:
        self._processes = processes
        self._namespace = namespace
        self._work = work
        self._running: dict[str, subprocess.Popen[bytes] | Forked] = {}

    def __enter__(self) -> 'Children':
        environment = os.environ | {
            PARENT_VARIABLE: str(os.getpid()),
            'PYTHONPATH': os.pathsep.join(
                [str(_ROOT), *filter(None, [os.environ.get('PYTHONPATH')])]),
        }
        for process in self._processes:
            try:
                self._running[process.name] = self._start(process, environment)
            except OSError as error:
                self.__exit__()
                raise RunError(
                    f'{process.name}: cannot be started, {error.strerror or error}') from error
        return self

    def _start(
            self, process: Process, environment: Mapping[str, str]
            ) -> subprocess.Popen[bytes] | Forked:
        arguments = [*process.ros_arguments(self._namespace),
                     '-p', 'start_type_description_service:=false']
        work = self._work
        if work is not None and can_fork():
            def copy() -> int:
                os.environ[PARENT_VARIABLE] = environment[PARENT_VARIABLE]
                return work([process.executable, *arguments])
            return Forked(process.name, copy)
        # A session of its own: Ctrl-C reaches the coordinator alone, which ends the tick.
        return subprocess.Popen(
            [sys.executable, '-m', MODULES[process.executable], *arguments],
            env=environment, stdin=subprocess.DEVNULL, start_new_session=True)

    def __exit__(self, *_: object) -> None:
        for process in self._running.values():
            process.terminate()
            process.send_signal(signal.SIGCONT)  # a stopped process cannot end
        deadline = time.monotonic() + END_S
        for process in self._running.values():
            try:
                process.wait(max(_POLL_S, deadline - time.monotonic()))
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    @property
    def pids(self) -> dict[str, int]:
        """Return the process ids by name."""
        return {name: process.pid for name, process in self._running.items()}

    def lost(self) -> str | None:
        """Return a message about the first child that has ended; None: all run."""
        for name, process in self._running.items():
            code = process.poll()
            if code is not None:
                how = (f'was ended by {signal.Signals(-code).name}' if code < 0
                       else f'ended with exit code {code}')
                return f'{name}: its process {process.pid} {how}'
        return None
