"""metadata.yaml of a rosbag2 directory, version 9, in the order and form rosbag2 writes it."""

from collections.abc import Mapping, Sequence
from functools import cache
from itertools import takewhile
import json
from typing import NamedTuple

from isa_ros.core.topic import Topic

VERSION = 9
FILE_NAME = 'metadata.yaml'
ROS_DISTRO = 'jazzy'
SIGNATURE = ('format', 'configuration.yaml.sha256')
"""Keys of the custom data that a bag of this package has."""
NO_START = 2**63 - 1  # rosbag2's starting time of a bag without messages
_ROOT = 'rosbag2_bagfile_information:'


class Counts(NamedTuple):
    """Messages written so far, to one file or to all files."""

    start_ns: int
    end_ns: int
    messages: Sequence[int]  # by topic, (n_topics,)

    @classmethod
    def together(cls, parts: Sequence['Counts']) -> 'Counts':
        """Return the sum over consecutive files."""
        filled = [part for part in parts if part.total]
        return cls(
            filled[0].start_ns if filled else NO_START, filled[-1].end_ns if filled else NO_START,
            [sum(counts) for counts in zip(*(part.messages for part in parts))])

    @property
    def total(self) -> int:
        """Return the number of messages of all topics."""
        return sum(self.messages)

    @property
    def duration_ns(self) -> int:
        """Return the time from the first message to the last, 0 without messages."""
        return self.end_ns - self.start_ns if self.total else 0


class TopicEntry(NamedTuple):
    """A topic as bags describe it."""

    name: str
    type_name: str
    qos: str
    """Offered quality of service, YAML."""
    type_hash: str

    @classmethod
    def of(cls, topic: Topic, type_hash: str) -> 'TopicEntry':
        """Return the entry of a topic."""
        return cls(topic.name, topic.type_name, topic.qos.to_yaml(), type_hash)


def metadata_yaml(
        files: Sequence[tuple[str, Counts]], topics: Sequence[TopicEntry],
        custom: Mapping[str, str]) -> str:
    """
    Return the text of metadata.yaml.

    ``files`` are (name, counts) in order of time.
    """
    lines = _information(files, topics, custom)
    return '\n'.join([_ROOT, *_indent(lines, 2), ''])


def own_files(text: str) -> list[str] | None:
    """
    Return the files that a metadata.yaml of this package lists; None for any other text.

    Only the form that `metadata_yaml` writes is read, with the provenance of a run in it.
    """
    lines = text.split('\n')
    files = _block(lines, 'relative_file_paths')
    custom = [line.partition(': ')[0] for line in _block(lines, 'custom_data')]
    is_own = lines[0] == _ROOT and '  storage_identifier: mcap' in lines and all(
        _quote(key) in custom for key in SIGNATURE)
    if not is_own or not all(line.startswith('- ') for line in files):
        return None
    try:
        names = [json.loads(line.removeprefix('- ')) for line in files]
    except ValueError:
        return None
    return names if all(isinstance(name, str) for name in names) else None


def _block(lines: Sequence[str], name: str) -> list[str]:
    """Return the lines below a key of the information, without their indentation."""
    if f'  {name}:' not in lines:
        return []
    start = lines.index(f'  {name}:') + 1
    return [line[4:] for line in takewhile(lambda line: line.startswith('    '), lines[start:])]


def storage_metadata(custom: Mapping[str, str]) -> str:
    """
    Return the metadata inside an MCAP file, which rosbag2 uses if metadata.yaml is lost.

    It has neither file names nor counts: rosbag2 takes both from the file.
    """
    return '\n'.join(_information((), (), custom))


def has_custom(storage: str, custom: Mapping[str, str]) -> bool:
    """Return whether a text of `storage_metadata` has exactly this custom data."""
    lines = storage.split('\n')
    start = lines.index('custom_data:') + 1 if 'custom_data:' in lines else len(lines)
    return list(takewhile(lambda line: line.startswith('  '), lines[start:])) == [
        f'  {_quote(key)}: {_quote(value)}' for key, value in custom.items()]


def _information(
        files: Sequence[tuple[str, Counts]], topics: Sequence[TopicEntry],
        custom: Mapping[str, str]) -> list[str]:
    counts = Counts.together([part for _, part in files])
    start, duration, total = _extent(counts)
    described = [
        line for topic, count in zip(topics, counts.messages)
        for line in [*_topic_metadata(topic), f'  message_count: {count}']]
    return [
        f'version: {VERSION}', 'storage_identifier: mcap', *duration, *start, total,
        *_list('topics_with_message_count', described),
        'compression_format: ""', 'compression_mode: ""',  # of whole files, not of chunks
        *_list('relative_file_paths', [f'- {_quote(name)}' for name, _ in files]),
        *_list('files', [line for name, part in files for line in _file(name, part)]),
        *(['custom_data:'] if custom else ['custom_data: ~']),
        *(f'  {_quote(key)}: {_quote(value)}' for key, value in custom.items()),
        f'ros_distro: {ROS_DISTRO}']


def _extent(counts: Counts) -> tuple[list[str], list[str], str]:
    return (['starting_time:', f'  nanoseconds_since_epoch: {counts.start_ns}'],
            ['duration:', f'  nanoseconds: {counts.duration_ns}'],
            f'message_count: {counts.total}')


def _file(name: str, counts: Counts) -> list[str]:
    start, duration, total = _extent(counts)
    return _item([f'path: {_quote(name)}', *start, *duration, total])


@cache
def _topic_metadata(topic: TopicEntry) -> tuple[str, ...]:
    return tuple(_item([
        'topic_metadata:',
        *_indent([
            f'name: {topic.name}', f'type: {topic.type_name}', 'serialization_format: cdr',
            'offered_qos_profiles:', *_indent(topic.qos.split('\n'), 2),
            f'type_description_hash: {topic.type_hash}'], 2)]))


def _list(name: str, lines: Sequence[str]) -> list[str]:
    return [f'{name}:', *_indent(lines, 2)] if lines else [f'{name}: []']


def _item(lines: Sequence[str]) -> list[str]:
    return [f'- {lines[0]}', *_indent(lines[1:], 2)]


def _indent(lines: Sequence[str], n: int) -> list[str]:
    return [' ' * n + line for line in lines]


def _quote(text: str) -> str:
    """Return a double-quoted YAML scalar; JSON's escapes are YAML's."""
    return json.dumps(text)
