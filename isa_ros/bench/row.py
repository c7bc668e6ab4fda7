"""One measured number with its floor and its aim, and the timing of short pieces of work."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from statistics import median
import time

from isa_ros.core.frozen import frozen

REPEATS = 7


@frozen
class Aim:
    """A bound that a value should reach."""

    value: float
    is_most: bool = False
    """Whether it is an upper bound; otherwise a lower one."""

    def is_reached(self, value: float) -> bool:
        """Return whether a value is within the bound."""
        return value <= self.value if self.is_most else value >= self.value

    def __str__(self) -> str:
        """Return the bound as text."""
        return f'{"<=" if self.is_most else ">="} {self.value:g}'


@frozen
class Row:
    """One measurement; ``ratio`` to the floor is defined so that more is better."""

    name: str
    value: float | None
    """Median; None: not measured, with the reason in ``note``."""
    unit: str
    floor: str = ''
    ratio: float | None = None
    lowest: float | None = None
    highest: float | None = None
    aim: Aim | None = None
    note: str = ''
    part_of: str = ''
    """Name of the row that this one is a part of."""
    most_share: float | None = None
    """Largest ratio, of either sign, with which the other parts of the same row are accepted."""

    @classmethod
    def of(cls, name: str, values: Sequence[float], unit: str) -> 'Row':
        """Return the median of several measurements, with the lowest and the highest."""
        return cls(name, median(values), unit, lowest=min(values), highest=max(values))

    def against(self, floor: str, ratio: float) -> 'Row':
        """Return the row with the floor that it is compared with."""
        return replace(self, floor=floor, ratio=ratio)

    def aiming(self, aim: Aim) -> 'Row':
        """Return the row with its aim."""
        return replace(self, aim=aim)

    def noting(self, note: str) -> 'Row':
        """Return the row with a remark."""
        return replace(self, note=note)

    def under(self, whole: 'Row') -> 'Row':
        """Return the row as a part of another one."""
        return replace(self, part_of=whole.name)

    @property
    def number(self) -> float:
        """Return the value of a row that has one."""
        assert self.value is not None
        return self.value

    @property
    def is_reached(self) -> bool | None:
        """Return whether the aim is reached; None: no aim, or no measurement."""
        if self.aim is None or self.value is None:
            return None
        return self.aim.is_reached(self.value)


def seconds(work: Callable[[], object], per: int, of_cpu: bool = False) -> float:
    """
    Return the median time of one of the ``per`` pieces of ``work``, in s, after a warm-up.

    With ``of_cpu`` it is the processor time of this process instead of wall time.
    """
    clock = time.process_time if of_cpu else time.perf_counter
    work()
    times = []
    for _ in range(REPEATS):
        start = clock()
        work()
        times.append((clock() - start) / per)
    return median(times)
