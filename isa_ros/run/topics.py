"""The topics a run records, in their canonical order."""

from collections.abc import Sequence

from isa_ros.config.run_config import RunConfig
from isa_ros.core.topic import Topic
from isa_ros.run.exchange import Messages
from isa_ros.surroundings.surroundings import CLOCK_TOPIC, EVENT_TOPIC, SharedLoad
from msg_adapters import actuator_messages


class Order:
    """
    The canonical order of one sample: all topics of all sources, sorted by name.

    ``sources`` are the topic names of each participant, then `/clock` alone, then those of
    the shared load; ``events`` is the topic that may speak several times at one instant.
    """

    def __init__(self, sources: Sequence[Sequence[str]], events: str) -> None:
        places = sorted(
            (name, source, slot)
            for source, names in enumerate([*sources, [events]])
            for slot, name in enumerate(names))
        self.topics = tuple(name for name, _, _ in places)
        if len(set(self.topics)) != len(self.topics):
            raise ValueError(f'a topic has two sources: {self.topics}')
        self._events = self.topics.index(events)
        self._places = tuple(
            (index, source, slot) for index, (_, source, slot) in enumerate(places)
            if index != self._events)

    def merge(
            self, sources: Sequence[Messages], events: Sequence[bytes] = ()
            ) -> list[tuple[int, bytes]]:
        """Return (topic index, message) of everything new, ascending."""
        merged = [(index, message) for index, source, slot in self._places
                  if (message := sources[source][slot]) is not None]
        if events:
            merged += [(self._events, event) for event in events]
            merged.sort(key=lambda pair: pair[0])
        return merged


def topics_of(run: RunConfig, load: SharedLoad) -> tuple[Order, list[Topic]]:
    """Return the canonical order of a run's topics, and the topics in it."""
    silent: list[list[tuple[str, str]]] = [[] for _ in run.controllers]
    sources = [
        *([(f'/{actuator.name}/{suffix}', type_) for suffix, type_ in actuator_messages.TOPICS]
          for actuator in run.actuators),
        *silent, [CLOCK_TOPIC], list(load.topics)]
    types = dict([*(topic for source in sources for topic in source), EVENT_TOPIC])
    order = Order([[name for name, _ in source] for source in sources], EVENT_TOPIC[0])
    return order, [Topic(name, types[name]) for name in order.topics]
