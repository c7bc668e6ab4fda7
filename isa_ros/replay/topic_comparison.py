"""
Comparing the messages of one topic: the first difference and the largest deviation.

Messages with unequal bytes are compared many at a time, by columns of their numbers; those
that differ in more than numbers one by one.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from isa_ros.bag.reader import Bag, BagMessage
from isa_ros.errors import BagError
from isa_ros.replay.diagnostic_fields import differing_values
from isa_ros.replay.difference import Deviation, FirstDifference, TopicDifference
from isa_ros.replay.tolerances import Tolerances
from msg_adapters.cdr import CdrError, encode, Message
from msg_adapters.cdr_reader import decode, flatten, message_class
from msg_adapters.template import number_columns
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Pairs = dict[str, tuple[NDArray[Any], NDArray[Any]]]
"""Expected and actual values by field, (n,) each."""


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
    Compares messages of a bag with others of their topic; floats by tolerance, all else exactly.

    Without a tolerance -0.0 and 0.0 differ; a NaN equals every NaN. ``is_exact`` also compares
    bytes that are in no field.
    """

    def __init__(
            self, bag: Bag, topic: str, tolerances: Tolerances, is_exact: bool = False) -> None:
        self.topic = topic
        self.first: FirstDifference | None = None
        self._bag = bag
        self._tolerances = tolerances
        self._is_exact = is_exact
        self._expected: list[BagMessage] = []
        self._actual: list[bytes] = []
        self._worst: dict[str, _Worst] = {}
        self._n_messages = 0

    def add(self, expected: BagMessage, actual: bytes) -> None:
        """Store two messages with unequal bytes for the next call of `compare`."""
        self._expected.append(expected)
        self._actual.append(actual)

    def note(self, difference: FirstDifference) -> None:
        """Count a message that differs, or is absent on one side."""
        self._n_messages += 1
        if self.first is None or difference.t_ns < self.first.t_ns:
            self.first = difference

    def compare(self) -> None:
        """
        Compare the messages stored since the last call.

        Raises
        ------
        BagError
            A message does not match its type; the error has its place in the bag.

        """
        if not self._expected:
            return
        messages, others = self._expected, self._actual
        self._expected, self._actual = [], []
        cls = message_class(self._bag.types[self.topic])
        try:
            numbers = number_columns([*(message.data for message in messages), *others], cls)
        except CdrError:
            numbers = None  # the message is decoded again below, with its place
        if numbers is not None:
            n, names = len(messages), numbers.dtype.names or ()
            # Only numbers differ, so a topic with tolerances has no other bytes to compare.
            self._compare_columns(
                messages, others,
                {field: (numbers[field][:n], numbers[field][n:]) for field in names},
                self._is_exact and not self._tolerances.covers(self.topic))
            return
        for message, other in zip(messages, others):
            self._compare_columns(
                [message], [other], _fields(self._decoded(message, cls),
                                            self._decoded_other(message, other, cls)),
                self._is_exact)

    @property
    def difference(self) -> TopicDifference | None:
        """Return the differences of the messages compared so far, None for equal ones."""
        if self.first is None:
            return None
        largest = max(self._worst.values(), key=lambda worst: worst.proportion, default=None)
        return TopicDifference(
            self.topic, self._n_messages, self.first,
            None if largest is None else largest.deviation)

    @property
    def proportion(self) -> float:
        """Return the largest deviation of a number in proportion to the values of its field."""
        return max((worst.proportion for worst in self._worst.values()), default=0.0)

    def _compare_columns(
            self, messages: Sequence[BagMessage], others: Sequence[bytes], pairs: Pairs,
            compares_bytes: bool) -> None:
        """Compare the fields of messages, in wire order; every column is (n,)."""
        first_of: list[str | None] = [None] * len(messages)
        for field, (expected, actual) in pairs.items():
            differs = (self._differing_floats(messages, field, expected, actual)
                       if expected.dtype.kind == 'f' else expected != actual)
            for k in np.flatnonzero(differs).tolist():
                first_of[k] = first_of[k] or field
        for k, (message, other) in enumerate(zip(messages, others)):
            place = first_of[k]
            if place is not None:
                values = [column[k:k + 1].tolist()[0] for column in pairs[place]]
                self._note(message, place, *values)
            elif compares_bytes:
                self._compare_bytes(message, other)

    def _differing_floats(
            self, messages: Sequence[BagMessage], field: str, expected: NDArray[Any],
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
                messages[k].sequence, messages[k].t_ns, field, float(one[k]), float(other[k]),
                None if tolerance is None else float(tolerance.bound(one)[k])),
                magnitude=_largest(one, other))
        return differs

    def _compare_bytes(self, message: BagMessage, data: bytes) -> None:
        """Find the first difference of bytes whose fields are equal or within tolerances."""
        if self._tolerances.covers(self.topic):
            cls = message_class(self._bag.types[self.topic])
            data = encode(self._decoded(message, cls))  # its fields, without other bytes
        if len(message.data) != len(data):
            self._note(message, 'bytes', len(message.data), len(data))
            return
        for k, (expected, actual) in enumerate(zip(message.data, data)):
            if expected != actual:
                self._note(message, f'byte {k}', expected, actual)
                return

    def _note(self, message: BagMessage, field: str, expected: Any, actual: Any) -> None:
        self.note(FirstDifference(
            message.sequence, message.t_ns, self.topic, field, expected, actual))

    def _keep(self, deviation: Deviation, magnitude: float) -> None:
        known = self._worst.get(deviation.field)
        if known is None:
            self._worst[deviation.field] = _Worst(deviation, magnitude)
            return
        known.magnitude = max(known.magnitude, magnitude)
        if deviation.size > known.deviation.size:
            known.deviation = deviation

    def _decoded(self, message: BagMessage, cls: type[Message]) -> Message:
        try:
            return decode(message.data, cls)
        except CdrError as error:
            raise BagError(f'{self._bag.place_of(message)}: {error}') from error

    def _decoded_other(
            self, message: BagMessage, other: bytes, cls: type[Message]) -> Message:
        try:
            return decode(other, cls)
        except CdrError as error:
            raise BagError(f'{self.topic}, tick {message.sequence}, compared with '
                           f'{self._bag.path}: {error}') from error


def _fields(one: Message, other: Message) -> Pairs:
    """
    Return the fields of two messages as columns of one row, up to an unequal non-float.

    Of diagnostics only what differs, by status and key, unless only their order does.
    """
    pairs: Pairs = {
        field: _column_pair(*values) for field, *values in differing_values(one, other)}
    if pairs:
        return pairs
    for (field, expected), (_, actual) in zip(flatten(one), flatten(other)):
        pairs[field] = _column_pair(expected, actual)
        if pairs[field][0].dtype == object and expected != actual:
            break  # after a length the fields of the two no longer correspond
    return pairs


def _column_pair(expected: Any, actual: Any) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return two values as columns of one row."""
    dtype = np.float64 if isinstance(expected, float) else object
    return np.array([expected], dtype), np.array([actual], dtype)


def _is_same(one: Floats, other: Floats) -> NDArray[np.bool_]:
    """Return where two floats have the same text: signed zeros differ, all NaN are the same."""
    same: NDArray[np.bool_] = (
        (one == other) & (np.signbit(one) == np.signbit(other)) | np.isnan(one) & np.isnan(other))
    return same


def _largest(*columns: Floats) -> float:
    """Return the largest finite magnitude."""
    return max(float(np.abs(column[np.isfinite(column)]).max(initial=0.0))
               for column in columns)
