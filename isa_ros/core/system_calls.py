"""
The C library, called from kernels: messages on sockets, waits at memory, the time of the host.

The time only bounds how long a kernel keeps Python waiting; no result depends on it.
"""

import ctypes
import platform
import socket
import sys
import time
from typing import NamedTuple

from isa_ros.core.kernel import kernel
from isa_ros.core.pointers import call_c, load_at
from isa_ros.core.timebase import NS_PER_SECOND
import numpy as np

_FUNCTIONS = 'recv', 'send', 'clock_gettime', 'memcpy', 'syscall'
CALLS = np.dtype([(name, 'i8') for name in (*_FUNCTIONS, 'futex')])
"""Addresses of the functions, and the number of the call to wait at memory, below 0: none."""
_FUTEX = {('linux', 'x86_64'): 202, ('linux', 'aarch64'): 98}

SLICE_NS = 100_000_000
"""Longest wait at memory: Python runs signal handlers between two waits."""

MONOTONIC = getattr(time, 'CLOCK_MONOTONIC', 0)
AT_ONCE = getattr(socket, 'MSG_DONTWAIT', 0)
_NO_SIGNAL = getattr(socket, 'MSG_NOSIGNAL', 0)
_WAIT, _WAKE = 0, 1     # of the number at an address, in this process or another


class SystemCalls(NamedTuple):
    """What kernels need to call the C library."""

    calls: np.ndarray
    """`CALLS`, (1,)."""
    time: np.ndarray
    """Seconds and nanoseconds of the last reading, int64, (2,)."""
    time_at: np.ndarray
    """Address of ``time``, (1,)."""
    longest: np.ndarray
    """`SLICE_NS` in the same form, and its address, int64, (3,)."""


def _futex() -> int:
    return _FUTEX.get((sys.platform, platform.machine()), -1)


def can_wait() -> bool:
    """Return whether `wait_while` and `wake` are possible on this host."""
    return _futex() >= 0


def system_calls() -> SystemCalls:
    """Return the addresses in this process."""
    library = ctypes.CDLL(None)
    calls = np.zeros(1, CALLS)
    for name in _FUNCTIONS:
        calls[name] = ctypes.cast(getattr(library, name), ctypes.c_void_p).value
    calls['futex'] = _futex()
    reading, longest = np.zeros(2, np.int64), np.zeros(3, np.int64)
    longest[:] = *divmod(SLICE_NS, NS_PER_SECOND), longest.ctypes.data
    return SystemCalls(calls, reading, np.array([reading.ctypes.data]), longest)


@kernel
def receive(system, number, address, size, flags):
    """Return the bytes of the message that a socket has received into memory; < 0: none."""
    return call_c(system.calls[0].recv, number, address, size, flags, 0)


@kernel
def send(system, number, address, size, flags):
    """Send a message on a socket; return a number below 0 if that failed."""
    return call_c(system.calls[0].send, number, address, size, flags | _NO_SIGNAL, 0)


@kernel
def copy_memory(system, target, source, size):
    """Copy bytes from one address to another."""
    call_c(system.calls[0].memcpy, target, source, size, 0, 0)


@kernel
def monotonic_ns(system):
    """Return `time.monotonic_ns`."""
    call_c(system.calls[0].clock_gettime, MONOTONIC, system.time_at[0], 0, 0, 0)
    return system.time[0] * NS_PER_SECOND + system.time[1]


@kernel
def wait_while(system, address, seen):
    """
    Wait until the number of 4 bytes at an address is another than ``seen``.

    Return whether it is, after `SLICE_NS` at most.
    """
    until = monotonic_ns(system) + SLICE_NS
    while load_at(address) == seen:
        calls = system.calls[0]
        call_c(calls.syscall, calls.futex, address, _WAIT, seen, system.longest[2])
        if load_at(address) == seen and monotonic_ns(system) >= until:
            return False
    return True


@kernel
def wake(system, address, most):
    """Wake so many of those that wait at an address, in any process."""
    calls = system.calls[0]
    call_c(calls.syscall, calls.futex, address, _WAKE, most, 0)
