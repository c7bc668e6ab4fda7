"""
Processes forked from this one, with everything imported and compiled.

A node in a new process spends a second of CPU on imports and on loading numba, which this
process has done already; that memory is shared until it is written to. A forked process has
only the thread that called fork, so a process with running threads of Python or of the
middleware is not forked. A process that has ever had a node must not be forked: Fast DDS leaves
state behind that the copy cannot use, and nodes of the copy are never discovered.
"""

from collections.abc import Callable
import contextlib
import ctypes
import gc
import os
from pathlib import Path
import signal
import subprocess
import sys
import threading
import time
from typing import NoReturn
import warnings

from isa_ros.processes.ending import DEFECT, end_of, STOPPING

_PR_SET_NAME = 15  # linux/prctl.h
_POLL_S = 0.01


def can_fork() -> bool:
    """
    Return whether a fork of this process would work.

    Threads of a middleware have names of their own, for example dds.ev.0 of Fast DDS. Worker
    threads of OpenBLAS and LTTng have the name of the process; a copy works without them.
    """
    return (sys.platform == 'linux' and threading.active_count() == 1
            and len(_thread_names()) == 1)


def _thread_names() -> set[str]:
    names = set()
    for task in Path('/proc/self/task').iterdir():
        # The thread has ended meanwhile, before its file is opened or before it is read.
        with contextlib.suppress(FileNotFoundError, ProcessLookupError):
            names.add((task / 'comm').read_text())
    return names


class Forked:
    """A forked copy of this process, with a part of the interface of `subprocess.Popen`."""

    def __init__(self, name: str, work: Callable[[], int]) -> None:
        """Fork a copy that runs ``work`` and exits with its result; ps shows ``name``."""
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        gc.freeze()  # a collection would write to the shared pages
        # A signal that arrives before the copy has set its handlers must not get lost in it.
        signal.pthread_sigmask(signal.SIG_BLOCK, STOPPING)
        try:
            with warnings.catch_warnings():
                # Python 3.12 also warns of the idle worker threads of OpenBLAS and LTTng.
                warnings.simplefilter('ignore', DeprecationWarning)
                self.pid = os.fork()
            if not self.pid:
                _run(name, work)
        finally:
            signal.pthread_sigmask(signal.SIG_UNBLOCK, STOPPING)
            gc.unfreeze()
        self.returncode: int | None = None

    def poll(self) -> int | None:
        """Return the exit code, negative for a signal; None while the process runs."""
        if self.returncode is None:
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                self.returncode = os.waitstatus_to_exitcode(status)
        return self.returncode

    def wait(self, timeout: float | None = None) -> int:
        """Wait for the end and return the exit code; raise `subprocess.TimeoutExpired`."""
        deadline = None if timeout is None else time.monotonic() + timeout
        while (code := self.poll()) is None:
            if deadline is not None and time.monotonic() > deadline:
                raise subprocess.TimeoutExpired(str(self.pid), timeout or 0.0)
            time.sleep(_POLL_S)
        return code

    def send_signal(self, number: int) -> None:
        """Send a signal, unless the process has ended."""
        if self.poll() is None:
            os.kill(self.pid, number)

    def terminate(self) -> None:
        """Send SIGTERM."""
        self.send_signal(signal.SIGTERM)

    def kill(self) -> None:
        """Send SIGKILL."""
        self.send_signal(signal.SIGKILL)


def _run(name: str, work: Callable[[], int]) -> NoReturn:
    """Do the work of a copy and exit, without returning to the code of the original."""
    code = DEFECT
    try:
        for number in STOPPING:
            signal.signal(number, signal.SIG_DFL)
        os.setsid()
        _let_go_of_files()
        ctypes.CDLL(None).prctl(_PR_SET_NAME, name.encode())
        signal.pthread_sigmask(signal.SIG_UNBLOCK, STOPPING)
        code = work()
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else DEFECT
    except BaseException as error:
        code = end_of(name, error)
    finally:
        for stream in (sys.stdout, sys.stderr):
            with contextlib.suppress(OSError):
                stream.flush()
        os._exit(code)


def _let_go_of_files() -> None:
    """Redirect every open file except the outputs to /dev/null; descriptors remain in use."""
    nothing = os.open(os.devnull, os.O_RDWR)
    for name in os.listdir('/proc/self/fd'):
        if int(name) not in (1, 2, nothing):
            with contextlib.suppress(OSError):  # the descriptor of the listed directory
                os.fstat(int(name))
                os.dup2(nothing, int(name))
    os.close(nothing)
