"""
Comparing a recorded run with another, tick by tick, down to the first differing field.

A `Comparer` takes messages as a `BagWriter` does, so that a replay streams its messages
straight into it; only one tick is held in memory.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest

from isa_ros.bag.provenance import CONFIGURATION
from isa_ros.bag.reader import Bag, BagMessage, Tick
from isa_ros.config.recording import read_record, RecordConfig
from isa_ros.config.sections import Place
from isa_ros.config.yaml_text import parse
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import BagError
from isa_ros.replay.tolerances import Tolerances
from msg_adapters.cdr import CdrError, encode, Message
from msg_adapters.cdr_reader import decode, flatten, message_class

ABSENT = 'absent'
PRESENT = 'present'

Value = str | int | float | bytes | bool


@dataclass(frozen=True)
class Difference:
    """First place where two runs differ."""

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


@dataclass(frozen=True)
class Report:
    """Extent of the comparison, and the first difference, None for equal runs."""

    ticks: int
    messages: int
    end_ns: int | None  # of the last tick compared
    difference: Difference | None

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


class Comparer:
    """
    Compares the ticks that come in with those of a bag, in its order.

    ``topics`` are the names for the topic indices of `write_tick`; messages for which
    ``compares``, called with topic and tick, is false are ignored on both sides. After the
    first difference nothing more is compared.

    ``is_exact`` also compares what is in no field: sequence numbers, padding, and bytes after the
    last field. Middlewares leave padding uninitialised, so it is for bags of this package only.

    Raises
    ------
    BagError
        The bag is damaged, or a message does not match its type.

    """

    def __init__(
            self, expected: Bag, topics: Sequence[str],
            tolerances: Tolerances | None = None,
            compares: Callable[[str, int], bool] = lambda topic, sequence: True,
            is_exact: bool = False) -> None:
        self._bag = expected
        self._types = expected.types
        self._topics = list(topics)
        self._tolerances = tolerances or Tolerances()
        self._compares = compares
        self._is_exact = is_exact
        self._expected = self._compared(expected.ticks())
        self._ticks = self._messages = 0
        self._end_ns: int | None = None
        self.difference: Difference | None = None

    def write_tick(
            self, t_ns: int, sequence: int, messages: Sequence[tuple[int, bytes]]) -> None:
        """Compare one tick's (topic index, CDR bytes); as `BagWriter.write_tick`."""
        if self.difference is not None:
            return
        produced = sorted(
            ((name, data) for k, data in messages
             if self._compares(name := self._topics[k], sequence)), key=lambda pair: pair[0])
        if not produced:
            return
        tick = next(self._expected, None)
        if tick is None:
            self.difference = Difference(sequence, t_ns, 'bag', 'tick', ABSENT, PRESENT)
        elif tick.t_ns != t_ns:
            self.difference = Difference(
                tick.sequence, tick.t_ns, 'bag', 'log_time', tick.t_ns, t_ns)
        else:
            self.difference = self._first_difference(tick, sequence, produced)
            self._ticks += 1
            self._messages += len(tick.messages)
            self._end_ns = t_ns

    def finish(self) -> Report:
        """Return the report; ticks left over in the bag are a difference."""
        if self.difference is None:
            tick = next(self._expected, None)
            if tick is not None:
                self.difference = Difference(
                    tick.sequence, tick.t_ns, 'bag', 'tick', PRESENT, ABSENT)
        return Report(self._ticks, self._messages, self._end_ns, self.difference)

    def _compared(self, ticks: Iterator[Tick]) -> Iterator[Tick]:
        """Yield the ticks with the messages that are compared, without empty ticks."""
        for tick in ticks:
            messages = tuple(m for m in tick.messages if self._compares(m.topic, m.sequence))
            if messages:
                yield tick._replace(messages=messages)

    def _first_difference(
            self, tick: Tick, sequence: int,
            produced: Sequence[tuple[str, bytes]]) -> Difference | None:
        for message, other in zip_longest(tick.messages, produced):
            if message is None or other is None or message.topic != other[0]:
                return _absence(tick, message, other)
            if self._is_exact and message.sequence != sequence:
                return Difference(
                    tick.sequence, tick.t_ns, message.topic, 'sequence', message.sequence,
                    sequence)
            if message.data != other[1]:
                difference = self._field_difference(tick, message, other[1])
                if difference is None and self._is_exact:
                    difference = self._byte_difference(tick, message, other[1])
                if difference is not None:
                    return difference
        return None

    def _field_difference(
            self, tick: Tick, message: BagMessage, data: bytes) -> Difference | None:
        cls = message_class(self._types[message.topic])
        try:
            there = decode(data, cls)
        except CdrError as error:
            raise BagError(
                f'{message.topic}, tick {tick.sequence}, compared with {self._bag.path}: '
                f'{error}') from error
        pairs = zip(flatten(self._decoded(message)), flatten(there))
        for (field, expected), (_, actual) in pairs:
            if not self._is_equal(message.topic, field, expected, actual):
                return Difference(
                    tick.sequence, tick.t_ns, message.topic, field, expected, actual)
        return None

    def _byte_difference(
            self, tick: Tick, message: BagMessage, data: bytes) -> Difference | None:
        """Return the first difference of bytes whose fields are equal or within tolerances."""
        if self._tolerances.covers(message.topic):
            data = encode(self._decoded(message))  # its fields, without other bytes
        if len(message.data) != len(data):
            return Difference(tick.sequence, tick.t_ns, message.topic, 'bytes',
                              len(message.data), len(data))
        for k, (expected, actual) in enumerate(zip(message.data, data)):
            if expected != actual:
                return Difference(
                    tick.sequence, tick.t_ns, message.topic, f'byte {k}', expected, actual)
        return None

    def _decoded(self, message: BagMessage) -> Message:
        try:
            return decode(message.data, message_class(self._types[message.topic]))
        except CdrError as error:
            raise BagError(f'{self._bag.place_of(message)}: {error}') from error

    def _is_equal(self, topic: str, field: str, expected: Value, actual: Value) -> bool:
        """Return whether two values of a field are equal; -0.0 and 0.0 differ."""
        if not (isinstance(expected, float) and isinstance(actual, float)):
            return expected == actual
        if repr(expected) == repr(actual):
            return True
        tolerance = self._tolerances.of(topic, field)
        return tolerance is not None and tolerance.admits(expected, actual)


def compare_bags(expected: Bag, actual: Bag, tolerances: Tolerances | None = None) -> Report:
    """
    Return the comparison of two bags, for the messages that both were configured to record.

    Raises
    ------
    BagError
        A bag is damaged, or a message does not match its type.

    """
    topics = sorted(actual.types)
    for topic in topics:
        type_name = expected.types.get(topic)
        if type_name not in (None, actual.types[topic]):
            return Report(0, 0, None, Difference(
                0, expected.start_ns or 0, topic, 'type', str(type_name), actual.types[topic]))
    indices = {topic: k for k, topic in enumerate(topics)}
    records = [recorded_as(expected), recorded_as(actual)]
    periods = {topic: [record.period(topic) for record in records]
               for topic in {*expected.types, *actual.types}}
    comparer = Comparer(expected, topics, tolerances, lambda topic, sequence: all(
        period and sequence % period == 0 for period in periods[topic]))
    for tick in actual.ticks():
        comparer.write_tick(
            tick.t_ns, tick.sequence, [(indices[m.topic], m.data) for m in tick.messages])
        if comparer.difference is not None:
            break
    return comparer.finish()


def recorded_as(bag: Bag) -> RecordConfig:
    """
    Return a bag's configuration of recording; by default everything is recorded.

    Raises
    ------
    ConfigError
        The configuration cannot be read.

    """
    if not bag.has_provenance:
        return RecordConfig()
    name = f'{bag.path.name}: {CONFIGURATION}'
    tree = parse(bag.provenance.configuration, name)
    return read_record(tree.get('record', {}), Place(name, 'record'))


def _absence(
        tick: Tick, message: BagMessage | None, other: tuple[str, bytes] | None) -> Difference:
    """Return the difference for a message that one side lacks, the first by topic."""
    if message is not None and (other is None or message.topic < other[0]):
        return Difference(tick.sequence, tick.t_ns, message.topic, 'message', PRESENT, ABSENT)
    topic = '' if other is None else other[0]
    return Difference(tick.sequence, tick.t_ns, topic, 'message', ABSENT, PRESENT)
