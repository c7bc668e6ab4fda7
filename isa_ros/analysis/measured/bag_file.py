"""Numbers from any rosbag2 bag: MCAP or sqlite3, of message types that are installed."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
import sqlite3
from typing import Any, NamedTuple, TypeVar

from isa_ros.core.suggest import alternatives, shortened
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import BagError, ConfigError
from mcap.exceptions import McapError
from mcap.reader import make_reader
from msg_adapters.cdr import CdrError
from msg_adapters.cdr_reader import decode, flatten, message_class
from msg_adapters.template import number_columns
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
T = TypeVar('T')

MCAP, SQLITE = '.mcap', '.db3'
_KINDS: Mapping[type, str] = {str: 'text', int: 'a whole number', bytes: 'bytes'}


class Messages(NamedTuple):
    """The messages of one topic."""

    type_name: str
    times: list[int]
    """By the recorder's clock, ns."""
    data: list[bytes]


def is_bag(path: Path) -> bool:
    """Return whether a path is a rosbag2 directory, or one of its files."""
    return path.is_dir() or path.suffix in (MCAP, SQLITE)


def read_fields(
        path: Path, wanted: Mapping[str, Sequence[str]]) -> dict[str, tuple[Floats, Floats]]:
    """
    Return times (s, from the first of all wanted messages) and values of TOPIC FIELD, each (n,).

    Raises
    ------
    BagError
        It is no bag, is damaged, or a message is not of its type.
    ConfigError
        It has no such topic, the topic has no messages in CDR, or these no such field.

    """
    topics: dict[str, Messages] = {}
    known: set[str] = set()
    for file in _files(path):
        for topic, type_name, t_ns, data in _messages(file, known):
            if topic in wanted:
                own = topics.setdefault(topic, Messages(type_name, [], []))
                own.times.append(t_ns)
                own.data.append(data)
    for topic in wanted:
        if topic in known and topic not in topics:
            raise ConfigError(f'{path}: the topic {topic} has no messages in CDR')
        if topic not in topics:
            raise ConfigError(f'{path}: has no messages of {topic}; {alternatives(topic, known)}')
    start = min(own.times[0] for own in topics.values())
    found = {}
    for topic, fields in wanted.items():
        own = topics[topic]
        t = np.array([t_ns - start for t_ns in own.times], np.float64) / NS_PER_SECOND
        for field, values in _values(own, fields, f'{path}: {topic}').items():
            found[f'{topic} {field}'] = (t, values)
    return found


def _values(own: Messages, fields: Sequence[str], where: str) -> dict[str, Floats]:
    """Return the columns of some fields; messages of one layout are read at once."""
    try:
        cls = message_class(own.type_name)
        columns = number_columns(own.data, cls)
        if columns is not None and set(fields) <= set(columns.dtype.names or ()):
            return {field: columns[field].astype(np.float64) for field in fields}
        rows = [dict(flatten(decode(data, cls))) for data in own.data]
    except CdrError as error:
        raise BagError(f'{where}: {error}') from None
    for field in fields:
        for k, row in enumerate(rows):
            if not isinstance(row.get(field), (int, float)):
                raise ConfigError(
                    f'{where}: message {k + 1} has no number {field}; '
                    f'{alternatives(field, row)}')
    return {field: np.array([float(row[field]) for row in rows]) for field in fields}


def _files(path: Path) -> list[Path]:
    """Return the files of a bag, in their order."""
    if not path.is_dir():
        return [path]
    found = [file for file in path.iterdir() if file.suffix in (MCAP, SQLITE)]
    if not found:
        raise BagError(f'{path}: has neither {MCAP} nor {SQLITE} files')
    return sorted(found, key=lambda file: (len(file.name), file.name))


def _messages(path: Path, known: set[str]) -> Iterator[tuple[str, str, int, bytes]]:
    """Yield topic, type, time and bytes of every message; add topics to ``known``."""
    try:
        yield from (_of_sqlite if path.suffix == SQLITE else _of_mcap)(path, known)
    except (McapError, sqlite3.Error, OSError) as error:
        raise BagError(f'{path}: cannot be read: {error}') from None


def _of_mcap(path: Path, known: set[str]) -> Iterator[tuple[str, str, int, bytes]]:
    with path.open('rb') as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        known.update(own.topic for own in (summary.channels if summary else {}).values())
        for schema, channel, message in reader.iter_messages():
            known.add(channel.topic)
            if channel.message_encoding == 'cdr' and schema is not None:
                yield channel.topic, schema.name, message.log_time, message.data


def _of_sqlite(path: Path, known: set[str]) -> Iterator[tuple[str, str, int, bytes]]:
    database: Any = sqlite3.connect(f'{path.resolve().as_uri()}?mode=ro', uri=True)
    try:
        topics: dict[Any, tuple[str, str]] = {}
        for key, name, type_name in database.execute('SELECT id, name, type FROM topics'):
            where = (path, 'topic', key)
            topics[key] = _of(str, name, *where, 'name'), _of(str, type_name, *where, 'type')
        known.update(name for name, _ in topics.values())
        for key, topic, t_ns, data in database.execute(
                'SELECT id, topic_id, timestamp, data FROM messages ORDER BY timestamp, id'):
            where = (path, 'message', key)
            if topic not in topics:
                raise BagError(f'{path}: message {key}: topic_id = {shortened(repr(topic))}, '
                               'is not one of its topics')
            yield (*topics[topic], _of(int, t_ns, *where, 'timestamp'),
                   _of(bytes, data, *where, 'data'))
    finally:
        database.close()


def _of(kind: type[T], value: object, path: Path, row: str, key: object, column: str) -> T:
    """Return a value of a database, which has types by value, if it is of a kind."""
    if not isinstance(value, kind):
        raise BagError(f'{path}: {row} {key}: {column} = {shortened(repr(value))}, '
                       f'must be {_KINDS[kind]}')
    return value
