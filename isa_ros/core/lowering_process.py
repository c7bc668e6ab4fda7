"""A process that makes the bitcode of a `bitcode.BitcodeOrder`: from stdin to stdout."""

import os
import pickle
import sys

from isa_ros.core.kernel import symbols_of
from isa_ros.core.kernel_cache import environment
from isa_ros.core.large_kernels import leave_to_numba
from isa_ros.core.lowering import lower_long
from isa_ros.core.objects import bitcode_of
from isa_ros.core.parent import end_with_parent
from numba.core.event import Event, install_listener, Listener


class LinesOfKernels(Listener):
    """Writes the name of each kernel as it begins, and an empty line as it ends."""

    def __init__(self, file: int) -> None:
        self._file = file

    def on_start(self, event: Event) -> None:
        """Write its name."""
        os.write(self._file, f'{event.data["dispatcher"].__name__}\n'.encode())

    def on_end(self, event: Event) -> None:
        """Write a line without one."""
        os.write(self._file, b'\n')


def main() -> int:
    """Make the bitcode that is asked for; return the exit code."""
    end_with_parent()
    with os.fdopen(os.dup(1), 'wb') as out:
        os.dup2(2, 1)   # of what else may be printed
        leave_to_numba()    # what a module of a class runs while it is imported
        order = pickle.load(sys.stdin.buffer)
        if symbols_of(order.entries) != order.symbols:
            print('a source was edited meanwhile', file=sys.stderr)
            return 1
        if environment() != order.environment:
            print('its compiler is another one', file=sys.stderr)
            return 1
        lower_long()    # and run no kernel from now on
        with install_listener('numba:compile', LinesOfKernels(order.told)):
            pickle.dump(tuple(map(bitcode_of, order.entries)), out)
    return 0
