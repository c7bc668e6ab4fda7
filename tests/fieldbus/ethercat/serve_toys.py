"""
Serve toys on an interface; the program of a process that a test starts in a namespace.

Ticks of 1 ms simulated time are counted until the process is ended.
"""

import argparse

from isa_ros.fieldbus.ethercat import ethercat_line
import numpy as np
from tests.fieldbus.toys import Toy

_STEP_NS = 1_000_000
_NOTHING = np.zeros(1, np.dtype([('nothing', '<f8')]))[0]


def main() -> None:
    """Serve until the process is ended."""
    parser = argparse.ArgumentParser()
    parser.add_argument('interface')
    parser.add_argument('-n', type=int, default=1, help='number of toys')
    parser.add_argument('--filler', type=int, default=0, help='further double words mapped')
    options = parser.parse_args()
    toys = [Toy(f'toy {k}', 1 + k, options.filler) for k in range(options.n)]
    line = ethercat_line(toys, options.interface, _STEP_NS)
    print('serving', flush=True)
    tick = 0
    while True:
        line.update()
        while not line.serve(1.0):
            pass
        tick += 1
        for toy in toys:
            toy.take_sample(_NOTHING, tick)


if __name__ == '__main__':
    main()
