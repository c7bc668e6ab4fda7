"""A whole run that is measured, and what it told."""

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
    'actuators join', 'bag opened')
"""Parts of the start-up."""


@dataclass(frozen=True)
class Spec:
    """One run: what moves, in which way, for how many ticks of 1 ms."""

    plant: str
    """`LEG`, the leg's drop, or how many actuators on loads of their own."""
    way: str
    """`PROCESSES`, `ONE_PROCESS`, or a peer by name."""
    ticks: int
    rounds: int = ROUNDS

    def to_json(self) -> str:
        """Return what `from_json` reads."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> 'Spec':
        """Return the spec that `to_json` wrote."""
        return cls(**json.loads(text))

    def __str__(self) -> str:
        """Return a few words for progress and messages."""
        what = 'the leg' if self.plant == LEG else (
            f'{self.plant} actuator{"" if self.plant == "1" else "s"}')
        return f'{what}, {self.way}'


class Memory(NamedTuple):
    """Of one process, in bytes."""

    resident: int
    proportional: int
    """Shared pages divided by those who share them: adds up over processes."""


@dataclass(frozen=True)
class Measured:
    """What one run told; times in s."""

    ticks_per_s: float
    startup: Mapping[str, float]
    """By part in order; they add up to the time from the process's start to tick 0."""
    phases: Mapping[str, float]
    """Of a tick, by what the coordinator did."""
    processor: Mapping[str, float]
    """Processor time of a tick: `COORDINATOR`, and `ACTUATORS` together where they are apart."""
    memory: Sequence[Memory]
    """At the end, the coordinator's process first."""

    def to_json(self) -> str:
        """Return what `from_json` reads."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> 'Measured':
        """Return what `to_json` wrote."""
        tree = json.loads(text)
        return cls(**tree | {'memory': [Memory(*sizes) for sizes in tree['memory']]})

    @property
    def tick(self) -> float:
        """Return the time of a tick, s."""
        return 1.0 / self.ticks_per_s


@dataclass(frozen=True)
class Failed:
    """A run that ended before it could tell anything."""

    reason: str


def median_of(many: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Return the median of each part over several runs, in the order of the first."""
    return {part: median(each[part] for each in many if part in each) for part in many[0]}
