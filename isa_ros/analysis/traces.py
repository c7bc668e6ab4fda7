"""The signals of a bag as arrays over time."""

from dataclasses import dataclass
from pathlib import Path

from isa_ros.bag.reader import Bag
from isa_ros.run_config import RunConfig
from msg_adapters.cdr_reader import decode, flatten, message_class
import numpy as np


@dataclass(frozen=True)
class Trace:
    """One topic: times (n,) in s and its numeric fields by path, each of shape (n,)."""

    t: np.ndarray
    fields: dict[str, np.ndarray]

    def __getitem__(self, path: str) -> np.ndarray:
        return self.fields[path]


def read_traces(path: Path) -> tuple[RunConfig, dict[str, Trace]]:
    """
    Return the configuration a bag carries and every topic in it by name.

    Raises
    ------
    BagError
        Not a bag, or damaged.

    """
    bag = Bag(path)
    times: dict[str, list[int]] = {}
    columns: dict[str, dict[str, list[float]]] = {}
    classes = {topic: message_class(name) for topic, name in bag.types.items()}
    for message in bag.messages():
        fields = columns.setdefault(message.topic, {})
        times.setdefault(message.topic, []).append(message.t_ns)
        for field, value in flatten(decode(message.data, classes[message.topic])):
            if not isinstance(value, str):
                fields.setdefault(field, []).append(float(value))
    return RunConfig.from_yaml(bag.provenance.configuration), {
        topic: Trace(
            np.array(times[topic]) * 1e-9,
            {field: np.array(values) for field, values in columns[topic].items()})
        for topic in times}
