"""Ctrl-C and SIGTERM as a request that is honoured between two ticks."""

import ctypes
import os
import signal
import sys
from types import FrameType

PARENT_VARIABLE = 'ISA_ROS_PARENT'
"""Process id of the bring-up that must not be outlived."""

PR_SET_PDEATHSIG = 1  # linux/prctl.h


class StopRequest:
    """Becomes true at the first SIGINT or SIGTERM; a context manager, main thread only."""

    def __init__(self) -> None:
        self._is_set = False

    def __call__(self) -> bool:
        """Return whether a stop was asked for."""
        return self._is_set

    def __enter__(self) -> 'StopRequest':
        self._before = {
            number: signal.signal(number, self._on_signal)
            for number in (signal.SIGINT, signal.SIGTERM)}
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        self._is_set = True


def end_with_parent() -> None:
    """
    Ask the kernel to kill this process when the bring-up that started it is gone.

    A bring-up that ends by itself has ended its children before. SIGKILL, as it ends a stopped
    process too: there is nothing to save that the coordinator does not have.

    Does nothing in a process that no bring-up started, and outside Linux, where the lost
    coordinator is noticed by its publisher.
    """
    parent = os.environ.pop(PARENT_VARIABLE, '')
    if not parent or sys.platform != 'linux':
        return
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != int(parent):  # it ended before the line above
        os.kill(os.getpid(), signal.SIGKILL)
