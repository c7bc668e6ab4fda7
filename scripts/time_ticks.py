"""
Processor time of actuators alone: a child process of `measure_parts_cost`.

    python scripts/time_ticks.py RUN_FILE MOTION N_TICKS

For each line of its input it advances all actuators of the run file by ``N_TICKS`` in one call of
their kernel and prints the time of a tick, us; at the end of the input the digest of all states.
The `isa_ros` that it imports may be that of an older commit: it uses what all of them have.
"""

from hashlib import sha256
import math
from pathlib import Path
import sys
import time

from isa_ros.config.assembly import group_of
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.signals import COMMAND, HAS_ENABLE, HAS_SETPOINT, LOAD_PORT
import numpy as np

WARM_UP = 100           # ticks, not timed
AMPLITUDE = 0.01        # m or rad, of a sine about the initial position
FREQUENCY = 2.0         # Hz
PRESSURE = 20.7e6       # Pa


class Timed:
    """The actuators of a run, without its bodies and supplies."""

    def __init__(self, run_file: Path, motion: str) -> None:
        self._group = group_of(load_run(run_file))
        self._centre = self._group.samples['position'].copy()
        self._motion, self._ticks, self._states = motion, 0, sha256()
        self._ports = np.zeros(len(self._centre), LOAD_PORT)
        self._ports['supply_pressure'] = PRESSURE

    def commands(self, n_ticks: int) -> np.ndarray:
        """Return `COMMAND` rows of the next ticks; none of actuators that are held."""
        rows = np.zeros((n_ticks, len(self._centre)), COMMAND)
        if self._motion == 'moving':
            turns = 2.0 * math.pi * FREQUENCY
            angles = turns * 1e-3 * (self._ticks + np.arange(n_ticks))[:, None]
            rows['kinds'] = HAS_SETPOINT
            rows['position'] = self._centre + AMPLITUDE * np.sin(angles)
            rows['velocity'] = AMPLITUDE * turns * np.cos(angles)
            rows['stiffness'] = rows['damping'] = math.nan
            if self._ticks == 0:
                rows[0]['kinds'] |= HAS_ENABLE
                rows[0]['is_enabled'] = 1
        return rows

    def advance(self, n_ticks: int) -> float:
        """Advance and return the processor time of a tick, s."""
        commands = self.commands(n_ticks)
        self._ticks += n_ticks
        begun = time.thread_time()
        log = self._group.advance_many(self._ports, commands, with_samples=False)
        spent = time.thread_time() - begun
        self._states.update(np.ascontiguousarray(log.states).tobytes())
        return spent / n_ticks

    @property
    def digest(self) -> str:
        """Return that of all states until now."""
        return self._states.hexdigest()


if __name__ == '__main__':
    timed = Timed(Path(sys.argv[1]), sys.argv[2])
    timed.advance(WARM_UP)
    for _ in sys.stdin:
        print(1e6 * timed.advance(int(sys.argv[3])), flush=True)
    print(timed.digest, flush=True)
