"""Processes that end with the one that started them."""

import ctypes
import os
import signal
import sys

PARENT_VARIABLE = 'ISA_ROS_PARENT'
"""Environment variable with the process id of the one with which a child ends."""

PR_SET_PDEATHSIG = 1  # linux/prctl.h


def end_with_parent() -> None:
    """
    Have the kernel of the system kill this process when the one that started it ends.

    A bring-up that ends normally has ended its children before. SIGKILL is used because it ends
    a stopped process as well; all data worth saving are in the coordinator.

    Does nothing in a process whose environment names no parent, and outside Linux, where a child
    detects the end of the coordinator by its publisher.
    """
    parent = os.environ.pop(PARENT_VARIABLE, '')
    if not parent or sys.platform != 'linux':
        return
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != int(parent):  # the parent ended before the line above
        os.kill(os.getpid(), signal.SIGKILL)
