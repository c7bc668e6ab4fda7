"""A process that makes the bitcode of a `kernels.BitcodeOrder`: from stdin to stdout."""

import os
import pickle
import sys

from isa_ros.core.kept_objects import symbols_of
from isa_ros.core.lowering import lower_long
from isa_ros.core.objects import bitcode_of
from isa_ros.processes.stopping import end_with_parent


def main() -> int:
    """Make the bitcode that is asked for; return the exit code."""
    end_with_parent()
    with os.fdopen(os.dup(1), 'wb') as out:
        os.dup2(2, 1)   # of what else may be printed
        order = pickle.load(sys.stdin.buffer)
        if symbols_of(order.entries) != order.symbols:
            print('a source was edited meanwhile', file=sys.stderr)
            return 1
        lower_long()    # and run no kernel from now on
        out.write(bitcode_of(order.entries))
    return 0


if __name__ == '__main__':
    sys.exit(main())
