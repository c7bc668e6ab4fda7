"""
Complete a bag that was cut short by a killed recorder, so that every reader opens it.

Complete chunks are copied as they are; the index of the last one, the summary and metadata.yaml
are written anew. The result has the bytes that the recorder would have written, had the run ended
there. What is damaged is refused and not repaired.
"""

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
import shutil
from typing import NamedTuple
import zlib

from isa_ros.bag.mcap_file import McapFile, StoredChunk
from isa_ros.bag.message_chunk import Entries, MESSAGE_HEADER
from isa_ros.bag.metadata import Counts, FILE_NAME, metadata_yaml, NO_START, TopicEntry
from isa_ros.bag.part_reader import PartReader
from isa_ros.bag.part_writer import LIBRARY, NUMBER, PART, QOS, TYPE_HASH
from isa_ros.bag.provenance import RECORD
from isa_ros.bag.reader import Bag
from isa_ros.bag.records import chunk_content, chunk_records, FileRecord
from isa_ros.core.atomic_file import replace_file, sync_directory
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import BagError
from mcap.opcode import Opcode
from mcap.records import Attachment, Chunk, Metadata
import numpy as np

SUFFIX = '_recovered'
"""Of the name of the new directory, behind that of the bag."""


class Recovery(NamedTuple):
    """The result of a recovery."""

    directory: Path
    n_messages: int
    end_ns: int | None
    lost_bytes: int
    """Of an incomplete record behind the last message."""
    is_done: bool
    """False: the bag was whole, and nothing was written."""

    def __str__(self) -> str:
        """Return the lines for the user."""
        if not self.is_done:
            return f'{self.directory} is whole: there is nothing to recover'
        end = 0 if self.end_ns is None else self.end_ns
        lost = f'; {self.lost_bytes} bytes of an incomplete record after it are lost'
        return (
            f'{self.directory}\n{self.n_messages} messages up to t = '
            f'{end / NS_PER_SECOND:.6f} s recovered{lost if self.lost_bytes else ""}')


class _BagFile(NamedTuple):
    """One file of the completed bag."""

    name: str
    number: int
    part: PartReader
    """The file that it is made from."""
    has_messages: bool = True
    """False: of ``part``, the first file, only the head is used."""


def recover(path: Path, out: Path | None = None, in_place: bool = False) -> Recovery:
    """
    Complete the bag at ``path`` in the new directory ``out``, by default beside it.

    With ``in_place`` its incomplete file and metadata.yaml are replaced instead, each at once
    when it is complete on the disk.

    Raises
    ------
    BagError
        The bag is damaged, is not of this package, or has no complete chunk; the directory
        already exists.

    """
    bag = Bag(path)
    _refuse_others(bag, path, in_place)
    files = list(_files(bag))
    metadata = _metadata(bag, files)
    if bag.is_whole and path.is_dir() and _has_text(path / FILE_NAME, metadata):
        return Recovery(path, bag.n_messages, bag.end_ns, 0, False)
    if in_place:
        directory = path
        for file in files:
            if not (file.has_messages and file.part.is_whole):
                _replace(directory / file.name, file)
    else:
        whole = path.resolve()
        directory = out or whole.with_name(
            (whole.name if path.is_dir() else whole.stem) + SUFFIX)
        _write(directory, files)
    replace_file(directory / FILE_NAME, metadata.encode(), is_durable=True)
    return Recovery(directory, bag.n_messages, bag.end_ns, bag.parts[-1].cut_bytes, True)


def _refuse_others(bag: Bag, path: Path, in_place: bool) -> None:
    """Refuse what cannot be recovered."""
    if not bag.has_provenance:
        raise BagError(f'{path}: was not recorded by isa_ros, or is cut short in its head')
    _ = bag.provenance_records  # refused if damaged; those of another version are copied too
    if bag.number is not None or (not path.is_dir() and bag.parts[0].continues):
        raise BagError(
            f'{path}: is file {bag.number or 0} of a split bag, recover its directory')
    if not path.is_dir() and in_place:
        raise BagError(f'{path}: is not a directory; --in-place completes a bag with its metadata')
    if not bag.is_whole and not bag.n_messages:
        raise BagError(f'{path}: has no complete chunk, so there is nothing to recover')


def _files(bag: Bag) -> Iterator[_BagFile]:
    """Yield the files of the completed bag; one without a chunk is made from the first."""
    first = bag.parts[0]
    for number, part in enumerate(bag.parts):
        if part.is_whole or part.n_messages:
            yield _BagFile(part.path.name, number, part)
        else:
            yield _BagFile(part.path.name, number, first, has_messages=False)
    if part.continues:  # the next file was not begun
        stem = part.path.stem.rpartition('_')[0]
        yield _BagFile(f'{stem}_{number + 1}.mcap', number + 1, first, has_messages=False)


def _metadata(bag: Bag, files: list[_BagFile]) -> str:
    """Return the text of metadata.yaml."""
    first = bag.parts[0]
    topics = [TopicEntry(
        channel.topic, first.types[channel.topic], channel.metadata.get(QOS, ''),
        channel.metadata.get(TYPE_HASH, '')) for channel in first.channels.values()]
    counts = []
    for file in files:
        found = Counter(m.topic for m in file.part.messages()) if file.has_messages else {}
        start, end = (file.part.start_ns, file.part.end_ns) if found else (None, None)
        counts.append((file.name, Counts(
            NO_START if start is None else start, NO_START if end is None else end,
            [found.get(topic.name, 0) for topic in topics])))
    return metadata_yaml(counts, topics, first.metadata[RECORD])


def _has_text(path: Path, text: str) -> bool:
    return path.is_file() and path.read_bytes() == text.encode()


def _write(directory: Path, files: list[_BagFile]) -> None:
    """Write all files to a new directory, or none."""
    try:
        directory.mkdir(parents=True)
    except FileExistsError:
        raise BagError(f'{directory} already exists; --out names another directory') from None
    try:
        for file in files:
            if file.has_messages and file.part.is_whole:
                shutil.copyfile(file.part.path, directory / file.name)
            else:
                _complete(file, directory / file.name)
    except OSError:
        for file in files:
            (directory / file.name).unlink(missing_ok=True)
        directory.rmdir()
        raise


def _replace(path: Path, file: _BagFile) -> None:
    """Replace a file at once when its new form is complete; it is unchanged after an error."""
    temporary = path.with_name(f'.{path.name}.tmp')
    temporary.unlink(missing_ok=True)
    try:
        _complete(file, temporary)
        temporary.replace(path)
    except OSError:
        temporary.unlink(missing_ok=True)
        raise
    sync_directory(path.parent)


def _complete(file: _BagFile, path: Path) -> None:
    """Write a file with the complete records of its part, an index and a summary."""
    written = McapFile(path, LIBRARY)
    try:
        _declare(file.part, written)
        for record in file.part.records():
            parsed = record.parsed if isinstance(record, FileRecord) else None
            if isinstance(parsed, Attachment):
                written.add_attachment(parsed.name, parsed.media_type, parsed.data)
            elif isinstance(parsed, Metadata):
                written.add_metadata(parsed.name, parsed.metadata)
                if parsed.name == RECORD and not file.has_messages:
                    written.add_metadata(PART, {NUMBER: str(file.number)})
            elif isinstance(parsed, Chunk) and file.has_messages:
                written.store(_stored(parsed, str(file.part.path)))
            elif isinstance(parsed, Chunk):
                break
        written.finish()
        written.sync()
    finally:
        written.close()


def _declare(part: PartReader, written: McapFile) -> None:
    """Register schemas and channels, which the summary repeats."""
    for schema in part.schemas.values():
        if written.add_schema(schema.name, schema.encoding, schema.data) != schema.id:
            raise BagError(f'{part.path}: schema {schema.id} is not numbered as by isa_ros')
    for number, channel in enumerate(part.channels.values(), start=1):
        if channel.id != number:
            raise BagError(f'{part.path}: channel {channel.id} is not numbered as by isa_ros')
        written.add_channel(channel.topic, channel.schema_id, channel.metadata)


def _stored(chunk: Chunk, where: str) -> StoredChunk:
    """Return a chunk with the index of its messages."""
    content = chunk_content(chunk, where)
    entries: dict[int, list[tuple[int, int]]] = {}
    for opcode, begin, _ in chunk_records(content, where):
        if opcode == Opcode.MESSAGE:
            _, _, channel, _, t_ns, _ = MESSAGE_HEADER.unpack_from(content, begin)
            entries.setdefault(channel, []).append((t_ns, begin))
    indices: list[tuple[int, Entries]] = [
        (channel, np.array(entries[channel], np.uint64)) for channel in sorted(entries)]
    return StoredChunk(
        chunk.message_start_time, chunk.message_end_time, chunk.uncompressed_size,
        zlib.crc32(content), chunk.compression, chunk.data, indices)
