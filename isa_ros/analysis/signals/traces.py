"""Columns of numbers from the messages of a bag, read chunk by chunk into arrays of known size."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from isa_ros.bag.message_table import MessageTable
from isa_ros.bag.reader import Bag
from isa_ros.errors import BagError
from msg_adapters.cdr_reader import message_class
from msg_adapters.template import NumberLayout
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Column(NamedTuple):
    """What is wanted of the messages of a topic: a number, or a row of numbers."""

    name: str
    paths: tuple[str, ...]
    """Of its fields: ``position[0]``."""
    is_row: bool = False
    offset: float = 0.0
    """Added to each value."""


class Trace:
    """Times and columns of one topic; a column that its messages do not have is left out."""

    def __init__(self, topic: str, type_name: str, n: int, columns: Sequence[Column],
                 where: str) -> None:
        self.times = np.empty(n, np.int64)
        """Of the messages, ns, (n,)."""
        self.values: dict[str, Floats] = {}
        """By name of the column, (n,), or (n, k) of a row of k numbers."""
        self._type, self._columns, self._where = type_name, columns, f'{where}: {topic}'
        self._layout: NumberLayout | None = None
        self._filled = 0

    def add(self, messages: MessageTable) -> None:
        """
        Add messages behind those added before.

        Raises
        ------
        BagError
            They differ from the first one in more than their numbers.

        """
        begin, end = self._filled, self._filled + len(messages.times)
        self._filled = end
        self.times[begin:end] = messages.times
        if not self._columns:
            return
        if self._layout is None:
            self._begin(messages.content[messages.begins[0]:messages.ends[0]])
        stored = messages.bytes_of()
        numbers = None if stored is None or self._layout is None else self._layout.numbers(stored)
        if numbers is None:
            raise BagError(f'{self._where}: the messages change their layout, cannot be drawn')
        for column in self._columns:
            if column.name in self.values:
                into = self.values[column.name][begin:end].reshape(end - begin, -1)
                for k, path in enumerate(column.paths):
                    into[:, k] = numbers[path]
                if column.offset:
                    into += column.offset

    def _begin(self, first: bytes) -> None:
        """Make room for the columns that the first message has."""
        self._layout = NumberLayout.of(first, message_class(self._type))
        names = set() if self._layout is None else {*(self._layout.record.names or ())}
        n = len(self.times)
        for column in self._columns:
            if names.issuperset(column.paths):
                self.values[column.name] = np.empty(
                    (n, len(column.paths)) if column.is_row else (n,))


def read_traces(bag: Bag, wanted: Mapping[str, Sequence[Column]]) -> dict[str, Trace]:
    """
    Return the columns of topics, as far as the bag has them; without columns the times alone.

    Raises
    ------
    BagError
        The messages of a topic change their layout.
    CdrError
        A message is not of its type.

    """
    traces = {topic: Trace(topic, bag.types[topic], bag.counts[topic], columns, str(bag.path))
              for topic, columns in wanted.items() if bag.counts[topic]}
    for topic, messages in bag.columns(traces):
        traces[topic].add(messages)
    return traces


def seconds(t_ns: NDArray[np.int64]) -> Floats:
    """Return integer nanoseconds as the seconds of a trace, (n,)."""
    return t_ns.astype(np.float64) * 1e-9
