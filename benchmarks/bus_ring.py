"""Measured cycles of an EtherCAT ring, each in a network namespace of its own."""

from collections.abc import Sequence
from dataclasses import asdict
from functools import cache
import json
import os
from pathlib import Path
import shutil
import subprocess
import sys
import tempfile
from typing import NamedTuple

from isa_ros.bench.child import environment, last_line
from isa_ros.core.frozen import frozen
from isa_ros.fieldbus.request import FRAME, REAL_TIME

FLOOR = 'floor'
"""Slaves without a plant: frames, objects and process data only."""
WAYS = (FLOOR, FRAME, REAL_TIME)
SLAVE_END, MASTER_END = 'ecs', 'ecm'
"""The two ends of the pair of interfaces."""
NEW_NAMESPACE = (
    'unshare', '--user', '--map-root-user', '--net', 'sh', '-c',
    f'ip link add {SLAVE_END} type veth peer name {MASTER_END} && ip link set lo up && '
    f'ip link set {SLAVE_END} up && ip link set {MASTER_END} up && exec "$@"', 'sh')
"""Runs a command in a network namespace with a pair of interfaces, without root."""
_OWN_USERS = ('--user', '--map-root-user')
TIMEOUT_S = 300.0


@frozen
class MeasuredRing:
    """A ring to measure."""

    plant: str
    """As that of `Spec`."""
    way: str
    """One of `WAYS`."""
    cycles: int


class Cycles(NamedTuple):
    """Measured cycles, times in s."""

    per_s: float
    median: float
    """Round trip of a frame."""
    p99: float
    log: Sequence[str] = ()
    """Lines of the slaves about real time."""


@cache
def namespace() -> tuple[str, ...]:
    """
    Return what runs a command in such a namespace: `NEW_NAMESPACE`, for root without its users.

    The root of a namespace with users of its own may not use SCHED_FIFO.
    """
    of_root = tuple(word for word in NEW_NAMESPACE if word not in _OWN_USERS)
    if os.geteuid() != 0:
        return NEW_NAMESPACE
    ended = subprocess.run([*of_root, 'true'], stdin=subprocess.DEVNULL, capture_output=True)
    return NEW_NAMESPACE if ended.returncode else of_root


@cache
def missing() -> str:
    """Return why a ring cannot be measured here; '' if it can."""
    for program in ('unshare', 'ip'):
        if shutil.which(program) is None:
            return f'{program} is not installed'
    ended = subprocess.run(
        [*namespace(), sys.executable, '-c', 'import pysoem'], env=environment(),
        stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if ended.returncode:
        reason = last_line(ended)
        return f'{reason}: requirements-test.txt' if 'pysoem' in reason else reason
    return ''


def measured(ring: MeasuredRing) -> Cycles | str:
    """Measure a ring in a namespace; return its cycles, or why there are none."""
    with tempfile.TemporaryDirectory(prefix='isa_bench_') as directory:
        result = Path(directory) / 'cycles.json'
        ended = subprocess.run(
            [*namespace(), sys.executable, '-m', 'benchmarks.bus_master', '0',
             json.dumps(asdict(ring)), str(result)], env=environment(),
            stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=TIMEOUT_S)
        if ended.returncode:
            return last_line(ended)
        return Cycles(**json.loads(result.read_text(encoding='utf-8')))
