"""
Loading time of one actuator's process, measured in a process that does nothing else.

`python -m ... STARTED WHAT`: STARTED is the monotonic clock at the start of the process, WHAT is
``floor`` or ``actuator``; the measured values are written to stdout.
"""

from collections.abc import Sequence
from importlib import import_module
import json
import os
from statistics import median
import sys
import time
from typing import NamedTuple

REPEATS = 3
TIMEOUT_S = 120.0
FLOOR, ACTUATOR = 'floor', 'actuator'
_IMPORTS_OF_EVERY_NODE = ('numpy', 'rclpy.node')


class Loading(NamedTuple):
    """Medians over several processes."""

    floor: float
    """Time until Python has imported the packages of every node, s."""
    floor_bytes: float
    """Resident memory after that, bytes."""
    imports: float
    """Time until an actuator's process has finished its imports, s."""
    kernels: float
    """Time from there to its first tick, with kernels from the cache, s."""
    whole: float
    """Time from the start of the process to its first tick, s."""


def main(arguments: Sequence[str]) -> None:
    """Load and print the times; for the floor one time and the resident memory."""
    started, what = float(arguments[0]), arguments[1]
    if what == FLOOR:
        for name in _IMPORTS_OF_EVERY_NODE:
            import_module(name)
        imported = time.monotonic() - started
        from isa_ros.bench.host import memory_of
        print(json.dumps((imported, memory_of(os.getpid()).resident)))
        return
    from isa_ros.processes.ending import uncollected
    with uncollected():     # as its program
        from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
        from isa_ros.nodes.actuator import process as actuator_process  # noqa: F401
        from isa_ros.actuator.actuator import SmartActuator
    imported = time.monotonic()
    SmartActuator(default_actuator('isa_v5', 'isa_v5'), DEFAULT_TIMING).tick()
    ticked = time.monotonic()
    print(json.dumps((imported - started, ticked - imported, ticked - started)))


def median_loading() -> Loading:
    """Return the medians over several processes of both kinds, alternating."""
    return Loading(*(median(values) for values in zip(*(
        (*_measured(FLOOR), *_measured(ACTUATOR)) for _ in range(REPEATS)))))


def _measured(what: str) -> list[float]:
    from isa_ros.bench.child import last_line, run_module
    from isa_ros.errors import RunError
    ended = run_module(f'{__package__}.loading', [what], TIMEOUT_S)
    if ended.returncode:
        raise RunError(f'loading the {what} failed: {last_line(ended)}')
    found: list[float] = json.loads(ended.stdout.splitlines()[-1])
    return found


if __name__ == '__main__':
    main(sys.argv[1:])
