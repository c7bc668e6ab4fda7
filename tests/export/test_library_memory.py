"""Instances of a library are in memory of their caller: nothing outside is written or shared."""

import ctypes
from itertools import pairwise
import os
import sys
import threading

import numpy as np
import pytest
from tests.export.calls import NO_INSTANCE, port
from tests.export.libraries import Instance

pytestmark = pytest.mark.slow


def test_an_instance_needs_its_memory(loaded):
    size = loaded.size('size')
    memory = np.zeros(size + 64, np.uint8)
    begin = -memory.ctypes.data % 16

    def created(at, given):
        return loaded.call('create', memory[at:], ctypes.c_size_t(given),
                           result=ctypes.c_void_p)
    assert created(begin, size) == memory[begin:].ctypes.data
    assert created(begin, size - 1) is None and created(begin + 8, size) is None
    assert loaded.call('create', None, ctypes.c_size_t(size), result=ctypes.c_void_p) is None


def test_nothing_outside_its_memory_is_written(loaded):
    size = loaded.size('size')
    memory = np.full(size + 4096, 0x5a, np.uint8)
    begin = 1024 + -memory[1024:].ctypes.data % 16
    own = memory[begin:begin + size]
    loaded.call('create', own, ctypes.c_size_t(size), result=ctypes.c_void_p)
    for k in range(50):
        given = port(x0=0.05 + 1e-5 * k)
        assert loaded.call('tick', own, given, None, None) == 0
    assert (memory[:begin] == 0x5a).all() and (memory[begin + size:] == 0x5a).all()


def test_no_instance(loaded):
    assert loaded.call('tick', None, None, None, None) == NO_INSTANCE
    assert loaded.call('start', None, None) == NO_INSTANCE
    state = np.zeros(loaded.size('state_size'), np.uint8)
    size = ctypes.c_size_t(len(state))
    instance = Instance(loaded)
    for name in ('save', 'restore'):
        assert loaded.call(name, None, state, size) == NO_INSTANCE
        assert loaded.call(name, instance.memory, None, size) == NO_INSTANCE
    for name in ('sample', 'reply', 'fed', 'applied'):
        assert loaded.call(name, None, result=ctypes.c_void_p) is None
    assert loaded.call('time_ns', None, result=ctypes.c_int64) == 0
    assert np.isnan(loaded.call('load_position', None, result=ctypes.c_double))


def test_a_copy_and_memory_without_an_instance_are_none(loaded):
    """Each call that works on one says so, and changes neither the copy nor the instance."""
    instance, other = Instance(loaded), Instance(loaded)
    state = np.zeros(loaded.size('state_size'), np.uint8)
    size = ctypes.c_size_t(len(state))
    assert loaded.call('save', instance.memory, state, size) == 0
    other.memory[:] = instance.memory
    empty = np.zeros_like(instance.memory, shape=len(instance.memory) + 16)
    empty = empty[-empty.ctypes.data % 16:][:len(instance.memory)]
    before = bytes(instance.memory)
    for memory in (other.memory, empty):
        kept = bytes(memory)
        assert loaded.call('tick', memory, port(), None, None) == NO_INSTANCE
        assert loaded.call('start', memory, None) == NO_INSTANCE
        for name in ('save', 'restore'):
            assert loaded.call(name, memory, state, size) == NO_INSTANCE
        assert (bytes(memory), bytes(instance.memory)) == (kept, before)
    assert instance.tick(port()) == 0


def test_threads_with_instances_of_their_own(loaded):
    """As many as cores and one more, on one library: each as if it were alone."""
    def run(k, samples):
        instance = Instance(loaded)
        for tick in range(200):
            assert instance.tick(port(x0=0.05 + 1e-4 * k + 1e-6 * tick)) == 0
        samples[k] = instance.save().tobytes()
    n = 1 + (os.cpu_count() or 1)
    alone, together = [None] * n, [None] * n
    for k in range(n):
        run(k, alone)
    switch = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    try:
        threads = [threading.Thread(target=run, args=(k, together)) for k in range(n)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    finally:
        sys.setswitchinterval(switch)
    assert together == alone and all(one != other for one, other in pairwise(alone))
