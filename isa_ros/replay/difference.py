"""Differences of two runs: the first one, those of each topic, and the verdict."""

from collections.abc import Sequence
import math
from typing import NamedTuple

from isa_ros.core.frozen import frozen
from isa_ros.core.timebase import NS_PER_SECOND

ABSENT = 'absent'
PRESENT = 'present'
BAG = 'bag'
"""Used as a topic for whole ticks."""

Value = str | int | float | bytes | bool


@frozen
class FirstDifference:
    """First place where two runs, or two topics, differ."""

    tick: int
    t_ns: int
    topic: str
    field: str
    expected: Value
    actual: Value

    def __str__(self) -> str:
        """Return the one line for the user; floats with every digit."""
        return (
            f'tick {self.tick} (t = {self.t_ns / NS_PER_SECOND:.6f} s), {self.topic}, '
            f'{self.field}: expected {self.expected!r}, got {self.actual!r}')


class Deviation(NamedTuple):
    """One value of a field that is not equal within its tolerance."""

    tick: int
    t_ns: int
    field: str
    expected: float
    actual: float
    allowed: float | None
    """The largest deviation that its tolerance admits; None: it has none."""

    @property
    def size(self) -> float:
        """Return the distance of the values; infinite where one of them is not finite."""
        distance = abs(self.actual - self.expected)
        return distance if math.isfinite(distance) else math.inf


class TopicDifference(NamedTuple):
    """The differences of one topic, or of whole ticks under the name `BAG`."""

    topic: str
    n_messages: int
    """Messages that differ, are absent, or are too many."""
    first: FirstDifference
    largest: Deviation | None
    """The largest deviation in proportion to the values of its field; None: no float differs."""


@frozen
class RunDifference:
    """Extent of the comparison, and the first difference, None for equal runs."""

    ticks: int
    messages: int
    end_ns: int | None  # of the last tick compared
    difference: FirstDifference | None
    topics: Sequence[TopicDifference] = ()
    """Every topic that differs, up to the end of the comparison."""

    @property
    def is_equal(self) -> bool:
        """Return whether the runs are equal within the tolerances."""
        return self.difference is None

    def __str__(self) -> str:
        """Return the one line for the user."""
        if self.difference is not None:
            return f'differ: {self.difference}'
        end = 'nothing to compare' if self.end_ns is None else (
            f'{self.ticks} ticks, {self.messages} messages, '
            f'up to t = {self.end_ns / NS_PER_SECOND:.6f} s')
        return f'equal: {end}'
