"""
How often the topics of a run are published: the section `publish` of a run file.

::

    publish:
      decimate: {/clock: 10, /*/references: 50}  # only at every tenth, or fiftieth tick

The bag has what `record` says, whatever is published.
"""

from collections.abc import Iterable
from typing import Any

from isa_ros.config.runs.recording import replay_needs
from isa_ros.config.runs.topic_patterns import fitting, period_of, Periods, periods
from isa_ros.config.text.key_tables import KeyTable
from isa_ros.config.text.keys import Key, Value
from isa_ros.config.text.sections import Place
from isa_ros.core.frozen import frozen
from isa_ros.core.topic import Topic
from isa_ros.errors import ConfigError


@frozen
class PublishConfig:
    """The topics that are not published at every tick."""

    decimate: Periods = ()
    """(pattern of topics, n): published at every n-th tick; the first matching pattern counts."""

    def period(self, topic: Topic) -> int:
        """Return the period of publishing a topic of the bag, ticks; 1 if each message counts."""
        return 1 if _is_whole(topic) else period_of(topic.name, self.decimate)

    def refuse_misfits(self, topics: Iterable[Topic], source: str) -> None:
        """
        Refuse patterns that match no topic of a run, or such alone of which each message counts.

        Raises
        ------
        ConfigError
            One of the patterns is refused; the message has its file and key.

        """
        whole = {topic.name: _is_whole(topic) for topic in topics}
        place = Place(source, 'publish') / 'decimate'
        for pattern, _ in self.decimate:
            found = fitting(pattern, sorted(whole), place)
            if all(whole[name] for name in found):
                raise ConfigError(
                    f'{place} = {pattern!r} decimates {found[0]}, of which every message counts')


def _is_whole(topic: Topic) -> bool:
    """Return whether a topic has events or inputs, or what stays in force until the next one."""
    return topic.qos.is_kept or replay_needs(topic.name)


class _PublishKind(KeyTable):
    """The section; read as a `PublishConfig`."""

    def read(self, tree: Any, place: Place) -> Any:
        """Return the configuration; as `Kind.read`."""
        return PublishConfig(**super().read(tree, place))


PUBLISH_KEYS = _PublishKind((
    Key('decimate', Value('whole numbers by topic', periods),
        'topics that are published at every n-th tick only; * stands for any text', {},
        of=lambda publish: dict(publish.decimate)),))
PUBLISH = Key('publish', PUBLISH_KEYS, 'how often topics are published', None, 'at every tick',
              of=lambda run: run.publish if run.publish.decimate else None)
