"""Specification of a measured run, and its measured values."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
import json
from statistics import median
from typing import NamedTuple

LEG = 'leg'
PROCESSES, ONE_PROCESS = 'processes', 'one process'
ROUNDS = 3
COORDINATOR, ACTUATORS = 'coordinator', 'actuators'
INTERPRETER, IMPORTS, PREPARED, JOINED, RECORDER = (
    'interpreter', 'imports of the command', 'nodes, kernels, processes started',
    'waiting for actuators to join', 'bag opened')
"""Parts of the start-up."""


@dataclass(frozen=True)
class Spec:
    """One run: plant, way of running, and number of ticks of 1 ms."""

    plant: str
    """`LEG`, the leg's drop, or the number of actuators with their own loads."""
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
        what = 'the leg' if self.plant == LEG else (
            f'{self.plant} actuator{"" if self.plant == "1" else "s"}')
        return f'{what}, {self.way}'


TWELVE = Spec('12', PROCESSES, 600, rounds=2)


class ProcessMemory(NamedTuple):
    """Memory of one process, bytes."""

    resident: int
    proportional: int
    """Shared pages are divided by the number of processes that share them."""


@dataclass(frozen=True)
class Measured:
    """Measured values of one run; times in s."""

    ticks_per_s: float
    startup: Mapping[str, float]
    """By part, in order; the sum is the time from the start of the process to tick 0."""
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


@dataclass(frozen=True)
class Failed:
    """A run that failed before its values were measured."""

    reason: str


def median_of(many: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Return the median of each part over several runs, in the order of the first."""
    return {part: median(each[part] for each in many if part in each) for part in many[0]}
