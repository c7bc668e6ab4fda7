"""
Comparing a recorded run with another, tick by tick.

A `Comparer` takes messages as a `BagWriter` does, so that a replay streams its messages
straight into it; only some ticks are held in memory.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence

from isa_ros.bag.provenance import CONFIGURATION
from isa_ros.bag.reader import Bag, BagMessage, Tick
from isa_ros.config.runs.recording import RECORD, RecordConfig
from isa_ros.config.text.sections import Place
from isa_ros.config.text.yaml_text import parse
from isa_ros.errors import ConfigError
from isa_ros.replay.difference import ABSENT, BAG, FirstDifference, PRESENT, RunDifference, Value
from isa_ros.replay.tolerances import Tolerances
from isa_ros.replay.topic_comparison import TopicComparison
from isa_ros.run.diagnostics import PERIOD_NS
from msg_adapters import diagnostics

_BLOCK = 256    # ticks between two comparisons of the messages with unequal bytes


class Comparer:
    """
    Compares the ticks that come in with those of a bag, in order of time.

    ``topics`` are the names for the topic indices of `write_tick`; messages for which
    ``compares``, called with topic, tick and time, is false are ignored on both sides. Unless
    ``is_to_end``, nothing more is compared once `difference` is known.

    With ``tolerances`` the diagnostics are ignored: their numbers are texts.

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
            compares: Callable[[str, int, int], bool] = lambda topic, sequence, t_ns: True, *,
            is_exact: bool = False, is_to_end: bool = False) -> None:
        self._bag = expected
        self._names = list(topics)
        self._tolerances = tolerances or Tolerances()
        self._compares = compares if tolerances is None else (
            lambda topic, sequence, t_ns: topic != diagnostics.TOPIC[0]
            and compares(topic, sequence, t_ns))
        self._is_exact, self._is_to_end = is_exact, is_to_end
        self._expected = self._compared(expected.ticks())
        self._next = next(self._expected, None)
        self._topics: dict[str, TopicComparison] = {}
        self._ticks = self._messages = self._in_block = 0
        self._end_ns: int | None = None
        self.difference: FirstDifference | None = None
        """The first difference; known some ticks later, at the latest after `finish`."""

    def write_tick(
            self, t_ns: int, sequence: int, messages: Sequence[tuple[int, bytes]]) -> None:
        """Compare one tick's (topic index, CDR bytes); as `BagWriter.write_tick`."""
        if self.difference is not None and not self._is_to_end:
            return
        actual = sorted(
            ((name, data) for k, data in messages
             if self._compares(name := self._names[k], sequence, t_ns)), key=lambda pair: pair[0])
        if not actual:
            return
        while self._next is not None and self._next.t_ns < t_ns:
            self._miss_tick(self._next, 'log_time', self._next.t_ns, t_ns)
            self._next = next(self._expected, None)
        if self._next is None:
            self._miss_tick(Tick(t_ns, sequence, ()), 'tick', ABSENT, PRESENT)
        elif self._next.t_ns > t_ns:
            self._miss_tick(self._next, 'log_time', self._next.t_ns, t_ns)
        else:
            self._compare_tick(self._next, sequence, actual)
            self._next = next(self._expected, None)
        self._in_block += 1
        if self._in_block >= _BLOCK or (BAG in self._topics and self.difference is None):
            self._compare_block()

    def finish(self) -> RunDifference:
        """
        Return the report; ticks left over in the bag are a difference.

        Its topics have the order of their first differences, behind whole ticks.
        """
        while self._next is not None and (self.difference is None or self._is_to_end):
            self._miss_tick(self._next, 'tick', PRESENT, ABSENT)
            self._next = next(self._expected, None)
        self._compare_block()
        found = [own.difference for own in sorted(
            self._topics.values(), key=lambda own: (own.topic != BAG, _by_size(own)))]
        return RunDifference(self._ticks, self._messages, self._end_ns, self.difference,
                             [difference for difference in found if difference is not None])

    def note(self, difference: FirstDifference) -> None:
        """Add a difference that is not one of the messages' bytes."""
        self._topic(difference.topic).note(difference)

    def _compared(self, ticks: Iterator[Tick]) -> Iterator[Tick]:
        """Yield the ticks with the messages that are compared, without empty ticks."""
        for tick in ticks:
            messages = tuple(
                m for m in tick.messages if self._compares(m.topic, m.sequence, m.t_ns))
            if messages:
                yield tick._replace(messages=messages)

    def _topic(self, name: str) -> TopicComparison:
        if name not in self._topics:
            self._topics[name] = TopicComparison(
                self._bag, name, self._tolerances, self._is_exact)
        return self._topics[name]

    def _miss_tick(self, tick: Tick, field: str, expected: Value, actual: Value) -> None:
        self.note(FirstDifference(tick.sequence, tick.t_ns, BAG, field, expected, actual))

    def _compare_tick(
            self, tick: Tick, sequence: int, actual: Sequence[tuple[str, bytes]]) -> None:
        """Compare the messages of one instant, both sides sorted by topic."""
        i, j, expected = 0, 0, tick.messages
        while i < len(expected) or j < len(actual):
            if j == len(actual) or (i < len(expected) and expected[i].topic < actual[j][0]):
                self._miss_message(tick, expected[i].topic, PRESENT, ABSENT)
                i += 1
            elif i == len(expected) or actual[j][0] < expected[i].topic:
                self._miss_message(tick, actual[j][0], ABSENT, PRESENT)
                j += 1
            else:
                self._compare_messages(expected[i], sequence, actual[j][1])
                i, j = i + 1, j + 1
        self._ticks += 1
        self._messages += len(expected)
        self._end_ns = tick.t_ns

    def _miss_message(self, tick: Tick, topic: str, expected: str, actual: str) -> None:
        self.note(FirstDifference(tick.sequence, tick.t_ns, topic, 'message', expected, actual))

    def _compare_messages(self, message: BagMessage, sequence: int, data: bytes) -> None:
        if self._is_exact and message.sequence != sequence:
            self.note(FirstDifference(message.sequence, message.t_ns, message.topic, 'sequence',
                                      message.sequence, sequence))
        elif message.data != data:
            self._topic(message.topic).add(message, data)

    def _compare_block(self) -> None:
        """Compare the messages with unequal bytes, and find the first difference."""
        self._in_block = 0
        for topic in self._topics.values():
            topic.compare()
        differing = [topic for topic in self._topics.values() if topic.first is not None]
        order = _by_size if self._is_to_end else _by_name
        self.difference = min(differing, key=order).first if differing else None


def _by_name(topic: TopicComparison) -> tuple[bool, int, bool, str]:
    """
    Return the order of topics by first differences: their times, whole ticks first, then names.

    Diagnostics are last: they say in words what other topics have as numbers.
    """
    name, first = topic.topic, topic.first
    return name == diagnostics.TOPIC[0], first.t_ns if first else 0, name != BAG, name


def _by_size(topic: TopicComparison) -> tuple[bool, int, bool, float, str]:
    """Return the order in which of equal times the topic with the largest deviation is first."""
    is_told, t_ns, is_part, name = _by_name(topic)
    return is_told, t_ns, is_part, -topic.proportion, name


def retyped(expected: Bag, types: Mapping[str, str]) -> list[FirstDifference]:
    """Return the topics of a bag that have another type among ``types``, by name."""
    return [FirstDifference(0, expected.start_ns or 0, topic, 'type', type_name, types[topic])
            for topic, type_name in sorted(expected.types.items())
            if types.get(topic, type_name) != type_name]


def is_of_end(topic: str, t_ns: int, *ends_ns: int | None) -> bool:
    """Return whether a message is the diagnostics of the end of one run while another went on."""
    return (topic == diagnostics.TOPIC[0] and t_ns % PERIOD_NS != 0
            and t_ns in ends_ns and any(end_ns != t_ns for end_ns in ends_ns))


def compare_bags(
        expected: Bag, actual: Bag, tolerances: Tolerances | None = None) -> RunDifference:
    """
    Return the comparison of two bags to their end, for the messages both were to record.

    Raises
    ------
    BagError
        A bag is damaged, or a message does not match its type.

    """
    topics = sorted(actual.types)
    other = retyped(expected, actual.types)
    indices = {topic: k for k, topic in enumerate(topics)}
    records = [recorded_as(expected), recorded_as(actual)]
    periods = {topic: [record.period(topic) for record in records]
               for topic in {*expected.types, *actual.types}
               - {difference.topic for difference in other}}
    comparer = Comparer(
        expected, topics, tolerances,
        lambda topic, sequence, t_ns: topic in periods and all(
            period and sequence % period == 0 for period in periods[topic])
        and not is_of_end(topic, t_ns, expected.end_ns, actual.end_ns),
        is_to_end=True)
    for difference in other:
        comparer.note(difference)
    for tick in actual.ticks():
        comparer.write_tick(
            tick.t_ns, tick.sequence, [(indices[m.topic], m.data) for m in tick.messages])
    return comparer.finish()


def recorded_as(bag: Bag) -> RecordConfig:
    """
    Return a bag's configuration of recording; by default everything is recorded.

    So it is taken to be where the configuration is missing, or cannot be read here: then samples
    that one of two bags left out are differences.
    """
    if not bag.has_provenance:
        return RecordConfig()
    text = bag.provenance_records[0].get(CONFIGURATION, b'').decode('utf-8', 'replace')
    try:
        tree = parse(text, CONFIGURATION)
        record: RecordConfig = RECORD.read(tree.get('record', {}), Place(CONFIGURATION, 'record'))
    except ConfigError:
        return RecordConfig()
    return record
