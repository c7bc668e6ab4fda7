"""
Comparing the messages of one topic: the first difference and the largest deviation.

Messages with unequal bytes are compared many at a time, by columns of their numbers; those
that differ in more than numbers one by one.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from isa_ros.replay.difference import Deviation, Difference, TopicDifference
from isa_ros.replay.tolerances import Tolerances
from msg_adapters.cdr import Message
from msg_adapters.cdr_reader import decode, flatten, message_class
from msg_adapters.columns import number_columns
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Pairs = dict[str, tuple[NDArray[Any], NDArray[Any]]]
"""Expected and actual values by field, (n,) each."""


class Moment(NamedTuple):
    """A tick and its time."""

    tick: int
    t_ns: int


@dataclass
class _Worst:
    """Largest deviation of a field, and the largest of its values where messages differ."""

    deviation: Deviation
    magnitude: float

    @property
    def proportion(self) -> float:
        return self.deviation.size / self.magnitude if self.magnitude else self.deviation.size


class TopicComparison:
    """
    Compares pairs of messages of one topic; floats by their tolerance, all else exactly.

    Without a tolerance -0.0 and 0.0 differ; a NaN equals every NaN.
    """

    def __init__(self, topic: str, type_name: str, tolerances: Tolerances) -> None:
        self.topic = topic
        self.first: Difference | None = None
        self._type_name = type_name
        self._tolerances = tolerances
        self._moments: list[Moment] = []
        self._expected: list[bytes] = []
        self._actual: list[bytes] = []
        self._worst: dict[str, _Worst] = {}
        self._n_messages = 0

    def add(self, moment: Moment, expected: bytes, actual: bytes) -> None:
        """Store two messages with unequal bytes for the next call of `compare`."""
        self._moments.append(moment)
        self._expected.append(expected)
        self._actual.append(actual)

    def note(self, difference: Difference) -> None:
        """Count a message that differs, or is absent on one side."""
        self._n_messages += 1
        if self.first is None or difference.t_ns < self.first.t_ns:
            self.first = difference

    def compare(self) -> None:
        """
        Compare the messages stored since the last call.

        Raises
        ------
        CdrError
            A message does not match its type.

        """
        if not self._moments:
            return
        moments, expected, actual = self._moments, self._expected, self._actual
        self._moments, self._expected, self._actual = [], [], []
        cls = message_class(self._type_name)
        numbers = number_columns([*expected, *actual], cls)
        if numbers is not None:
            n = len(moments)
            self._compare_columns(moments, {
                field: (numbers[field][:n], numbers[field][n:])
                for field in numbers.dtype.names or ()})
            return
        for moment, one, other in zip(moments, expected, actual):
            self._compare_columns([moment], _decoded(one, other, cls))

    @property
    def difference(self) -> TopicDifference | None:
        """Return the differences of the messages compared so far, None for equal ones."""
        if self.first is None:
            return None
        largest = max(self._worst.values(), key=lambda worst: worst.proportion, default=None)
        return TopicDifference(
            self.topic, self._n_messages, self.first,
            None if largest is None else largest.deviation)

    def _compare_columns(
            self, moments: Sequence[Moment], pairs: Pairs) -> None:
        """Compare the fields of messages, in wire order; every column is (n,)."""
        first_of: list[str | None] = [None] * len(moments)
        for field, (expected, actual) in pairs.items():
            differs = (self._differing_floats(moments, field, expected, actual)
                       if expected.dtype.kind == 'f' else expected != actual)
            for k in np.flatnonzero(differs).tolist():
                first_of[k] = first_of[k] or field
        for moment, place, k in zip(moments, first_of, range(len(moments))):
            if place is not None:
                expected, actual = (column[k:k + 1].tolist()[0] for column in pairs[place])
                self.note(Difference(*moment, self.topic, place, expected, actual))

    def _differing_floats(
            self, moments: Sequence[Moment], field: str, expected: NDArray[Any],
            actual: NDArray[Any]) -> NDArray[np.bool_]:
        """Return where two columns differ, and keep their largest deviation."""
        one, other = expected.astype(np.float64), actual.astype(np.float64)
        tolerance = self._tolerances.of(self.topic, field)
        with np.errstate(invalid='ignore', over='ignore'):
            distance = np.abs(other - one)
            differs = ~_is_same(one, other)
            if tolerance is not None:
                differs &= ~(distance <= tolerance.bound(one))
        if differs.any():
            distance[~np.isfinite(distance)] = np.inf
            k = int(np.argmax(np.where(differs, distance, -1.0)))
            self._keep(Deviation(
                *moments[k], field, float(one[k]), float(other[k]),
                None if tolerance is None else float(tolerance.bound(one)[k])),
                magnitude=_largest(one, other))
        return differs

    def _keep(self, deviation: Deviation, magnitude: float) -> None:
        known = self._worst.get(deviation.field)
        if known is None:
            self._worst[deviation.field] = _Worst(deviation, magnitude)
            return
        known.magnitude = max(known.magnitude, magnitude)
        if deviation.size > known.deviation.size:
            known.deviation = deviation


def _decoded(one: bytes, other: bytes, cls: type[Message]) -> Pairs:
    """Return the fields of two messages as columns of one row, up to an unequal non-float."""
    pairs: Pairs = {}
    for (field, expected), (_, actual) in zip(
            flatten(decode(one, cls)), flatten(decode(other, cls))):
        dtype = np.float64 if isinstance(expected, float) else object
        pairs[field] = np.array([expected], dtype), np.array([actual], dtype)
        if dtype is object and expected != actual:
            break  # after a length the fields of the two no longer correspond
    return pairs


def _is_same(one: Floats, other: Floats) -> NDArray[np.bool_]:
    """Return where two floats have the same text: signed zeros differ, all NaN are the same."""
    same: NDArray[np.bool_] = (
        (one == other) & (np.signbit(one) == np.signbit(other)) | np.isnan(one) & np.isnan(other))
    return same


def _largest(*columns_: Floats) -> float:
    """Return the largest finite magnitude."""
    return max((float(np.abs(column[np.isfinite(column)]).max(initial=0.0))
                for column in columns_))
