"""Golden bags, rewritten as by another version or another person."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from isa_ros.bag.reader import Bag
from isa_ros.bag.storage import PLAIN, Storage
from isa_ros.bag.writer import BagWriter
from isa_ros.core.topic import Topic

GOLDEN = Path(__file__).parents[1] / 'golden'

Change = Callable[[str, int, bytes], bytes | None]


def rewrite(
        bag: Bag, directory: Path, change: Change = lambda topic, sequence, data: data, *,
        configuration: Callable[[str], str] = lambda text: text,
        versions: Mapping[str, str] | None = None, without: tuple[str, ...] = (),
        rename: Mapping[str, str] | None = None, state: str | None = None,
        storage: Storage = PLAIN) -> Path:
    """
    Record ``bag`` again with every message passed through ``change``; return its directory.

    A message of which ``change`` returns None is left out.

    ``configuration`` changes the attached text, ``versions`` replaces those recorded, topics
    ``without`` are left out, and those of ``rename`` are called otherwise; ``state`` is the text
    of one that the run is to have continued from.
    """
    names = {topic: (rename or {}).get(topic, topic) for topic in bag.types
             if topic not in without}
    topics = sorted((Topic(name, bag.types[topic]) for topic, name in names.items()),
                    key=lambda topic: topic.name)
    index = {topic.name: k for k, topic in enumerate(topics)}
    there = bag.provenance
    provenance = replace(
        there, configuration=configuration(there.configuration),
        versions=there.versions if versions is None else versions,
        state=there.state if state is None else state)
    with BagWriter(directory, topics, provenance, storage=storage) as writer:
        for tick in bag.ticks():
            writer.write_tick(tick.t_ns, tick.sequence, sorted(
                (index[names[m.topic]], data) for m in tick.messages if m.topic in names
                and (data := change(m.topic, tick.sequence, m.data)) is not None))
    return directory
