"""Ctrl-C, SIGTERM and SIGHUP as a stop request that takes effect between two ticks."""

import ctypes
import os
import signal
import sys
from types import FrameType

from isa_ros.processes.ending import replaced_handlers

PARENT_VARIABLE = 'ISA_ROS_PARENT'
"""Environment variable with the process id of the bring-up, with which a child ends."""

PR_SET_PDEATHSIG = 1  # linux/prctl.h


class StopRequest:
    """Becomes true at the first signal that asks to end; a context manager, main thread only."""

    def __init__(self) -> None:
        self._is_set = False

    def __call__(self) -> bool:
        """Return whether a stop was requested."""
        return self._is_set

    def __enter__(self) -> 'StopRequest':
        self._before = replaced_handlers(self._on_signal)
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        self._is_set = True


def end_with_parent() -> None:
    """
    Have the kernel kill this process when the bring-up that started it ends.

    A bring-up that ends normally has ended its children before. SIGKILL is used because it ends
    a stopped process as well; all data worth saving are in the coordinator.

    Does nothing in a process that was not started by a bring-up, and outside Linux, where a
    child detects the end of the coordinator by its publisher.
    """
    parent = os.environ.pop(PARENT_VARIABLE, '')
    if not parent or sys.platform != 'linux':
        return
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != int(parent):  # the parent ended before the line above
        os.kill(os.getpid(), signal.SIGKILL)
