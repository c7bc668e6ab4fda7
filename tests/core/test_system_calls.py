"""The C library called from kernels."""

import os
import socket
import subprocess
import sys
import time

from isa_ros.core.kernel import IS_COMPILED, kernel
from isa_ros.core.system_calls import (
    AT_ONCE, can_wait, copy_memory, monotonic_ns, receive, send, SLICE_NS, system_calls, wake)
import numpy as np
import pytest
from tests.run.sleeping import is_woken, LONG_S, sleep_at

pytestmark = pytest.mark.skipif(not IS_COMPILED, reason='they are machine code')


@kernel
def received(system, number, address, size, flags):
    return receive(system, number, address, size, flags)


@kernel
def sent(system, number, address, size, flags):
    return send(system, number, address, size, flags)


@kernel
def copied(system, target, source, size):
    copy_memory(system, target, source, size)


@kernel
def woken(system, address, most):
    wake(system, address, most)


@kernel
def now(system):
    return monotonic_ns(system)


def test_messages_go_and_come():
    first, second = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    system, memory = system_calls(), np.arange(8, dtype=np.uint8)
    number, address = first.fileno(), memory.ctypes.data
    assert received(system, number, address, 8, AT_ONCE) == -1
    second.send(b'abc')
    assert received(system, number, address + 2, 8, 0) == 3
    assert memory.tobytes() == b'\0\1abc\5\6\7'
    assert sent(system, number, address + 1, 4, 0) == 4
    assert second.recv(99) == b'\1abc'
    second.close()
    assert sent(system, number, address, 8, 0) == -1
    assert received(system, number, address, 8, 0) == 0
    first.close()
    assert received(system, number, address, 8, 0) == -1


def test_no_signal_ends_the_process():
    """Python ignores it, a program that calls the kernels may not."""
    code = ('import signal, socket\n'
            'from tests.core.test_system_calls import sent, system_calls\n'
            'signal.signal(signal.SIGPIPE, signal.SIG_DFL)\n'
            'first, second = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)\n'
            'second.close()\n'
            'system = system_calls()\n'
            'assert sent(system, first.fileno(), system.time_at[0], 8, 0) == -1\n')
    subprocess.run([sys.executable, '-c', code], check=True,
                   env=os.environ | {'PYTHONPATH': os.pathsep.join(sys.path)})


def test_a_full_queue_does_not_wait_at_once():
    first, second = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    system, memory = system_calls(), np.zeros(60_000, np.uint8)
    n = 0
    while sent(system, first.fileno(), memory.ctypes.data, memory.size, AT_ONCE) > 0:
        n += 1
    assert 0 < n < 1000
    first.close()
    second.close()


def test_the_time_is_that_of_python():
    system = system_calls()
    before = time.monotonic_ns()
    found = now(system)
    assert before <= found <= time.monotonic_ns()


def test_memory_is_copied():
    system, source, target = system_calls(), np.arange(9.0), np.zeros(9)
    copied(system, target.ctypes.data + 8, source.ctypes.data + 16, 24)
    assert target.tolist() == [0.0, 2.0, 3.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0]


@pytest.mark.skipif(not can_wait(), reason='the call is that of Linux')
def test_a_wait_at_memory_ends_where_the_number_is_another_one():
    """At once, or when it is woken; or else after a moment."""
    numbers = np.array([3, -5], np.int32)
    address = numbers[1:].ctypes.data
    found, spent_s = sleep_at(address, 3, LONG_S)
    assert found and spent_s < 0.5 * LONG_S
    found, spent_s = sleep_at(address, -5)
    assert not found and spent_s >= 1e-9 * SLICE_NS

    def change() -> None:
        numbers[1] = 7
        woken(system_calls(), address, 1)
    assert is_woken(address, -5, change)


@pytest.mark.skipif(not can_wait(), reason='the call is that of Linux')
def test_who_is_woken_for_nothing_waits_on():
    numbers = np.array([4], np.int32)
    address = numbers.ctypes.data

    def change_later() -> None:
        woken(system_calls(), address, 1)
        numbers[0] = 5
        woken(system_calls(), address, 1)
    assert is_woken(address, 4, change_later)
