"""Specification of a measured run, and its measured values."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
import json
from statistics import median
from typing import NamedTuple

from isa_ros.core.frozen import frozen

LEG, QUADRUPED = 'leg', 'quadruped'
PROCESSES, ONE_PROCESS = 'processes', 'one process'
ROUNDS = 3
COORDINATOR, ACTUATORS = 'coordinator', 'actuators'
INTERPRETER, IMPORTS, PREPARED, JOINED, RECORDER = (
    'interpreter', 'imports of the command', 'nodes, kernels, processes started',
    'waiting for actuators to join', 'bag opened')
"""Parts of the start-up."""


@frozen
class Spec:
    """One run: plant, way of running, and number of ticks of 1 ms."""

    plant: str
    """`LEG`, its drop; `QUADRUPED`, its trot; or the number of actuators with own loads."""
    way: str
    """`PROCESSES`, `ONE_PROCESS`, or the name of a peer of `benchmarks`."""
    ticks: int
    rounds: int = ROUNDS

    @property
    def is_over_peer(self) -> bool:
        """Return whether a peer transmits the steps."""
        return self.way not in (PROCESSES, ONE_PROCESS)

    def to_json(self) -> str:
        """Return the spec as JSON."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> 'Spec':
        """Return the spec from JSON; inverse of `to_json`."""
        return cls(**json.loads(text))

    def __str__(self) -> str:
        """Return a short description for progress and messages."""
        what = f'the {self.plant}' if self.plant in (LEG, QUADRUPED) else (
            f'{self.plant} actuator{"" if self.plant == "1" else "s"}')
        return f'{what}, {self.way}'


TWELVE = Spec('12', PROCESSES, 600, rounds=2)


class ProcessMemory(NamedTuple):
    """Memory of one process, bytes."""

    resident: int
    proportional: int
    """Shared pages are divided by the number of processes that share them."""


@frozen
class Measured:
    """Measured values of one run; times in s."""

    ticks_per_s: float
    startup: Mapping[str, float]
    """By part, in order; together nearly `to_tick_0`."""
    to_tick_0: float
    """Time from the start of the process to tick 0."""
    phases: Mapping[str, float]
    """Time of a tick by phase of the coordinator."""
    processor: Mapping[str, float]
    """Processor time of a tick: `COORDINATOR`, and all `ACTUATORS` if in other processes."""
    memory: Sequence[ProcessMemory]
    """Memory of each process at the end, that of the coordinator first."""

    def to_json(self) -> str:
        """Return the values as JSON."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> 'Measured':
        """Return the values from JSON; inverse of `to_json`."""
        tree = json.loads(text)
        return cls(**tree | {'memory': [ProcessMemory(*sizes) for sizes in tree['memory']]})

    @property
    def tick(self) -> float:
        """Return the time of a tick, s."""
        return 1.0 / self.ticks_per_s


@frozen
class Failed:
    """A run that failed before its values were measured."""

    reason: str


def median_of(many: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Return the median of each part over several runs, in the order of the first."""
    return {part: median(each[part] for each in many if part in each) for part in many[0]}


def parts_of_median(
        wholes: Sequence[float], many: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """
    Return the parts of the run whose whole is the median, in the order of the first.

    Of an even number of runs it is the mean of the two in the middle, so that the parts add up as
    those of each run do; medians of each part do not.
    """
    by_whole = sorted(range(len(many)), key=lambda k: wholes[k])
    middle = [many[k] for k in by_whole[(len(many) - 1) // 2:len(many) // 2 + 1]]
    return {part: sum(each.get(part, 0.0) for each in middle) / len(middle) for part in many[0]}
