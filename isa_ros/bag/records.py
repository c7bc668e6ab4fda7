"""
Records of an MCAP file, in file order, each checked before it is used.

If the file ends within a record, the recorder was killed there. Any other error is damage: an
unknown record, a wrong checksum, a length beyond the end of a file that has its closing magic,
or a length above the limits of a bag.
"""

from collections.abc import Iterator
import io
import os
import struct
from typing import Any, BinaryIO, NamedTuple
import zlib

from isa_ros.errors import BagError
import lz4.frame  # type: ignore[import-untyped]
from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile
from mcap.opcode import Opcode
from mcap.records import (
    Attachment, Channel, Chunk, DataEnd, Footer, Header, McapRecord, Metadata, Schema)
from mcap.writer import MCAP0_MAGIC
import zstandard

MAX_RECORD_BYTES = 256 * 1024 * 1024
"""Largest record, and largest content of a chunk, that is read."""

MAX_EXPANSION = 1000
"""Bytes a chunk of more than `FREE_BYTES` may hold for each of its compressed ones."""
FREE_BYTES = 64 * 1024

FREE_RECORDS = 10_000
"""Records that a chunk may have in any case; above, one for each compressed byte: a message has a
time and a number of its own, which take more."""

_HEAD_BYTES = 9  # opcode, length
_FOOTER_CRC_BYTES = 4
_PARSED: dict[int, Any] = {
    Opcode.CHANNEL: Channel, Opcode.DATA_END: DataEnd, Opcode.FOOTER: Footer,
    Opcode.HEADER: Header, Opcode.METADATA: Metadata, Opcode.SCHEMA: Schema,
    Opcode.ATTACHMENT: Attachment, Opcode.CHUNK: Chunk,
}
_OF_SUMMARY = (Opcode.CHUNK_INDEX, Opcode.ATTACHMENT_INDEX, Opcode.METADATA_INDEX,
               Opcode.STATISTICS, Opcode.SUMMARY_OFFSET)
_PRIVATE = 0x80  # opcodes from here on are private to writers and are skipped


class FileRecord(NamedTuple):
    """One record: its offset, its opcode, its parsed form if that is needed, its bytes."""

    offset: int
    opcode: int
    parsed: McapRecord | None
    content: bytes


class FileEnd(NamedTuple):
    """The end of a file: whole, or cut short at an offset."""

    is_whole: bool
    offset: int
    rest: int
    """Bytes behind the offset, which are of an incomplete record."""


def read_records(file: BinaryIO, where: str) -> Iterator[FileRecord | FileEnd]:
    """
    Yield every complete record, then the `FileEnd`.

    Raises
    ------
    BagError
        The file is not an MCAP file, or damaged; the message has the offset and the error.

    """
    reader = _Reader(file, where)
    reader.check_magic()
    while True:
        record = reader.next_record()
        yield record
        if isinstance(record, FileEnd):
            return
        if record.opcode == Opcode.FOOTER:
            yield reader.closing()
            return


def chunk_content(chunk: Chunk, where: str) -> bytes:
    """
    Return the uncompressed content of a chunk.

    Raises
    ------
    BagError
        Unknown compression, a size other than the declared one, or a wrong CRC.

    """
    limit = chunk.uncompressed_size
    if limit > MAX_RECORD_BYTES:
        raise BagError(f'{where}: {limit} bytes in a chunk, must be <= {MAX_RECORD_BYTES}')
    if limit > max(FREE_BYTES, MAX_EXPANSION * len(chunk.data)):
        raise BagError(
            f'{where}: {limit} bytes in a chunk of {len(chunk.data)} compressed ones, must be '
            f'<= {MAX_EXPANSION} times as many')
    try:
        if chunk.compression == 'zstd':
            stream = zstandard.ZstdDecompressor().stream_reader(chunk.data)
            data = stream.read(limit + 1)
        elif chunk.compression == 'lz4':
            data = lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, limit + 1)
        elif chunk.compression == '':
            data = chunk.data
        else:
            raise BagError(f'{where}: compression {chunk.compression!r}, must be zstd or lz4')
    except (zstandard.ZstdError, RuntimeError) as error:
        raise BagError(f'{where}: a chunk that cannot be decompressed ({error})') from None
    if len(data) != limit:
        raise BagError(f'{where}: {len(data)} bytes in a chunk, must be the declared {limit}')
    if chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc:
        raise BagError(f'{where}: CRC of a chunk is wrong, its data are damaged')
    return data


def chunk_records(data: bytes, where: str) -> Iterator[tuple[int, int, int]]:
    """
    Yield opcode, begin and end of each record in the content of a chunk.

    Raises
    ------
    BagError
        A record reaches beyond the end, or is of no kind.

    """
    end = 0
    while end < len(data):
        begin, end = end, end + _HEAD_BYTES
        end += int.from_bytes(data[begin + 1:end], 'little')
        if end > len(data):
            raise BagError(f'{where}: a record reaches beyond its chunk')
        if data[begin] == 0:
            raise BagError(f'{where}: unknown record 0x00 in a chunk')
        yield data[begin], begin, end


def parse_record(opcode: int, content: bytes, where: str) -> McapRecord | None:
    """
    Return the parsed form of a record, None for one that is not needed.

    Raises
    ------
    BagError
        The content does not match the opcode.

    """
    cls = _PARSED.get(opcode)
    if cls is None:
        return None
    try:
        parsed: McapRecord = cls.read(ReadDataStream(io.BytesIO(content)))
    except (EndOfFile, ValueError, OverflowError, struct.error) as error:
        raise BagError(f'{where}: malformed {cls.__name__} record ({error})') from None
    return parsed


def record_at(file: BinaryIO, offset: int, where: str) -> McapRecord | None:
    """
    Return the parsed form of the record at an offset, None for one that is not needed.

    Raises
    ------
    BagError
        The file ends before it does, or it is malformed.

    """
    file.seek(offset)
    head = file.read(_HEAD_BYTES)
    length = int.from_bytes(head[1:], 'little')
    if len(head) < _HEAD_BYTES or length > MAX_RECORD_BYTES:
        raise BagError(f'{where}: is not the record that it was')
    return parse_record(head[0], file.read(length), where)


class _Reader:
    """Position in one file, and the running checksum of the bytes read."""

    def __init__(self, file: BinaryIO, where: str) -> None:
        self._file = file
        self._where = where
        self._size = file.seek(0, os.SEEK_END)
        file.seek(max(self._size - len(MCAP0_MAGIC), len(MCAP0_MAGIC)))  # not the opening magic
        self._is_closed = file.read() == MCAP0_MAGIC
        file.seek(0)
        self._position = 0
        self._crc = 0  # of the data section, from the start of the file
        self._summary_crc: int | None = None

    def check_magic(self) -> None:
        """Refuse a file that does not begin with the MCAP magic, or with a part of it."""
        if not MCAP0_MAGIC.startswith(self._read(len(MCAP0_MAGIC))):
            raise BagError(f'{self._where}: is not an MCAP file (wrong opening magic)')

    def next_record(self) -> FileRecord | FileEnd:
        """Return the next complete record, or the end of a file that was cut short."""
        offset = self._position
        head = self._file.read(_HEAD_BYTES)
        if len(head) < _HEAD_BYTES:
            return self._cut(offset)
        opcode, length = head[0], int.from_bytes(head[1:], 'little')
        if opcode == 0 or max(Opcode) < opcode < _PRIVATE:
            raise self._damage(offset, f'unknown record {opcode:#04x}')
        if opcode in _OF_SUMMARY and self._summary_crc is None:
            raise self._damage(offset, f'record {opcode:#04x} of a summary among the data')
        if length > MAX_RECORD_BYTES:
            raise self._damage(
                offset, f'a record of {length} bytes, must be <= {MAX_RECORD_BYTES}')
        if offset + _HEAD_BYTES + length > self._size:
            return self._cut(offset)
        self._file.seek(offset)
        before = self._crc
        content = self._read(_HEAD_BYTES + length)[_HEAD_BYTES:]
        parsed = self._parse(opcode, content, offset)
        if isinstance(parsed, DataEnd):
            self._check(offset, 'the data section', parsed.data_section_crc, before)
            self._summary_crc = 0
        if isinstance(parsed, Footer):
            if self._summary_crc is None:
                raise self._damage(offset, 'a footer before the end of the data section')
            self._check(offset, 'the summary', parsed.summary_crc, self._summary_crc)
        return FileRecord(offset, opcode, parsed, content)

    def closing(self) -> FileEnd:
        """Return the end of the file after the footer."""
        offset = self._position
        magic = self._file.read(len(MCAP0_MAGIC) + 1)
        if magic == MCAP0_MAGIC:
            return FileEnd(True, offset, 0)
        if MCAP0_MAGIC.startswith(magic):
            return FileEnd(False, offset, len(magic))
        raise self._damage(offset, 'the closing magic is missing')

    def _read(self, size: int) -> bytes:
        """Read and update the running checksums, without the footer's own CRC."""
        data = self._file.read(size)
        self._position += len(data)
        if self._summary_crc is None:
            self._crc = zlib.crc32(data, self._crc)
        else:
            is_footer = data[:1] == bytes([Opcode.FOOTER])
            covered = data[:-_FOOTER_CRC_BYTES] if is_footer else data
            self._summary_crc = zlib.crc32(covered, self._summary_crc)
        return data

    def _parse(self, opcode: int, content: bytes, offset: int) -> McapRecord | None:
        parsed = parse_record(opcode, content, f'{self._where}: damaged at byte {offset}')
        if isinstance(parsed, Attachment):
            crc = int.from_bytes(content[-4:], 'little')
            self._check(offset, f'attachment {parsed.name}', crc, zlib.crc32(content[:-4]))
        return parsed

    def _check(self, offset: int, what: str, expected: int, actual: int) -> None:
        if expected not in (0, actual):  # 0: not written
            raise self._damage(offset, f'CRC of {what} is {actual:#010x}, not {expected:#010x}')

    def _cut(self, offset: int) -> FileEnd:
        if self._is_closed:
            raise self._damage(offset, 'a record reaches beyond the end of the file')
        return FileEnd(False, offset, self._size - offset)

    def _damage(self, offset: int, what: str) -> BagError:
        return BagError(f'{self._where}: damaged at byte {offset}: {what}')
