"""Exported actuators in this process: built, loaded, and called as C calls them."""

import ctypes

from isa_ros.core.objects import own_target
from isa_ros.core.signals import (
    COMMAND, LOAD_PORT, LOAD_REPLY, SAMPLE, START, SUPPLY_PORT, SUPPLY_REPLY)
from isa_ros.export.library import library
import numpy as np
from tests.kernels import make_exported

ALIGNED = 16
BEHIND = 56     # bytes of a saved state behind a snapshot of Python: digest, fed and checksum
_MIXER, _WORD = 0x9e3779b97f4a7c15, 2**64 - 1


def sealed(state):
    """Return a state with its own checksum in place of that in its last 8 bytes."""
    total = 0
    for word in state[:-8].view(np.uint64).tolist():
        total = (total ^ word) * _MIXER & _WORD
        total ^= total >> 32
    return np.append(state[:-8], np.array([total], np.uint64).view(np.uint8))


def written(own, directory, target=None):
    """Write the library of an actuator, for this processor, to a directory; return its path."""
    directory.mkdir(parents=True, exist_ok=True)
    target = target or own_target()
    make_exported(own, target)
    for name, content in library(own, target).items():
        (directory / name).write_bytes(content)
    return directory / f'lib{own.word}.so'


class Loaded:
    """The functions of a library, whose names begin with ``word``."""

    def __init__(self, path, word):
        self._library, self._word = ctypes.CDLL(str(path)), word

    def call(self, name, *arguments, result=ctypes.c_int):
        """Call a function; arrays are given by their address, None is NULL."""
        function = getattr(self._library, f'{self._word}_{name}')
        function.restype = result
        return function(*(ctypes.c_void_p(given.ctypes.data)
                          if isinstance(given, np.ndarray) else given for given in arguments))

    def size(self, name):
        """Return what a function of a size returns."""
        return self.call(name, result=ctypes.c_size_t)

    def message(self, code):
        """Return what a code means."""
        return self.call('message', code, result=ctypes.c_char_p).decode()


class Instance:
    """An instance in memory of its own."""

    def __init__(self, loaded):
        self.loaded, size = loaded, loaded.size('size')
        self._bytes = np.full(size + ALIGNED, 0xa5, np.uint8)
        begin = -self._bytes.ctypes.data % ALIGNED
        self.memory = self._bytes[begin:begin + size]
        assert loaded.call('create', self.memory, ctypes.c_size_t(size),
                           result=ctypes.c_void_p) == self.memory.ctypes.data

    def start(self, *numbers):
        """Start as given, or as it is created; return the code."""
        return self.loaded.call(
            'start', self.memory, np.array([numbers], START) if numbers else None)

    def tick(self, port=None, command=None, feed=None):
        """Advance by a tick with rows; return the code."""
        given = (None if row is None else np.array(row, kind).reshape(1)
                 for row, kind in ((port, LOAD_PORT), (feed, SUPPLY_PORT), (command, COMMAND)))
        return self.loaded.call('tick', self.memory, *given)

    def _row(self, name, dtype):
        address = self.loaded.call(name, self.memory, result=ctypes.c_void_p)
        text = ctypes.string_at(address, dtype.itemsize)
        return np.frombuffer(text, dtype)[0]

    @property
    def sample(self):
        """Return its `SAMPLE`."""
        return self._row('sample', SAMPLE)

    @property
    def reply(self):
        """Return its `LOAD_REPLY`."""
        return self._row('reply', LOAD_REPLY)

    @property
    def fed(self):
        """Return its `SUPPLY_REPLY`."""
        return self._row('fed', SUPPLY_REPLY)

    @property
    def applied(self):
        """Return the `COMMAND` that took effect in the last tick."""
        return self._row('applied', COMMAND)

    @property
    def t_ns(self):
        """Return its time."""
        return self.loaded.call('time_ns', self.memory, result=ctypes.c_int64)

    @property
    def load_position(self):
        """Return where its load is."""
        return self.loaded.call('load_position', self.memory, result=ctypes.c_double)

    def save(self):
        """Return its state."""
        state = np.zeros(self.loaded.size('state_size'), np.uint8)
        assert self.loaded.call('save', self.memory, state, ctypes.c_size_t(len(state))) == 0
        return state

    def restore(self, state):
        """Restore a state; return the code."""
        return self.loaded.call('restore', self.memory, state, ctypes.c_size_t(len(state)))
