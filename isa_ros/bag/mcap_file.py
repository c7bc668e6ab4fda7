"""
One MCAP file under construction, a whole chunk at a time.

The records are those of the official ``mcap`` library, except the two that come by the
million: its ``Writer`` makes an object and ten small packs of each message and two packs of
each index entry. Here a tick costs one pack and an index is an array.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
import io
from itertools import accumulate
from pathlib import Path
import struct
from typing import NamedTuple
import zlib

import lz4.frame  # type: ignore[import-untyped]
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Attachment, AttachmentIndex, Channel, Chunk, ChunkIndex, DataEnd
from mcap.records import Footer, Header, McapRecord, Metadata, MetadataIndex, Schema
from mcap.records import Statistics, SummaryOffset
from mcap.writer import MCAP0_MAGIC
import numpy as np
from numpy.typing import NDArray
import zstandard

Entries = NDArray[np.uint64]
"""Where the messages of one channel stand: rows of log time, ns, and offset in the chunk."""

MESSAGE_HEADER = struct.Struct('<BQHIQQ')
"""Opcode, length of what follows, channel, sequence, log time, publish time."""

_MESSAGE_HEAD = struct.Struct('<BQH')  # its first half, the same at every tick
_MESSAGE_TAIL = struct.Struct('<IQQ')  # its second half, the same for all messages of a tick
_MESSAGE = int(Opcode.MESSAGE)  # packing the enum itself takes three times as long
_LENGTH_EXCESS = MESSAGE_HEADER.size - 9  # of a message record, over its data
_INDEX_HEADER = struct.Struct('<BQHI')  # opcode, length, channel, bytes of entries
_INDEX_EXCESS = _INDEX_HEADER.size - 9  # of a message index record, over its entries
_ENTRY_BYTES = 16  # of a message index: time, offset
_ZSTD_LEVEL = 1  # on a leg's bag higher ones take longer and save 2 %
_FOOTER_FIXED = struct.Struct('<BQQQ')  # opcode, length, summary and summary offset start


class _Layout:
    """Ticks of the same topics and sizes: one after the other they differ in little."""

    def __init__(self, topics: Sequence[int], sizes: Sequence[int]) -> None:
        self.heads = [
            _MESSAGE_HEAD.pack(_MESSAGE, size + _LENGTH_EXCESS, k + 1)
            for k, size in zip(topics, sizes)]
        self.channels = [k + 1 for k in topics]
        ends = list(accumulate(MESSAGE_HEADER.size + size for size in sizes))
        self.offsets = [0, *ends[:-1]]
        self.size = ends[-1] if ends else 0


class _Stretch(NamedTuple):
    """Ticks of one layout in a row: when they were, and where they stand in the chunk."""

    layout: _Layout
    times: list[int]
    starts: list[int]


class ChunkContent:
    """
    Messages of one chunk and where each stands in it.

    A tick is joined from what its layout has prepared; the indices are made when they are
    asked for, column by column.
    """

    def __init__(self, prefix: bytes) -> None:
        self._parts = [prefix]
        self._layouts: dict[tuple[tuple[int, ...], tuple[int, ...]], _Layout] = {}
        self._stretches: list[_Stretch] = []
        self.size = len(prefix)
        self.start_ns = self.end_ns = 0

    def add(self, t_ns: int, sequence: int, messages: Sequence[tuple[int, bytes]]) -> None:
        """Append the messages of one instant: (topic index, CDR bytes)."""
        if not messages:
            return
        topics, data = zip(*messages)
        key = topics, tuple(map(len, data))
        layout = self._layouts.get(key)
        if layout is None:
            layout = self._layouts[key] = _Layout(*key)
        if not self._stretches:
            self.start_ns = t_ns
        if not self._stretches or self._stretches[-1].layout is not layout:
            self._stretches.append(_Stretch(layout, [], []))
        _, times, starts = self._stretches[-1]
        times.append(t_ns)
        starts.append(self.size)
        self.end_ns = t_ns
        pieces: list[bytes] = [_MESSAGE_TAIL.pack(sequence, t_ns, t_ns)] * (3 * len(data))
        pieces[::3] = layout.heads
        pieces[2::3] = data
        self._parts.append(b''.join(pieces))  # now: many at once would halt a tick
        self.size += layout.size

    def data(self) -> bytes:
        """Return the content of the chunk."""
        return b''.join(self._parts)

    @property
    def is_empty(self) -> bool:
        """Return whether there is no message in it."""
        return not self._stretches

    def message_indices(self) -> list[tuple[int, Entries]]:
        """Return (channel id, entries (n, 2) of time and offset) of those with messages."""
        pieces: dict[int, list[Entries]] = {}
        for layout, times, starts in self._stretches:
            ticks = np.array((times, starts), np.uint64).T
            for channel, offset in zip(layout.channels, layout.offsets):
                pieces.setdefault(channel, []).append(ticks + np.array((0, offset), np.uint64))
        return [(channel, _in_order(pieces[channel])) for channel in sorted(pieces)]


def _in_order(pieces: Sequence[Entries]) -> Entries:
    if len(pieces) == 1:
        return pieces[0]
    entries = np.concatenate(pieces)
    return entries[np.argsort(entries[:, 1])]


@dataclass
class _Totals:
    """Statistics of the whole file."""

    start_ns: int = 0
    end_ns: int = 0
    chunks: int = 0


class McapFile:
    """
    Append-only MCAP file: what has been written is on disk and complete, record by record.

    ``compression`` of the chunks is none, lz4 or zstd. A write that fails leaves the file as
    it was before, so that it can still be read and finished. Every method that writes raises
    the system's OSError.
    """

    def __init__(self, path: Path, library: str, compression: str = 'none') -> None:
        self._compression = '' if compression == 'none' else compression
        self._compress = _COMPRESSORS[compression]
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

    @property
    def size(self) -> int:
        """Return the number of bytes written."""
        return self._position

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

    def new_chunk(self) -> ChunkContent:
        """Return an empty chunk; the first one starts with all schemas and channels."""
        registered = [] if self._chunks else [*self._schemas, *self._channels]
        return ChunkContent(_bytes(*registered))

    def add_chunk(self, content: ChunkContent) -> list[tuple[int, int]]:
        """Write a chunk and its message indices; return (channel id, messages) of each."""
        content_bytes = content.data()
        data = self._compress(content_bytes)
        chunk = _bytes(Chunk(
            message_start_time=content.start_ns, message_end_time=content.end_ns,
            uncompressed_size=len(content_bytes), uncompressed_crc=zlib.crc32(content_bytes),
            compression=self._compression, data=data))
        start, indices, offsets = self._position, b'', {}
        channels = content.message_indices()
        for channel, index in channels:
            offsets[channel] = start + len(chunk) + len(indices)
            size = len(index) * _ENTRY_BYTES
            indices += _INDEX_HEADER.pack(
                Opcode.MESSAGE_INDEX, size + _INDEX_EXCESS, channel, size)
            indices += index.astype('<u8').tobytes()
        self._append(chunk + indices)
        self._chunks.append(ChunkIndex(
            message_start_time=content.start_ns, message_end_time=content.end_ns,
            chunk_start_offset=start, chunk_length=len(chunk), message_index_offsets=offsets,
            message_index_length=len(indices), compression=self._compression,
            compressed_size=len(data), uncompressed_size=len(content_bytes)))
        counts = [(channel, len(index)) for channel, index in channels]
        self._count(content, counts)
        return counts

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
        """Close the file, finished or not, and forget what stands in it."""
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

    def _count(self, content: ChunkContent, counts: Sequence[tuple[int, int]]) -> None:
        if self._totals.chunks == 0:
            self._totals.start_ns = content.start_ns
        self._totals.end_ns = content.end_ns
        self._totals.chunks += 1
        for channel, count in counts:
            self._counts[channel - 1] += count

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


def _compressed_by_lz4(data: bytes) -> bytes:
    compressed: bytes = lz4.frame.compress(data)
    return compressed


_COMPRESSORS: dict[str, Callable[[bytes], bytes]] = {
    'none': lambda data: data,
    'lz4': _compressed_by_lz4,
    'zstd': lambda data: zstandard.ZstdCompressor(level=_ZSTD_LEVEL).compress(data),
}


def _bytes(*records: McapRecord) -> bytes:
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    data: bytes = builder.end()  # type: ignore[no-untyped-call]
    return data
