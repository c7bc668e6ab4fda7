"""The comparison of two runs: first their configurations, then their messages topic by topic."""

from collections.abc import Sequence
import math
from pathlib import Path
from typing import Any, NamedTuple

from isa_ros.bag.reader import Bag
from isa_ros.config.differences import DifferingKey
from isa_ros.errors import ConfigError
from isa_ros.replay.compare import compare_bags, recorded_as
from isa_ros.replay.difference import RunDifference, TopicDifference
from isa_ros.replay.provenance_differences import provenance_differences, records_of_bag
from isa_ros.replay.tolerances import Tolerances
from isa_ros.text.table import aligned, Cells

THINNED = 'recorded with different record options: comparing the samples in both'


class Comparison(NamedTuple):
    """Differing keys of the provenance, and the comparison of the messages."""

    keys: Sequence[DifferingKey] | None
    """None: neither run has a provenance, or one has a configuration that cannot be read."""
    report: RunDifference
    is_thinned: bool = False
    """Whether the bags were to record different samples; only those of both are compared."""
    problem: str = ''
    """The reason why a configuration cannot be read."""

    def lines(self, expected: str, actual: str) -> list[str]:
        """Return the text for the user; ``expected`` and ``actual`` are the runs' names."""
        lines = [self.key_remark, *aligned(self.key_rows(expected, actual))]
        if self.is_thinned:
            lines.append(THINNED)
        return [*lines, str(self.report), *aligned(self.topic_rows(expected, actual))]

    @property
    def key_remark(self) -> str:
        """Return what is above the differing keys, or why there are none."""
        if self.problem:
            return f'{self.problem}; comparing the messages only'
        return remark_on(self.keys)

    def key_rows(self, expected: str, actual: str) -> list[Cells]:
        """Return the rows of a table of differing keys, the header first; empty without any."""
        return rows_of(self.keys, expected, actual)

    def topic_rows(self, expected: str, actual: str) -> list[Cells]:
        """Return the rows of a table of differing topics, the header first; empty without any."""
        if not self.report.topics:
            return []
        return [('topic', 'messages', 'from tick', 'largest deviation', 'tick', expected, actual,
                 'deviation', 'allowed'), *map(_cells, self.report.topics)]

    def tree(self) -> dict[str, Any]:
        """Return everything for JSON; an absent key is null."""
        return {
            'is_equal': self.report.is_equal, 'problem': self.problem or None,
            'ticks': self.report.ticks, 'messages': self.report.messages,
            'end_ns': self.report.end_ns,
            'keys': [_json(key._asdict()) for key in self.keys or ()],
            'topics': [_json(_tree(topic)) for topic in self.report.topics]}


def names_of_runs(expected: Path, actual: Path) -> tuple[str, str]:
    """Return how two bags are called in tables: as they are given, unless that is one name."""
    names = str(expected), str(actual)
    return names if names[0] != names[1] else ('expected', 'actual')


def key_lines(
        keys: Sequence[DifferingKey] | None, expected: str, actual: str) -> list[str]:
    """Return the differing keys as text; ``expected`` and ``actual`` are the runs' names."""
    return [remark_on(keys), *aligned(rows_of(keys, expected, actual))]


def remark_on(keys: Sequence[DifferingKey] | None) -> str:
    """Return what is above the table of differing keys, or why there is none."""
    if keys is None:
        return 'both without configuration: comparing the messages only'
    if not keys:
        return 'configuration, scenario and versions are equal'
    return 'configuration, scenario or versions differ:'


def rows_of(
        keys: Sequence[DifferingKey] | None, expected: str, actual: str) -> list[Cells]:
    """Return the rows of a table of differing keys, the header first; empty without any."""
    return [('key', expected, actual, 'unit'), *(key.cells for key in keys)] if keys else []


def compared(expected: Bag, actual: Bag, tolerances: Tolerances | None = None) -> Comparison:
    """
    Return the comparison of two bags; their messages need no configuration.

    Raises
    ------
    BagError
        A bag is damaged, or a message does not match its type.

    """
    keys, problem = None, ''
    try:
        keys = provenance_differences(records_of_bag(expected), records_of_bag(actual))
    except ConfigError as error:
        problem = str(error)
    return Comparison(
        keys, compare_bags(expected, actual, tolerances),
        not recorded_as(expected).thins_like(recorded_as(actual)), problem)


def _cells(topic: TopicDifference) -> tuple[str, ...]:
    """Return a topic's row; for one without differing floats the first difference."""
    head = (topic.topic, str(topic.n_messages), str(topic.first.tick))
    if topic.largest is None:
        first = topic.first
        return (*head, first.field, str(first.tick), str(first.expected), str(first.actual),
                '', '')
    own = topic.largest
    return (*head, own.field, str(own.tick), f'{own.expected:.6g}', f'{own.actual:.6g}',
            f'{own.size:.3g}', 'none' if own.allowed is None else f'{own.allowed:.3g}')


def _tree(topic: TopicDifference) -> dict[str, Any]:
    first, largest = topic.first, topic.largest
    return {
        'topic': topic.topic, 'messages': topic.n_messages,
        'first': {'tick': first.tick, 't_ns': first.t_ns, 'field': first.field,
                  'expected': first.expected, 'actual': first.actual},
        'largest': None if largest is None else largest._asdict() | {'size': largest.size}}


def _json(value: Any) -> Any:
    """Return a value with what JSON lacks as text."""
    if isinstance(value, dict):
        return {key: _json(below) for key, below in value.items()}
    if isinstance(value, list):
        return [_json(below) for below in value]
    if isinstance(value, bytes):
        return value.hex()
    return repr(value) if isinstance(value, float) and not math.isfinite(value) else value
