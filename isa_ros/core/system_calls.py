"""
The C library, called from kernels: messages on sockets, and the time of the host.

The time only bounds how long a kernel keeps Python waiting; no result depends on it.
"""

import ctypes
import socket
import time
from typing import NamedTuple

from isa_ros.core.kernel import kernel
from isa_ros.core.pointers import call_c
from isa_ros.core.timebase import NS_PER_SECOND
import numpy as np

CALLS = np.dtype([('recv', 'i8'), ('send', 'i8'), ('clock_gettime', 'i8'), ('memcpy', 'i8')])
"""Addresses of the functions."""

MONOTONIC = getattr(time, 'CLOCK_MONOTONIC', 0)
AT_ONCE = getattr(socket, 'MSG_DONTWAIT', 0)
_NO_SIGNAL = getattr(socket, 'MSG_NOSIGNAL', 0)


class SystemCalls(NamedTuple):
    """What kernels need to call the C library."""

    calls: np.ndarray
    """`CALLS`, (1,)."""
    time: np.ndarray
    """Seconds and nanoseconds of the last reading, int64, (2,)."""
    time_at: np.ndarray
    """Address of ``time``, (1,)."""


def system_calls() -> SystemCalls:
    """Return the addresses in this process."""
    library = ctypes.CDLL(None)
    calls = np.zeros(1, CALLS)
    for name in CALLS.names or ():
        calls[name] = ctypes.cast(getattr(library, name), ctypes.c_void_p).value
    reading = np.zeros(2, np.int64)
    return SystemCalls(calls, reading, np.array([reading.ctypes.data]))


@kernel
def receive(system, number, address, size, flags):
    """Return the bytes of the message that a socket has received into memory; < 0: none."""
    return call_c(system.calls[0].recv, number, address, size, flags)


@kernel
def send(system, number, address, size, flags):
    """Send a message on a socket; return a number below 0 if that failed."""
    return call_c(system.calls[0].send, number, address, size, flags | _NO_SIGNAL)


@kernel
def copy_memory(system, target, source, size):
    """Copy bytes from one address to another."""
    call_c(system.calls[0].memcpy, target, source, size, 0)


@kernel
def monotonic_ns(system):
    """Return `time.monotonic_ns`."""
    call_c(system.calls[0].clock_gettime, MONOTONIC, system.time_at[0], 0, 0)
    return system.time[0] * NS_PER_SECOND + system.time[1]
