"""
A run of `isa bus canopen` and the example's master: `python -m ... DIRECTORY STALLS`.

It must run in a network namespace of its own. DIRECTORY gets the bag and the EDS files.
"""

from collections.abc import Sequence
from contextlib import redirect_stdout
from itertools import count
from pathlib import Path
import subprocess
import sys
import time
from typing import Any

import canopen
from isa_ros.cli.main import main as isa
from isa_ros.examples import canopen_master
from tests.fieldbus.served import served, stalls

BUS = ('udp_multicast', '239.74.163.2')
ROUTE = ('ip', 'route', 'add', '239.0.0.0/8', 'dev', 'lo')
STEP_MS, LONGEST_STALL = 2, 0.3
NAMES = ('haa', 'hfe', 'kfe')


def main(arguments: Sequence[str]) -> None:
    """Run; the master's lines are in the file ``printed``."""
    directory = Path(arguments[0])
    subprocess.run(ROUTE, check=True)
    isa(['bus', 'describe', 'leg', '--eds', str(directory / 'leg.eds')])
    pauses = stalls(5, canopen_master.CYCLES, int(arguments[1]), LONGEST_STALL)
    transmit, cycles = canopen.sync.SyncProducer.transmit, count()

    def stalling(sync: Any) -> None:
        time.sleep(pauses.get(next(cycles), 0.0))
        transmit(sync)
    canopen.sync.SyncProducer.transmit = stalling  # type: ignore[method-assign]
    with served('canopen', 'leg', '--interface', BUS[0], '--channel', BUS[1], '--out',
                str(directory / 'bag'), '--set', f'step_ms={STEP_MS}', '--scenario',
                'sensor_lost'), (directory / 'printed').open('w') as printed:
        with redirect_stdout(printed):
            canopen_master.main([*BUS, *(str(directory / f'leg_{name}.eds') for name in NAMES)])


if __name__ == '__main__':
    main(sys.argv[1:])
