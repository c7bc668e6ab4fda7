"""
One file of a bag, whole or cut short by a killed recorder.

Opening reads it once and checks every checksum and every message record, so that iterating
over an opened file raises no error.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
import re
from typing import NamedTuple

from isa_ros.bag.message_chunk import MESSAGE_HEADER
from isa_ros.bag.part_writer import CONTINUES, NUMBER, PART
from isa_ros.bag.records import chunk_content, End, parse_record, read_records, Record
from isa_ros.errors import BagError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, McapRecord, Metadata, Schema

_HEAD_BYTES = 9  # opcode, length
_PREFIX_BYTES = MESSAGE_HEADER.size
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
    where the file has none; ``is_whole`` tells whether the recorder came to its end.
    ``start_ns`` and ``end_ns`` are None without messages.

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
        self.attachments: dict[str, bytes] = {}
        self.metadata: dict[str, Mapping[str, str]] = {}
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
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
        for record in self._records():
            if isinstance(record, Record) and isinstance(record.parsed, Chunk):
                yield from self._chunk_messages(record.parsed, self._where(record))

    def _records(self) -> Iterator[Record | End]:
        try:
            with self.path.open('rb') as file:
                yield from read_records(file, str(self.path))
        except OSError as error:
            raise BagError(f'{self.path}: cannot be read, {error.strerror}') from None

    def _scan(self) -> None:
        for record in self._records():
            if isinstance(record, End):
                self.is_whole = record.is_whole
            elif isinstance(record.parsed, Chunk):
                self._scan_chunk(record.parsed, self._where(record))
            elif isinstance(record.parsed, Attachment):
                self.attachments[record.parsed.name] = record.parsed.data
            elif isinstance(record.parsed, Metadata):
                self.metadata[record.parsed.name] = record.parsed.metadata
            elif isinstance(record.parsed, (Schema, Channel)):
                self._register(record.parsed, self._where(record))
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

    def _chunk_messages(self, chunk: Chunk, where: str) -> Iterator[BagMessage]:
        data = chunk_content(chunk, where)
        position = 0
        while position < len(data):
            start = position + _HEAD_BYTES
            position = start + int.from_bytes(data[position + 1:start], 'little')
            if start > len(data) or position > len(data):
                raise BagError(f'{where}: a record reaches beyond its chunk')
            opcode = data[start - _HEAD_BYTES]
            if opcode == _MESSAGE:
                yield self._message(data, start - _HEAD_BYTES, position, where)
            elif opcode in _DECLARATIONS:
                self._register(parse_record(opcode, data[start:position], where), where)
            elif opcode == 0:
                raise BagError(f'{where}: unknown record 0x00 in a chunk')

    def _message(self, data: bytes, start: int, end: int, where: str) -> BagMessage:
        if end - start < _PREFIX_BYTES:
            raise BagError(f'{where}: a message record of {end - start} bytes')
        _, _, channel, sequence, t_ns, _ = MESSAGE_HEADER.unpack_from(data, start)
        if channel not in self._channels:
            raise BagError(f'{where}: a message on channel {channel}, which is not declared')
        topic = self._channels[channel].topic
        return BagMessage(t_ns, sequence, topic, data[start + _PREFIX_BYTES:end])

    def _register(self, declared: McapRecord | None, where: str) -> None:
        """Store a schema or channel; a second declaration must be equal to the first."""
        if isinstance(declared, Schema):
            if self._schemas.setdefault(declared.id, declared) != declared:
                raise BagError(f'{where}: schema {declared.id} is declared twice')
            _refuse_unless(_TYPE, declared.name, f'{where}: type')
        elif isinstance(declared, Channel):
            if self._channels.setdefault(declared.id, declared) != declared:
                raise BagError(f'{where}: channel {declared.id} is declared twice')
            self._register_topic(declared, where)

    def _register_topic(self, channel: Channel, where: str) -> None:
        _refuse_unless(_TOPIC, channel.topic, f'{where}: topic')
        if channel.schema_id not in self._schemas or channel.message_encoding != 'cdr':
            raise BagError(
                f'{where}: {channel.topic} is {channel.message_encoding!r} with schema '
                f"{channel.schema_id}, must be 'cdr' with a schema declared before it")
        type_name = self._schemas[channel.schema_id].name
        if self.types.setdefault(channel.topic, type_name) != type_name:
            raise BagError(
                f'{where}: {channel.topic} has two types, {self.types[channel.topic]} '
                f'and {type_name}')
        self.type_hashes[channel.topic] = channel.metadata.get('topic_type_hash', '')

    def _where(self, record: Record) -> str:
        return f'{self.path}: damaged at byte {record.offset}'


def _refuse_unless(valid: re.Pattern[str], name: str, what: str) -> None:
    if not valid.fullmatch(name):
        raise BagError(f'{what} {name[:80]!r}, must be a ROS name of letters, digits, _ and /')
