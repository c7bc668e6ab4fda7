"""
One file of a bag, whole or cut short by a killed recorder.

Opening reads it once and checks every checksum and every message record, so that iterating
over an opened file raises no error.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
import re
import struct
from typing import NamedTuple

from isa_ros.bag.message_chunk import MESSAGE_HEADER
from isa_ros.bag.part_writer import CONTINUES, NUMBER, PART, TYPE_HASH
from isa_ros.bag.records import (
    chunk_content, End, FREE_RECORDS, parse_record, read_records, Record)
from isa_ros.errors import BagError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, McapRecord, Metadata, Schema
import numpy as np

_HEAD_BYTES = 9  # opcode, length
_PREFIX_BYTES = MESSAGE_HEADER.size
_INDEX = struct.Struct('<HI')  # channel, bytes of entries
_ENTRY = np.dtype([('t_ns', '<u8'), ('offset', '<u8')])
_HEADER = np.dtype([('opcode', 'u1'), ('length', '<u8'), ('channel', '<u2'),
                    ('sequence', '<u4'), ('t_ns', '<u8'), ('published_ns', '<u8')])
"""`MESSAGE_HEADER` for many messages."""
_MESSAGE = int(Opcode.MESSAGE)  # a comparison with the enum itself takes three times as long
_DECLARATIONS = (int(Opcode.SCHEMA), int(Opcode.CHANNEL))
_TOPIC = re.compile(r'[A-Za-z0-9_/~]{1,255}')
_TYPE = re.compile(r'[A-Za-z0-9_/]{1,255}')


class BagMessage(NamedTuple):
    """One recorded message."""

    t_ns: int
    sequence: int
    topic: str
    data: bytes


class PartReader:
    """
    One MCAP file.

    ``types`` are the message types by topic, ``type_hashes`` those of their definitions, ''
    where the file has none; ``is_whole`` is whether the recorder came to its end.
    ``start_ns`` and ``end_ns`` are None without messages; ``cut_bytes`` are behind the last
    complete record. ``schemas`` and ``channels`` are the declared ones by id.

    Raises
    ------
    BagError
        The file is not a bag, or damaged; the message has the file, the offset and the error.

    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.types: dict[str, str] = {}
        self.type_hashes: dict[str, str] = {}
        self.n_messages = 0
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
        if not path.is_file():
            raise BagError(f'{path}: is not a file')
        self._scan()

    @property
    def number(self) -> str | None:
        """Return the number that the file is labelled with, None without a label."""
        return self.metadata.get(PART, {}).get(NUMBER)

    @property
    def continues(self) -> bool:
        """Return whether the recorder continued in another file."""
        return CONTINUES in self.metadata

    def messages(self) -> Iterator[BagMessage]:
        """Yield every message in file order."""
        for record in self.records():
            if isinstance(record, Record) and isinstance(record.parsed, Chunk):
                yield from self._chunk_messages(record.parsed, self._where(record))

    def records(self) -> Iterator[Record | End]:
        """Yield every record of the file, then its end."""
        try:
            with self.path.open('rb') as file:
                yield from read_records(file, str(self.path))
        except OSError as error:
            raise BagError(f'{self.path}: cannot be read, {error.strerror}') from None

    def _scan(self) -> None:
        for record in self.records():
            if isinstance(record, End):
                self.is_whole = record.is_whole
                self.cut_bytes = record.rest
            elif isinstance(record.parsed, Chunk):
                self._scan_chunk(record.parsed, self._where(record))
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

    def _scan_chunk(self, chunk: Chunk, where: str) -> None:
        for message in self._chunk_messages(chunk, where):
            if self.start_ns is None:
                self.start_ns = self.end_ns = message.t_ns
            if self.end_ns is not None and message.t_ns < self.end_ns:
                raise BagError(
                    f'{where}: time decreases on {message.topic}, from {self.end_ns} to '
                    f'{message.t_ns} ns')
            self.end_ns = message.t_ns
            self.n_messages += 1

    def _check_index(self, content: bytes, where: str) -> None:
        """Refuse an index that is not of the chunk before it: then another chunk was lost."""
        if not _is_index_of(self._content, content):
            raise BagError(f'{where}: an index that is not of the chunk before it')

    def _chunk_messages(self, chunk: Chunk, where: str) -> Iterator[BagMessage]:
        data = self._content = chunk_content(chunk, where)
        end, left = 0, max(FREE_RECORDS, len(chunk.data))
        while end < len(data):  # as `chunk_records`, in a third of the time
            begin, end = end, end + _HEAD_BYTES
            end += int.from_bytes(data[begin + 1:end], 'little')
            if end > len(data):
                raise BagError(f'{where}: a record reaches beyond its chunk')
            left -= 1
            if left < 0:
                raise BagError(
                    f'{where}: more records in a chunk than its {len(chunk.data)} compressed '
                    'bytes, must not be more')
            opcode = data[begin]
            if opcode == _MESSAGE:
                yield self._message(data, begin, end, where)
            elif opcode in _DECLARATIONS:
                self._register(parse_record(opcode, data[begin + _HEAD_BYTES:end], where), where)
            elif opcode == 0:
                raise BagError(f'{where}: unknown record 0x00 in a chunk')

    def _message(self, data: bytes, start: int, end: int, where: str) -> BagMessage:
        if end - start < _PREFIX_BYTES:
            raise BagError(f'{where}: a message record of {end - start} bytes')
        _, _, channel, sequence, t_ns, _ = MESSAGE_HEADER.unpack_from(data, start)
        if channel not in self.channels:
            raise BagError(f'{where}: a message on channel {channel}, which is not declared')
        topic = self.channels[channel].topic
        return BagMessage(t_ns, sequence, topic, data[start + _PREFIX_BYTES:end])

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

    def _where(self, record: Record) -> str:
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
