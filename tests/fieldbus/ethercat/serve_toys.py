"""
Serve toys on an interface; the program of a process that a test starts in a namespace.

A tick is 1 ms of simulated time. The program ends with the process that started it.
"""

import argparse
import os
import time

from isa_ros.fieldbus.ethercat.interface import open_interface
from isa_ros.fieldbus.ethercat.line import EthercatLine
from isa_ros.fieldbus.ethercat.ring import Ring
import numpy as np
from tests.fieldbus.toys import Toy

STEP_NS = 1_000_000
_NOTHING = np.zeros(1, np.dtype([('nothing', '<f8')]))[0]
_LONGEST_WAIT = 0.5


class LosingLine(EthercatLine):
    """A line on which every ``nth`` tick's answer is lost."""

    def __init__(self, ring: Ring, interface: str, nth: int) -> None:
        super().__init__(ring, open_interface(interface), interface)
        self._nth, self._sent = nth, 0

    def _send(self, size: int) -> None:
        if self.ring.is_complete:
            self._sent += 1
            if self._nth and self._sent % self._nth == 0:
                return
        super()._send(size)


def main() -> None:
    """Serve until the parent ends."""
    parser = argparse.ArgumentParser()
    parser.add_argument('interface')
    parser.add_argument('-n', type=int, default=1, help='number of toys')
    parser.add_argument('--filler', type=int, default=0, help='further double words mapped')
    parser.add_argument('--lose', type=int, default=0, help='lose the answer of each nth cycle')
    parser.add_argument('--wall', type=float, default=0.0, help='watchdog of wall time, s')
    parser.add_argument('--slow', type=float, default=0.0, help='wall time of a tick, s')
    options = parser.parse_args()
    toys = [Toy(f'toy {k}', 1 + k, options.filler) for k in range(options.n)]
    line = LosingLine(Ring(toys, STEP_NS), options.interface, options.lose)
    parent, tick = os.getppid(), 0
    print('serving', flush=True)
    line.update()
    while os.getppid() == parent:
        if line.serve(options.wall or _LONGEST_WAIT):
            tick += 1
            for toy in toys:
                toy.take_sample(_NOTHING, tick)
            if options.slow:
                time.sleep(options.slow)
            line.update()
        elif options.wall:
            line.miss()


if __name__ == '__main__':
    main()
