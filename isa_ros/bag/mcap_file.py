"""
One MCAP file under construction, a whole chunk at a time.

The records are those of the official ``mcap`` library, except the two that come by the
million: its ``Writer`` makes an object and ten small packs of each message and two packs of
each index entry. Here a message costs one pack, and an index is packed at once.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import io
from pathlib import Path
import struct
import zlib

from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Attachment, AttachmentIndex, Channel, Chunk, ChunkIndex, DataEnd
from mcap.records import Footer, Header, McapRecord, Metadata, MetadataIndex, Schema
from mcap.records import Statistics, SummaryOffset
from mcap.writer import MCAP0_MAGIC

MESSAGE_HEADER = struct.Struct('<BQHIQQ')
"""Opcode, length of what follows, channel, sequence, log time, publish time."""

_MESSAGE = int(Opcode.MESSAGE)  # packing the enum itself takes three times as long
_LENGTH_EXCESS = MESSAGE_HEADER.size - 9  # of a message record, over its data
_INDEX_HEADER = struct.Struct('<BQHI')  # opcode, length, channel, bytes of entries
_INDEX_EXCESS = _INDEX_HEADER.size - 9  # of a message index record, over its entries
_FOOTER_FIXED = struct.Struct('<BQQQ')  # opcode, length, summary and summary offset start


class ChunkContent:
    """Messages of one chunk and where each stands in it."""

    def __init__(self, prefix: bytes, n_channels: int) -> None:
        self._parts = [prefix]
        self._indices: list[list[int]] = [[] for _ in range(n_channels)]
        self.size = len(prefix)
        self.start_ns = self.end_ns = 0

    def add(self, t_ns: int, sequence: int, messages: Sequence[tuple[int, bytes]]) -> None:
        """Append the messages of one instant: (topic index, CDR bytes)."""
        if len(self._parts) == 1:
            self.start_ns = t_ns
        self.end_ns = t_ns
        pack, append, indices, offset = (
            MESSAGE_HEADER.pack, self._parts.append, self._indices, self.size)
        for k, data in messages:
            append(pack(
                _MESSAGE, len(data) + _LENGTH_EXCESS, k + 1, sequence, t_ns, t_ns))
            append(data)
            indices[k] += (t_ns, offset)
            offset += MESSAGE_HEADER.size + len(data)
        self.size = offset

    def data(self) -> bytes:
        """Return the content of the chunk."""
        return b''.join(self._parts)

    def message_indices(self) -> list[tuple[int, list[int]]]:
        """Return (channel id, time and offset alternating) of each channel with messages."""
        return [(k + 1, index) for k, index in enumerate(self._indices) if index]


@dataclass
class _Totals:
    """Statistics of the whole file."""

    start_ns: int = 0
    end_ns: int = 0
    chunks: int = 0


class McapFile:
    """
    Append-only MCAP file: what has been written is on disk and complete, record by record.

    A write that fails leaves the file as it was before, so that it can still be read and
    finished. Every method that writes raises the system's OSError.
    """

    def __init__(self, path: Path, library: str) -> None:
        self._file = io.FileIO(path, 'x')
        self._position = 0
        self._crc = 0
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._attachments: list[AttachmentIndex] = []
        self._metadata: list[MetadataIndex] = []
        self._chunks: list[ChunkIndex] = []
        self._counts: list[int] = []
        self._totals = _Totals()
        self._append(MCAP0_MAGIC + _bytes(Header(profile='ros2', library=library)))

    def add_schema(self, name: str, encoding: str, data: bytes) -> int:
        """Register a schema; it goes to the first chunk and the summary."""
        self._schemas.append(Schema(
            id=len(self._schemas) + 1, name=name, encoding=encoding, data=data))
        return len(self._schemas)

    def add_channel(self, topic: str, schema: int, metadata: Mapping[str, str]) -> None:
        """Register the next channel, to which the next topic index belongs."""
        self._channels.append(Channel(
            id=len(self._channels) + 1, schema_id=schema, topic=topic, message_encoding='cdr',
            metadata=dict(metadata)))
        self._counts.append(0)

    def add_attachment(self, name: str, media_type: str, data: bytes) -> None:
        """Write an attachment; its times are 0, the start of simulation time."""
        record = _bytes(Attachment(
            log_time=0, create_time=0, name=name, media_type=media_type, data=data))
        self._attachments.append(AttachmentIndex(
            offset=self._position, length=len(record), log_time=0, create_time=0,
            data_size=len(data), name=name, media_type=media_type))
        self._append(record)

    def add_metadata(self, name: str, metadata: Mapping[str, str]) -> None:
        """Write a key-value record."""
        record = _bytes(Metadata(name=name, metadata=dict(metadata)))
        self._metadata.append(
            MetadataIndex(offset=self._position, length=len(record), name=name))
        self._append(record)

    def new_chunk(self) -> ChunkContent:
        """Return an empty chunk; the first one starts with all schemas and channels."""
        registered = [] if self._chunks else [*self._schemas, *self._channels]
        return ChunkContent(_bytes(*registered), len(self._channels))

    def add_chunk(self, content: ChunkContent) -> None:
        """Write a chunk, uncompressed, and its message indices."""
        data = content.data()
        chunk = _bytes(Chunk(
            message_start_time=content.start_ns, message_end_time=content.end_ns,
            uncompressed_size=len(data), uncompressed_crc=zlib.crc32(data), compression='',
            data=data))
        start, indices, offsets = self._position, b'', {}
        for channel, index in content.message_indices():
            offsets[channel] = start + len(chunk) + len(indices)
            indices += _INDEX_HEADER.pack(
                Opcode.MESSAGE_INDEX, len(index) * 8 + _INDEX_EXCESS, channel, len(index) * 8)
            indices += struct.pack(f'<{len(index)}Q', *index)
        self._append(chunk + indices)
        self._chunks.append(ChunkIndex(
            message_start_time=content.start_ns, message_end_time=content.end_ns,
            chunk_start_offset=start, chunk_length=len(chunk), message_index_offsets=offsets,
            message_index_length=len(indices), compression='', compressed_size=len(data),
            uncompressed_size=len(data)))
        self._count(content)

    def finish(self) -> None:
        """Write the end of the data, the summary and the footer."""
        self._append(_bytes(DataEnd(data_section_crc=self._crc)))
        start, summary, offsets = self._position, b'', []
        for opcode, group in self._summary():
            records = _bytes(*group)
            if records:
                offsets.append(SummaryOffset(
                    group_opcode=opcode, group_start=start + len(summary),
                    group_length=len(records)))
                summary += records
        offset_start = start + len(summary)
        summary += _bytes(*offsets)
        fixed = _FOOTER_FIXED.pack(Opcode.FOOTER, 20, start, offset_start)
        crc = zlib.crc32(fixed, zlib.crc32(summary))
        footer = Footer(
            summary_start=start, summary_offset_start=offset_start, summary_crc=crc)
        self._append(summary + _bytes(footer) + MCAP0_MAGIC)

    def close(self) -> None:
        """Close the file, finished or not."""
        self._file.close()

    def _summary(self) -> list[tuple[Opcode, Sequence[McapRecord]]]:
        totals = self._totals
        statistics = Statistics(
            message_count=sum(self._counts), schema_count=len(self._schemas),
            channel_count=len(self._channels), attachment_count=len(self._attachments),
            metadata_count=len(self._metadata), chunk_count=totals.chunks,
            message_start_time=totals.start_ns, message_end_time=totals.end_ns,
            channel_message_counts={
                k + 1: count for k, count in enumerate(self._counts) if count})
        return [
            (Opcode.SCHEMA, self._schemas), (Opcode.CHANNEL, self._channels),
            (Opcode.STATISTICS, [statistics]), (Opcode.CHUNK_INDEX, self._chunks),
            (Opcode.ATTACHMENT_INDEX, self._attachments),
            (Opcode.METADATA_INDEX, self._metadata)]

    def _count(self, content: ChunkContent) -> None:
        if self._totals.chunks == 0:
            self._totals.start_ns = content.start_ns
        self._totals.end_ns = content.end_ns
        self._totals.chunks += 1
        for channel, index in content.message_indices():
            self._counts[channel - 1] += len(index) // 2

    def _append(self, data: bytes) -> None:
        """Write all of it or nothing."""
        rest = memoryview(data)
        try:
            while rest:
                rest = rest[self._file.write(rest) or 0:]
        finally:
            if rest:
                self._file.truncate(self._position)
                self._file.seek(self._position)
        self._position += len(data)
        self._crc = zlib.crc32(data, self._crc)


def _bytes(*records: McapRecord) -> bytes:
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    data: bytes = builder.end()  # type: ignore[no-untyped-call]
    return data
