"""The signals of a bag as arrays over time."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from isa_ros.bag.provenance import CONFIGURATION
from isa_ros.bag.reader import Bag
from isa_ros.config.recorded_run import recorded_run, RecordedRun
from isa_ros.errors import BagError
from msg_adapters import applied_parameters, device, diagnostics, event
from msg_adapters.cdr_reader import message_class
from msg_adapters.template import number_columns
import numpy as np

_NO_SIGNALS = (  # texts of any length
    applied_parameters.TYPE, device.TYPE, diagnostics.TYPE, event.TYPE)


@dataclass(frozen=True)
class Trace:
    """One topic: times (n,) in s and its numeric fields by path, each of shape (n,)."""

    t: np.ndarray
    fields: np.ndarray

    def __getitem__(self, path: str) -> np.ndarray:
        return self.fields[path]

    def has(self, paths: Sequence[str]) -> bool:
        """Return whether its messages have all these fields, as those of this version do."""
        return set(paths) <= set(self.fields.dtype.names or ())


def read_traces(path: Path) -> tuple[RecordedRun, dict[str, Trace]]:
    """
    Return the run of a bag to read it by, and every topic of signals in it by name.

    Raises
    ------
    BagError
        Not a bag, damaged, or a topic whose messages change their layout.

    """
    bag = Bag(path)
    times: dict[str, list[int]] = {}
    messages: dict[str, list[bytes]] = {}
    for message in bag.messages():
        if bag.types[message.topic] in _NO_SIGNALS:
            continue
        times.setdefault(message.topic, []).append(message.t_ns)
        messages.setdefault(message.topic, []).append(message.data)
    found = recorded_run(bag.provenance.configuration, f'{path}: {CONFIGURATION}')
    return found, {
        topic: Trace(seconds(np.array(times[topic]) - found.run.start_ns),
                     columns(messages[topic], bag.types[topic], f'{path}: {topic}'))
        for topic in times}


def seconds(t_ns: np.ndarray) -> np.ndarray:
    """Return integer nanoseconds as the seconds of a trace, (n,)."""
    return t_ns * 1e-9


def columns(messages: Sequence[bytes], type_name: str, where: str) -> np.ndarray:
    """
    Return the numbers of messages of one layout as a structured view, shape (n,).

    Raises
    ------
    BagError
        The messages differ in more than their numbers.

    """
    found = number_columns(messages, message_class(type_name))
    if found is None:
        raise BagError(f'{where}: the messages change their layout, cannot be drawn')
    return found
