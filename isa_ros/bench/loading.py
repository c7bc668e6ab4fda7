"""
What one actuator's process loads, in a process that does nothing else.

`python -m ... STARTED WHAT`: STARTED is the monotonic clock of whoever started it, WHAT is
``floor`` or ``actuator``; what was measured goes to stdout.
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
_EVERY_NODE_NEEDS = ('numba', 'rclpy')


class Loading(NamedTuple):
    """Medians over several processes."""

    floor: float
    """s, until Python has imported what every node needs."""
    floor_bytes: float
    """Resident then."""
    imports: float
    """s, until an actuator's process has imported everything."""
    kernels: float
    """s, from there until its first tick, kernels from the cache."""


def main(arguments: Sequence[str]) -> None:
    """Load, and say how long it took and, for the floor, how much it is."""
    started, what = float(arguments[0]), arguments[1]
    if what == FLOOR:
        for name in _EVERY_NODE_NEEDS:
            import_module(name)
        imported = time.monotonic() - started
        from isa_ros.bench.host import memory_of
        print(json.dumps((imported, memory_of(os.getpid()).resident)))
        return
    from isa_ros.config.default_actuator import default_actuator, DEFAULT_TIMING
    from isa_ros.nodes.actuator import process as actuator_process  # noqa: F401
    from isa_ros.actuator.actuator import SmartActuator
    imported = time.monotonic()
    SmartActuator(default_actuator('isa_v5', 'isa_v5'), DEFAULT_TIMING).tick()
    print(json.dumps((imported - started, time.monotonic() - imported)))


def median_loading() -> Loading:
    """Return the medians over several processes of either kind, in turn."""
    return Loading(*(median(values) for values in zip(*(
        (*_said(FLOOR), *_said(ACTUATOR)) for _ in range(REPEATS)))))


def _said(what: str) -> tuple[float, float]:
    from isa_ros.bench.child import last_line, run_module
    from isa_ros.errors import RunError
    ended = run_module(f'{__package__}.loading', [what], TIMEOUT_S)
    if ended.returncode:
        raise RunError(f'a process that loads the {what}: {last_line(ended)}')
    first, second = json.loads(ended.stdout.splitlines()[-1])
    return first, second


if __name__ == '__main__':
    main(sys.argv[1:])
