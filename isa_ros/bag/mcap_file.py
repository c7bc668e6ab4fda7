"""
Writer of one MCAP file, chunk by chunk.

The records are those of the official ``mcap`` library, except the two kinds that are written by
the million: messages (`isa_ros.bag.message_chunk`) and the entries of their index, an array.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
import errno
import io
import os
from pathlib import Path
import struct
from typing import NamedTuple
import zlib

from isa_ros.bag.checksum import joined
from isa_ros.bag.message_chunk import Buffers, Chunk, Entries, Layouts
import lz4.frame  # type: ignore[import-untyped]
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment, AttachmentIndex, Channel, Chunk as ChunkRecord, ChunkIndex, DataEnd, Footer,
    Header, McapRecord, Metadata, MetadataIndex, Schema, Statistics, SummaryOffset)
from mcap.writer import MCAP0_MAGIC
import zstandard

_INDEX_HEADER = struct.Struct('<BQHI')  # opcode, length, channel, bytes of entries
_INDEX_EXCESS = _INDEX_HEADER.size - 9  # length field of an index record minus that of its entries
_ENTRY_BYTES = 16  # of a message index: time, offset
_ZSTD_LEVEL = 1  # for a leg's bag higher levels take longer and save 2 %
_FOOTER_FIXED = struct.Struct('<BQQQ')  # opcode, length, summary and summary offset start
_LENGTH = struct.Struct('<Q')

Bytes = bytes | memoryview


class StoredChunk(NamedTuple):
    """A chunk as it is in a file."""

    start_ns: int
    end_ns: int
    size: int
    """Bytes of its content."""
    crc: int
    """Of its content."""
    compression: str
    """'' for none."""
    data: Bytes
    """Its content, compressed."""
    indices: Sequence[tuple[int, Entries]]
    """Channel and index of its messages, sorted by channel."""


@dataclass
class _Totals:
    """Statistics of the whole file."""

    start_ns: int = 0
    end_ns: int = 0
    chunks: int = 0


class McapFile:
    """
    Append-only MCAP file: every written record is complete on disk.

    ``compression`` of the chunks is none, lz4 or zstd; ``buffers`` are the memory that they are
    filled in. A failed write leaves the file as it was before, so that it can still be read and
    finished. Every method that writes, and `check`, raises an OSError.
    """

    def __init__(
            self, path: Path, library: str, compression: str = 'none',
            buffers: Buffers | None = None) -> None:
        self._compression = '' if compression == 'none' else compression
        self._compress = _COMPRESSORS[compression]()
        self._path = path
        # Appending: after a truncation by others the file stays shorter than it must be.
        self._file = io.FileIO(path, 'x', opener=_opened_to_append)
        self._end: os.stat_result | None = None
        self._position = 0
        self._crc = 0
        self._schemas: list[Schema] = []
        self._channels: list[Channel] = []
        self._attachments: list[AttachmentIndex] = []
        self._metadata: list[MetadataIndex] = []
        self._chunks: list[ChunkIndex] = []
        self._counts: list[int] = []
        self._totals = _Totals()
        self._layouts = Layouts()
        self._buffers = Buffers() if buffers is None else buffers
        self._has_chunk = False
        self._append(MCAP0_MAGIC + _bytes(Header(profile='ros2', library=library)))

    @property
    def size(self) -> int:
        """Return the number of bytes written."""
        return self._position

    def check(self) -> None:
        """
        Check that the path still leads to this file, and that it holds all that was written.

        A file that was removed, moved, replaced or truncated can still be written without an
        error, but not be read again.
        """
        own = self._end or os.fstat(self._file.fileno())
        try:
            there = os.stat(self._path)
        except (FileNotFoundError, NotADirectoryError):
            raise self._loss('the file was removed or moved during the run') from None
        if not os.path.samestat(own, there):
            raise self._loss('another file took its place during the run')
        if there.st_size != self._position:
            raise self._loss(
                f'the file has {there.st_size} bytes instead of the {self._position} written: '
                'it was changed during the run')

    def sync(self) -> None:
        """Wait until the disk has everything written."""
        os.fsync(self._file.fileno())

    def _loss(self, what: str) -> OSError:
        return OSError(errno.ESTALE, what, str(self._path))

    def add_schema(self, name: str, encoding: str, data: bytes) -> int:
        """Register a schema; it is written to the first chunk and the summary."""
        self._schemas.append(Schema(
            id=len(self._schemas) + 1, name=name, encoding=encoding, data=data))
        return len(self._schemas)

    def add_channel(self, topic: str, schema: int, metadata: Mapping[str, str]) -> None:
        """Register the channel of the next topic index."""
        self._channels.append(Channel(
            id=len(self._channels) + 1, schema_id=schema, topic=topic, message_encoding='cdr',
            metadata=dict(metadata)))
        self._counts.append(0)

    def add_attachment(self, name: str, media_type: str, data: bytes) -> None:
        """Write an attachment; its times are 0, the start of simulation time."""
        record = _bytes(Attachment(
            log_time=0, create_time=0, name=name, media_type=media_type, data=data))
        self._append(record)
        self._attachments.append(AttachmentIndex(
            offset=self._position - len(record), length=len(record), log_time=0,
            create_time=0, data_size=len(data), name=name, media_type=media_type))

    def add_metadata(self, name: str, metadata: Mapping[str, str]) -> None:
        """Write a key-value record."""
        record = _bytes(Metadata(name=name, metadata=dict(metadata)))
        self._append(record)
        self._metadata.append(MetadataIndex(
            offset=self._position - len(record), length=len(record), name=name))

    def new_chunk(self) -> Chunk:
        """
        Return an empty chunk; the first one starts with all schemas and channels.

        Two may be in use at a time: one is filled while the other is written.
        """
        registered = [] if self._has_chunk else [*self._schemas, *self._channels]
        self._has_chunk = True
        return Chunk(_bytes(*registered), self._layouts, self._buffers.take())

    def add_chunk(self, content: Chunk) -> list[tuple[int, int]]:
        """Write a chunk and its message indices; return (channel id, messages) of each."""
        content_bytes = content.data()
        indices = content.message_indices()
        self.store(StoredChunk(
            content.start_ns, content.end_ns, content.size, zlib.crc32(content_bytes),
            self._compression, self._compress(content_bytes), indices))
        self._buffers.give(content.buffer)
        return [(channel, len(index)) for channel, index in indices]

    def store(self, chunk: StoredChunk) -> None:
        """Write a chunk that is compressed already, and its message indices."""
        head = _bytes(ChunkRecord(
            message_start_time=chunk.start_ns, message_end_time=chunk.end_ns,
            uncompressed_size=chunk.size, uncompressed_crc=chunk.crc,
            compression=chunk.compression, data=b''))
        # The library's record without its data, to avoid copying them.
        length = len(head) + len(chunk.data)
        head = head[:1] + _LENGTH.pack(length - 9) + head[9:-8] + _LENGTH.pack(len(chunk.data))
        start, indices, offsets = self._position, b'', {}
        for channel, index in chunk.indices:
            offsets[channel] = start + length + len(indices)
            size = len(index) * _ENTRY_BYTES
            indices += _INDEX_HEADER.pack(
                Opcode.MESSAGE_INDEX, size + _INDEX_EXCESS, channel, size)
            indices += index.astype('<u8').tobytes()
        self._write(head, chunk.data, indices)
        self._crc = zlib.crc32(head, self._crc)
        self._crc = (zlib.crc32(chunk.data, self._crc) if chunk.compression
                     else joined(self._crc, chunk.crc, chunk.size))
        self._crc = zlib.crc32(indices, self._crc)
        self._chunks.append(ChunkIndex(
            message_start_time=chunk.start_ns, message_end_time=chunk.end_ns,
            chunk_start_offset=start, chunk_length=length, message_index_offsets=offsets,
            message_index_length=len(indices), compression=chunk.compression,
            compressed_size=len(chunk.data), uncompressed_size=chunk.size))
        self._count(chunk)

    def finish(self) -> None:
        """Write the end of the data, the summary and the footer, all or nothing."""
        data_end = _bytes(DataEnd(data_section_crc=self._crc))
        start, summary, offsets = self._position + len(data_end), b'', []
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
        self._append(data_end + summary + _bytes(footer) + MCAP0_MAGIC)

    def close(self) -> None:
        """Close the file, finished or not, and release its memory."""
        if not self._file.closed:
            self._end = os.fstat(self._file.fileno())
        self._file.close()
        for records in (self._schemas, self._channels, self._chunks):
            records.clear()

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

    def _count(self, chunk: StoredChunk) -> None:
        if self._totals.chunks == 0:
            self._totals.start_ns = chunk.start_ns
        self._totals.end_ns = chunk.end_ns
        self._totals.chunks += 1
        for channel, index in chunk.indices:
            self._counts[channel - 1] += len(index)

    def _append(self, data: bytes) -> None:
        """Write all of it or nothing."""
        self._write(data)
        self._crc = zlib.crc32(data, self._crc)

    def _write(self, *parts: Bytes) -> None:
        """Write all parts or nothing, at once; the caller updates the checksum."""
        rest = [memoryview(part) for part in parts if part]
        written = 0
        try:
            while rest:
                n = os.writev(self._file.fileno(), rest)
                written += n
                while rest and n >= len(rest[0]):
                    n -= len(rest.pop(0))
                if n:
                    rest[0] = rest[0][n:]
        except OSError:
            self._file.truncate(self._position)
            raise
        self._position += written


def _opened_to_append(path: str, flags: int) -> int:
    return os.open(path, flags | os.O_APPEND, 0o666)


def _lz4() -> Callable[[Bytes], bytes]:
    compress: Callable[[Bytes], bytes] = lz4.frame.compress
    return compress


_COMPRESSORS: dict[str, Callable[[], Callable[[Bytes], Bytes]]] = {
    'none': lambda: lambda data: data,
    'lz4': _lz4,
    'zstd': lambda: zstandard.ZstdCompressor(level=_ZSTD_LEVEL).compress,
}
"""Makers of what compresses one chunk after another."""


def _bytes(*records: McapRecord) -> bytes:
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    data: bytes = builder.end()  # type: ignore[no-untyped-call]
    return data
