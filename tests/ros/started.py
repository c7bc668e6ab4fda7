"""Processes that a test starts, waits for with a deadline, and ends by their id."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
import ctypes
import os
from pathlib import Path
import signal
import subprocess
import sys
import threading
import time
from typing import TypeVar

import isa_ros
from isa_ros.core.parent import PR_SET_PDEATHSIG

ROOT = Path(isa_ros.__file__).parents[1]
LEG = ROOT / 'config' / 'leg.yaml'
RIG = ROOT / 'config' / 'rig_rotary.yaml'
DROP = ROOT / 'config' / 'scenarios' / 'drop.yaml'
DEADLINE_S = 120.0  # a first run compiles every kernel
LOOK_S = 0.005
_ENDED = FileNotFoundError, ProcessLookupError   # while its files in /proc are read

T = TypeVar('T')


def wait_for(condition: Callable[[], T], what: str = '') -> T:
    """Return the first true value of ``condition``; fail after `DEADLINE_S`."""
    deadline, never = time.monotonic() + DEADLINE_S, threading.Event()
    while not (value := condition()):
        assert time.monotonic() < deadline, f'{what or condition} did not happen'
        never.wait(LOOK_S)  # polling without a pause would take the core from the new process
    return value


def _end_with_this() -> None:
    """Have the kernel end a new process if the tests are killed."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


class Started:
    """
    One process under test; its standard error goes to a file.

    ``prefix`` is a command that becomes it, `Host.enter` of `tests.ros.hosts` for one.
    """

    def __init__(self, arguments: list[str], log: Path, prefix: Sequence[str] = ()) -> None:
        self._log = log
        path = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get('PYTHONPATH')])])
        environment = os.environ | {'PYTHONPATH': path}
        with log.open('w') as stderr:
            self._process = subprocess.Popen(
                [*prefix, sys.executable, '-m', *arguments], stderr=stderr,
                stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, env=environment,
                preexec_fn=_end_with_this)

    @property
    def errors(self) -> str:
        """Return its output on standard error."""
        return self._log.read_text()

    @property
    def pid(self) -> int:
        """Return its process id."""
        return self._process.pid

    def signal(self, number: int) -> None:
        """Send a signal."""
        self._process.send_signal(number)

    def is_running(self) -> bool:
        """Return whether it has not ended."""
        return self._process.poll() is None

    def exit_code(self) -> int:
        """Wait for its end and return the exit code."""
        return self.wait(DEADLINE_S)

    def wait(self, timeout_s: float) -> int:
        """Wait for its end and return the exit code, or raise subprocess.TimeoutExpired."""
        return self._process.wait(timeout_s)

    def has_ended_within(self, timeout_s: float) -> bool:
        """Wait at most that long for its end and return whether it has ended."""
        try:
            self.wait(timeout_s)
        except subprocess.TimeoutExpired:
            return False
        return True

    def children(self) -> dict[str, int]:
        """Return its children's process ids by node name."""
        found = {}
        text = Path(f'/proc/{self.pid}/task/{self.pid}/children').read_text()
        for pid in text.split():
            try:    # A process forked from its parent has the node's name itself.
                name = Path(f'/proc/{pid}/comm').read_text().strip()
                arguments = Path(f'/proc/{pid}/cmdline').read_text().split('\0')
            except _ENDED:
                continue
            for argument in arguments:
                if argument.startswith('__node:='):
                    name = argument.removeprefix('__node:=')
            found[name] = int(pid)
        return found

    def end(self) -> None:
        """End it unconditionally."""
        if self.is_running():
            self._process.kill()
        self._process.wait()


@contextmanager
def started(log: Path, *arguments: str, prefix: Sequence[str] = ()) -> Iterator[Started]:
    """Run ``python -m ARGUMENTS`` while the context lasts."""
    process = Started(list(arguments), log, prefix)
    try:
        yield process
    finally:
        process.end()


@contextmanager
def bringup(
        out: Path, *arguments: str, config: Path = LEG, log: Path | None = None,
        prefix: Sequence[str] = ()) -> Iterator[Started]:
    """Run ``isa bringup``; its standard error goes to ``log``, or beside the bag."""
    with started(log or out.with_suffix('.log'), 'isa_ros', 'bringup', str(config),
                 '--out', str(out), *arguments, prefix=prefix) as process:
        yield process


@contextmanager
def rig_until_stopped(bag: Path, *options: str) -> Iterator[Started]:
    """Run the rig in real time while the context lasts, then stop it by SIGTERM."""
    with bringup(bag, '--real-time-factor', '1', *options, config=RIG) as process:
        yield process
        process.signal(signal.SIGTERM)
        assert process.exit_code() == 130, process.errors


@contextmanager
def actuator(log: Path, name: str, **parameters: object) -> Iterator[Started]:
    """Run an actuator node."""
    arguments = ['--ros-args', '-r', f'__node:={name}']
    for key, value in parameters.items():
        arguments += ['-p', f'{key}:={_yaml(value)}']
    with started(log, 'isa_ros.programs.actuator', *arguments) as process:
        yield process


@contextmanager
def coordinator(log: Path, **parameters: object) -> Iterator[Started]:
    """Run a coordinator that starts no actuators."""
    arguments = ['--ros-args']
    for key, value in parameters.items():
        arguments += ['-p', f'{key}:={_yaml(value)}']
    with started(log, 'isa_ros.programs.coordinator', *arguments) as process:
        yield process


def without_compilation(errors: str) -> list[str]:
    """Return the lines of standard error without the report of a first run's compilation."""
    return [line for line in errors.splitlines() if ': compiling the simulation' not in line]


def is_alive(pid: int) -> bool:
    """Return whether a process runs; a zombie does not."""
    try:
        return ') Z ' not in Path(f'/proc/{pid}/stat').read_text()
    except _ENDED:
        return False


def _yaml(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
