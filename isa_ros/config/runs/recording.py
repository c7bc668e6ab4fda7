"""
Recorded topics of a run and the format of its files: the section `record` of a run file.

::

    record:
      compression: zstd              # none, lz4, zstd
      split_mb: 100                  # a new file after so many MB; 0: one file
      leave_out: [/*/references]     # topics; * stands for any text
      decimate: {/*/pressure_?: 10}  # only the samples of every tenth tick
"""

from collections.abc import Iterable
from dataclasses import replace
from fnmatch import fnmatchcase
from typing import Any

from isa_ros.bag.storage import PLAIN, Storage
from isa_ros.config.runs.topic_patterns import (
    fitting, patterns, period_of, Periods, periods)
from isa_ros.config.text.key_tables import KeyTable
from isa_ros.config.text.keys import Key, ParameterSet, Value
from isa_ros.config.text.parameter_sets import as_tree, build
from isa_ros.config.text.sections import Place, written
from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.frozen import frozen
from isa_ros.errors import ConfigError
from isa_ros.surroundings.kept_ports import LOAD_PORT_TOPIC

_EVENTS = '/coordinator/events'
_INPUTS = ('sent_setpoint', LOAD_PORT_TOPIC)


@frozen
class RecordConfig:
    """Storage, and the topics that are left out or decimated."""

    storage: Storage = PLAIN
    leave_out: tuple[str, ...] = ()
    """Patterns of topics that are not recorded."""
    decimate: Periods = ()
    """(pattern of topics, n): recorded at every n-th tick; the first matching pattern counts."""

    @property
    def thins(self) -> bool:
        """Return whether anything is left out or decimated."""
        return bool(self.leave_out or self.decimate)

    def thins_like(self, other: 'RecordConfig') -> bool:
        """Return whether another configuration leaves out and decimates the same."""
        return (self.leave_out, self.decimate) == (other.leave_out, other.decimate)

    def period(self, topic: str) -> int:
        """Return the period of recording a topic in ticks, 0 for never."""
        if replay_needs(topic):
            return 1
        if any(fnmatchcase(topic, pattern) for pattern in self.leave_out):
            return 0
        return period_of(topic, self.decimate)

    def refuse_misfits(self, topics: Iterable[str], source: str) -> None:
        """
        Refuse patterns that match no topic of a run, or one that replay needs.

        Raises
        ------
        ConfigError
            One of the patterns is refused; the message has its file and key.

        """
        topics, place = sorted(topics), Place(source, 'record')
        for pattern in self.leave_out:
            for topic in fitting(pattern, topics, place / 'leave_out'):
                if replay_needs(topic):
                    raise ConfigError(
                        f'{place / "leave_out"} = {pattern!r} leaves out {topic}, which a '
                        'replay needs')
        for pattern, _ in self.decimate:
            found = fitting(pattern, topics, place / 'decimate')
            if all(replay_needs(topic) for topic in found):
                raise ConfigError(
                    f'{place / "decimate"} = {pattern!r} decimates {found[0]}, of which a '
                    'replay needs every message')

    def stored(
            self, compression: str | None, split_mb: float | None,
            where: str) -> 'RecordConfig':
        """
        Return a copy with the values given at ``where``; None leaves a value unchanged.

        Raises
        ------
        ConfigError
            A value is unknown or out of range.

        """
        given = {'compression': compression, 'split_mb': split_mb}
        values: Tree = {key: value for key, value in given.items() if value is not None}
        place = Place(where)
        return replace(self, storage=build(
            Storage, written(as_tree(self.storage) | values, place), place))


def replay_needs(topic: str) -> bool:
    """Return whether a topic holds inputs of a run, which are the inputs of its replay."""
    suffix = topic.rpartition('/')[2]
    return topic == _EVENTS or suffix.startswith('applied_') or suffix in _INPUTS


class _RecordKind(KeyTable):
    """The section; read as a `RecordConfig`."""

    def read(self, tree: Any, place: Place) -> Any:
        """Return the configuration; as `Kind.read`."""
        return RecordConfig(**super().read(tree, place))


RECORD = _RecordKind((
    Key('leave_out', Value('list of topics', patterns),
        'topics that are not recorded; * stands for any text', []),
    Key('decimate', Value('whole numbers by topic', periods),
        'topics of which only every n-th tick is recorded', {},
        of=lambda record: dict(record.decimate))),
    rest=Key('storage', ParameterSet(Storage), 'the files of the bag'))
