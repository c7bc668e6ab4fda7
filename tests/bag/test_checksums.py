"""
The checksums of an MCAP file are there: 0 says "not calculated", and readers accept it.

The records are taken apart here by the format's own rules, opcode and length, so that a reader
that skips a checksum of 0 does not decide.
"""

from collections.abc import Callable
from pathlib import Path
import struct
from typing import NamedTuple
import zlib

from isa_ros.bag.storage import Storage
import lz4.frame
from mcap.opcode import Opcode
from mcap.writer import MCAP0_MAGIC
import pytest
from tests.bag.recorded import record
import zstandard

N = 1234  # ticks: two full chunks and a part
_HEAD = struct.Struct('<BQ')   # opcode, length
_CRC = struct.Struct('<I')
DECOMPRESSED: dict[str, Callable[[bytes], bytes]] = {
    '': bytes, 'lz4': lz4.frame.decompress,
    'zstd': lambda data: zstandard.ZstdDecompressor().decompress(data)}


class Record(NamedTuple):
    """One record of a file: its opcode, where it begins, and what follows its length."""

    opcode: int
    start: int
    content: bytes


@pytest.fixture(scope='module', params=['none', 'lz4', 'zstd'])
def path(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the file of a recorded bag."""
    return record(tmp_path_factory.mktemp('recorded') / 'rig', N,
                  storage=Storage(compression=request.param, split_mb=0.0))


def records(data: bytes) -> list[Record]:
    """Return the records between the magic bytes."""
    found, at = [], len(MCAP0_MAGIC)
    while at < len(data) - len(MCAP0_MAGIC):
        opcode, length = _HEAD.unpack_from(data, at)
        found.append(Record(opcode, at, data[at + _HEAD.size:at + _HEAD.size + length]))
        at += _HEAD.size + length
    return found


def of(data: bytes, opcode: Opcode) -> list[Record]:
    """Return the records of one kind."""
    return [one for one in records(data) if one.opcode == opcode]


def test_the_data_section_has_the_checksum_of_its_bytes(path: Path) -> None:
    """DataEnd: of everything in front of it, the magic bytes included."""
    data = path.read_bytes()
    end, = of(data, Opcode.DATA_END)
    told, = _CRC.unpack(end.content)
    assert told == zlib.crc32(data[:end.start]) != 0


def test_the_summary_has_the_checksum_of_its_bytes(path: Path) -> None:
    """Footer: of the summary and of the footer up to the checksum itself."""
    data = path.read_bytes()
    end, = of(data, Opcode.DATA_END)
    told, = _CRC.unpack_from(data, len(data) - len(MCAP0_MAGIC) - _CRC.size)
    summary = end.start + _HEAD.size + len(end.content)
    assert told == zlib.crc32(data[summary:-len(MCAP0_MAGIC) - _CRC.size]) != 0


def test_every_chunk_has_the_checksum_of_its_uncompressed_messages(path: Path) -> None:
    """Chunk: behind start, end and uncompressed size; name and length of what is compressed."""
    chunks = of(path.read_bytes(), Opcode.CHUNK)
    assert len(chunks) == 3
    for chunk in chunks:
        told, letters = struct.unpack_from('<II', chunk.content, 24)
        name = chunk.content[32:32 + letters].decode()
        messages = DECOMPRESSED[name](chunk.content[32 + letters + 8:])
        assert told == zlib.crc32(messages) != 0


def test_every_attachment_has_the_checksum_of_its_content(path: Path) -> None:
    """Attachment: the last four bytes, of all before them."""
    attachments = of(path.read_bytes(), Opcode.ATTACHMENT)
    assert len(attachments) == 2
    for one in attachments:
        told, = _CRC.unpack(one.content[-_CRC.size:])
        assert told == zlib.crc32(one.content[:-_CRC.size]) != 0
