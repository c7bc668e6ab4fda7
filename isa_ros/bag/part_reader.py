"""
One file of a bag, whole or cut short by a killed recorder.

Opening reads it once and checks every checksum and every message record, so that iterating
over an opened file raises no error.
"""

from collections import Counter
from collections.abc import Container, Iterator, Mapping
from pathlib import Path
import re
import struct
from typing import NamedTuple

from isa_ros.bag.message_table import messages_in, MessageTable
from isa_ros.bag.part_writer import CONTINUES, NUMBER, PART, TYPE_HASH
from isa_ros.bag.records import (
    chunk_content, FileEnd, FileRecord, FREE_RECORDS, parse_record, read_records, record_at)
from isa_ros.errors import BagError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, McapRecord, Metadata, Schema
import numpy as np

_INDEX = struct.Struct('<HI')  # channel, bytes of entries
_ENTRY = np.dtype([('t_ns', '<u8'), ('offset', '<u8')])
_HEADER = np.dtype([('opcode', 'u1'), ('length', '<u8'), ('channel', '<u2'),
                    ('sequence', '<u4'), ('t_ns', '<u8'), ('published_ns', '<u8')])
"""`MESSAGE_HEADER` for many messages."""
_MESSAGE = int(Opcode.MESSAGE)
_END_NS = 2**63     # times of ROS have 64 bits with a sign
_DECLARATIONS = (Opcode.SCHEMA, Opcode.CHANNEL)
_TOPIC = re.compile(r'[A-Za-z0-9_/~]{1,255}')
_TYPE = re.compile(r'[A-Za-z0-9_/]{1,255}')


class BagMessage(NamedTuple):
    """One recorded message."""

    t_ns: int
    sequence: int
    topic: str
    data: bytes


class _StoredChunk(NamedTuple):
    """A chunk of the file."""

    offset: int
    topics: frozenset[str]


class PartReader:
    """
    One MCAP file.

    ``types`` are the message types by topic, ``type_hashes`` those of their definitions, ''
    where the file has none; ``counts`` are the messages by topic; ``is_whole`` is whether the
    recorder came to its end. ``start_ns`` and ``end_ns`` are None without messages; ``cut_bytes``
    are behind the last complete record. ``schemas`` and ``channels`` are the declared ones by id.

    Raises
    ------
    BagError
        The file is not a bag, or damaged; the message has the file, the offset and the error.

    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.types: dict[str, str] = {}
        self.type_hashes: dict[str, str] = {}
        self.counts: Counter[str] = Counter()
        self.start_ns: int | None = None
        self.end_ns: int | None = None
        self.is_whole = False
        self.cut_bytes = 0
        self.attachments: dict[str, bytes] = {}
        self.metadata: dict[str, Mapping[str, str]] = {}
        self.schemas: dict[int, Schema] = {}
        self.channels: dict[int, Channel] = {}
        self._content = b''
        """Of the last chunk."""
        self._chunks: list[_StoredChunk] = []
        if not path.is_file():
            raise BagError(f'{path}: is not a file')
        self._scan()

    @property
    def n_messages(self) -> int:
        """Return the number of messages."""
        return self.counts.total()

    @property
    def number(self) -> str | None:
        """Return the number that the file is labelled with, None without a label."""
        return self.metadata.get(PART, {}).get(NUMBER)

    @property
    def continues(self) -> bool:
        """Return whether the recorder continued in another file."""
        return CONTINUES in self.metadata

    def messages(self, topics: Container[str] | None = None) -> Iterator[BagMessage]:
        """Yield every message, or those of some topics, in file order."""
        for table in self.tables(topics):
            wanted = {number: channel.topic for number, channel in self.channels.items()
                      if topics is None or channel.topic in topics}
            for channel, sequence, t_ns, begin, end in zip(*(
                    column.tolist() for column in table[1:])):
                if channel in wanted:
                    yield BagMessage(t_ns, sequence, wanted[channel], table.content[begin:end])

    def tables(self, topics: Container[str] | None = None) -> Iterator[MessageTable]:
        """Yield the messages of each chunk that has some of the topics, with all others in it."""
        try:
            with self.path.open('rb') as file:
                for stored in self._chunks:
                    if topics is None or any(topic in topics for topic in stored.topics):
                        where = f'{self.path}: damaged at byte {stored.offset}'
                        chunk = record_at(file, stored.offset, where)
                        if not isinstance(chunk, Chunk):
                            raise BagError(f'{where}: is not the chunk that it was')
                        yield self._table(chunk, where)
        except OSError as error:
            raise BagError(f'{self.path}: cannot be read, {error.strerror}') from None

    def records(self) -> Iterator[FileRecord | FileEnd]:
        """Yield every record of the file, then its end."""
        try:
            with self.path.open('rb') as file:
                yield from read_records(file, str(self.path))
        except OSError as error:
            raise BagError(f'{self.path}: cannot be read, {error.strerror}') from None

    def _scan(self) -> None:
        for record in self.records():
            if isinstance(record, FileEnd):
                self.is_whole = record.is_whole
                self.cut_bytes = record.rest
            elif isinstance(record.parsed, Chunk):
                topics = self._scan_chunk(record.parsed, self._where(record))
                self._chunks.append(_StoredChunk(record.offset, topics))
            elif isinstance(record.parsed, Attachment):
                self.attachments[record.parsed.name] = record.parsed.data
            elif isinstance(record.parsed, Metadata):
                self.metadata[record.parsed.name] = record.parsed.metadata
            elif isinstance(record.parsed, (Schema, Channel)):
                self._register(record.parsed, self._where(record))
            elif record.opcode == Opcode.MESSAGE_INDEX:
                self._check_index(record.content, self._where(record))
            elif record.opcode == Opcode.MESSAGE:
                raise BagError(f'{self._where(record)}: a message outside chunks, not supported')

    def _scan_chunk(self, chunk: Chunk, where: str) -> frozenset[str]:
        """Check the messages of a chunk and count them; return their topics."""
        table = self._table(chunk, where)
        numbers, counts = np.unique(table.channels, return_counts=True)
        found = {self.channels[int(number)].topic: int(n) for number, n in zip(numbers, counts)}
        if found:
            if self.start_ns is None:
                self.start_ns = self.end_ns = int(table.times[0])
            self._refuse_decrease(table, where)
            self._refuse_late(table, where)
            self.end_ns = int(table.times[-1])
            self.counts.update(found)
        return frozenset(found)

    def _refuse_decrease(self, table: MessageTable, where: str) -> None:
        """Refuse a message that is older than the one before it."""
        before = np.concatenate([np.array([self.end_ns], np.uint64), table.times[:-1]])
        falls = np.flatnonzero(table.times < before)
        if len(falls):
            k = int(falls[0])
            raise BagError(
                f'{where}: time decreases on {self.channels[int(table.channels[k])].topic}, from '
                f'{before[k]} to {table.times[k]} ns')

    def _refuse_late(self, table: MessageTable, where: str) -> None:
        """Refuse a time that ROS cannot have, of messages whose time does not decrease."""
        if table.times[-1] >= _END_NS:
            raise BagError(
                f'{where}: t = {table.times[-1]} ns on '
                f'{self.channels[int(table.channels[-1])].topic}, must be < 2^63 ns')

    def _check_index(self, content: bytes, where: str) -> None:
        """Refuse an index that is not of the chunk before it: then another chunk was lost."""
        if not _is_index_of(self._content, content):
            raise BagError(f'{where}: an index that is not of the chunk before it')

    def _table(self, chunk: Chunk, where: str) -> MessageTable:
        """Return the messages of a chunk; its schemas and channels are stored."""
        self._content = chunk_content(chunk, where)
        table, others = messages_in(
            self._content, max(FREE_RECORDS, len(chunk.data)), where)
        for opcode, content in others:
            if opcode in _DECLARATIONS:
                self._register(parse_record(opcode, content, where), where)
        for channel in np.unique(table.channels).tolist():
            if channel not in self.channels:
                raise BagError(
                    f'{where}: a message on channel {channel}, which is not declared')
        return table

    def _register(self, declared: McapRecord | None, where: str) -> None:
        """Store a schema or channel; a second declaration must be equal to the first."""
        if isinstance(declared, Schema):
            if self.schemas.setdefault(declared.id, declared) != declared:
                raise BagError(f'{where}: schema {declared.id} is declared twice')
            _refuse_unless(_TYPE, declared.name, f'{where}: type')
        elif isinstance(declared, Channel):
            if self.channels.setdefault(declared.id, declared) != declared:
                raise BagError(f'{where}: channel {declared.id} is declared twice')
            self._register_topic(declared, where)

    def _register_topic(self, channel: Channel, where: str) -> None:
        _refuse_unless(_TOPIC, channel.topic, f'{where}: topic')
        if channel.schema_id not in self.schemas or channel.message_encoding != 'cdr':
            raise BagError(
                f'{where}: {channel.topic} is {channel.message_encoding!r} with schema '
                f"{channel.schema_id}, must be 'cdr' with a schema declared before it")
        type_name = self.schemas[channel.schema_id].name
        if self.types.setdefault(channel.topic, type_name) != type_name:
            raise BagError(
                f'{where}: {channel.topic} has two types, {self.types[channel.topic]} '
                f'and {type_name}')
        self.type_hashes[channel.topic] = channel.metadata.get(TYPE_HASH, '')

    def _where(self, record: FileRecord) -> str:
        return f'{self.path}: damaged at byte {record.offset}'


def _is_index_of(chunk: bytes, content: bytes) -> bool:
    """Return whether the content of an index record leads to messages of its channel only."""
    if len(content) < _INDEX.size:
        return False
    channel, size = _INDEX.unpack_from(content)
    entries = content[_INDEX.size:]
    if len(entries) != size or size % _ENTRY.itemsize:
        return False
    found = np.frombuffer(entries, _ENTRY)
    if not len(found):
        return True
    if int(found['offset'].max()) + _HEADER.itemsize > len(chunk):
        return False
    places = found['offset'].astype(np.int64)[:, None] + np.arange(_HEADER.itemsize)
    headers = np.frombuffer(chunk, np.uint8)[places].view(_HEADER)[:, 0]
    return bool((headers['opcode'] == _MESSAGE).all() and (headers['channel'] == channel).all()
                and (headers['t_ns'] == found['t_ns']).all())


def _refuse_unless(valid: re.Pattern[str], name: str, what: str) -> None:
    if not valid.fullmatch(name):
        raise BagError(f'{what} {name[:80]!r}, must be a ROS name of letters, digits, _ and /')
