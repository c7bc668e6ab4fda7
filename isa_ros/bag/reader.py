"""
Reader of a bag, of one file or several, whole or cut short by a killed recorder.

Opening reads everything once and checks every checksum and every message record, so that
iterating over an opened bag raises no error. A file that was cut short is read up to its last
complete chunk, which the writer ends with a whole tick. metadata.yaml is for other readers and
is not used here.
"""

from collections import Counter
from collections.abc import Container, Iterator
from operator import attrgetter
from pathlib import Path
import re
from typing import NamedTuple

from isa_ros.bag.message_table import MessageTable
from isa_ros.bag.metadata import has_custom
from isa_ros.bag.part_reader import BagMessage, PartReader
from isa_ros.bag.part_writer import ROSBAG2, SERIALIZED
from isa_ros.bag.provenance import Provenance, RECORD
from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.errors import BagError
import numpy as np

__all__ = ['Bag', 'BagMessage', 'Tick']

MAX_TICK_MESSAGES = 100_000
"""Messages of one instant; a tick of a run has one per topic."""

_NUMBERED = re.compile(r'(.*)_(0|[1-9][0-9]{0,5})\.mcap')


class Tick(NamedTuple):
    """All messages of one instant, sorted by topic."""

    t_ns: int
    sequence: int
    messages: tuple[BagMessage, ...]


class Bag:
    """
    One recorded run.

    ``path`` is a rosbag2 directory with NAME_0.mcap, NAME_1.mcap, ..., or with one MCAP file
    of any name, or the file itself. ``types`` are the message types by topic, ``type_hashes``
    those of their definitions ('': unknown), ``n_messages`` counts the messages; ``is_whole``
    is whether the recorder came to its end. ``start_ns`` and ``end_ns`` are None without
    messages. ``parts`` are its files.

    Raises
    ------
    BagError
        The path is not a bag, or the bag is damaged, or its files are of different runs; the
        message has the file, the offset and the error.

    """

    def __init__(self, path: Path) -> None:
        files = _mcap_files(path)
        self.parts = [PartReader(file) for file in files]
        first, last = self.parts[0], self.parts[-1]
        self.path = first.path if len(self.parts) == 1 else path
        _refuse_strangers(self.parts)
        filled = [part for part in self.parts if part.n_messages]
        self.types = dict(first.types)
        self.type_hashes = dict(first.type_hashes)
        self.counts = sum((part.counts for part in filled), Counter[str]())
        self.n_messages = self.counts.total()
        self.start_ns = filled[0].start_ns if filled else None
        self.end_ns = filled[-1].end_ns if filled else None
        self.is_whole = last.is_whole and not last.continues

    @property
    def has_provenance(self) -> bool:
        """Return whether the bag was recorded by this package."""
        return RECORD in self.parts[0].metadata

    @property
    def provenance(self) -> Provenance:
        """
        Return the provenance stored in the bag.

        Raises
        ------
        BagError
            The bag was not recorded by this package, or a part is missing or altered.

        """
        attachments, record = self.provenance_records
        return Provenance.of_records(attachments, record, str(self.path))

    @property
    def provenance_records(self) -> tuple[dict[str, bytes], dict[str, str]]:
        """Return attachments and key-value record as they are; raises as `provenance`."""
        first = self.parts[0]
        if not self.has_provenance:
            raise BagError(f'{self.path}: has no provenance (metadata record {RECORD})')
        attachments, record = dict(first.attachments), dict(first.metadata[RECORD])
        # Without an end a file has no checksum over this record, but a second copy of it.
        copy = first.metadata.get(ROSBAG2, {}).get(SERIALIZED, '')
        if not first.is_whole and not has_custom(copy, record):
            raise BagError(
                f'{self.path}: damaged, the records {RECORD} and {ROSBAG2} differ in provenance')
        return attachments, record

    @property
    def number(self) -> str | None:
        """Return the label of a single file of a split bag, None for a whole bag."""
        return self.parts[0].number

    def messages(self, topics: Container[str] | None = None) -> Iterator[BagMessage]:
        """Yield every message, or those of some topics, in order of time."""
        for part in self.parts:
            yield from part.messages(topics)

    def columns(self, topics: Container[str]) -> Iterator[tuple[str, MessageTable]]:
        """Yield the messages of some topics, chunk by chunk, those of a topic together."""
        for part in self.parts:
            own = {number: channel.topic for number, channel in part.channels.items()
                   if channel.topic in topics}
            for table in part.tables(topics):
                for number in np.unique(table.channels).tolist():
                    if number in own:
                        yield own[number], table.of(number)

    def place_of(self, message: BagMessage) -> str:
        """Return where a message of the bag is, for errors: its number, topic and tick."""
        number = next(k for k, own in enumerate(self.messages(), start=1) if own == message)
        return (
            f'{self.path}: message {number} of {self.n_messages}, {message.topic}, tick '
            f'{message.sequence} (t = {message.t_ns / NS_PER_SECOND:.6f} s)')

    def ticks(self) -> Iterator[Tick]:
        """Yield the messages of each instant together."""
        found: list[BagMessage] = []
        for message in self.messages():
            if found and message.t_ns != found[0].t_ns:
                yield _tick(found)
                found = []
            found.append(message)
            if len(found) > MAX_TICK_MESSAGES:
                raise BagError(
                    f'{self.path}: more than {MAX_TICK_MESSAGES} messages at t = '
                    f'{message.t_ns} ns')
        if found:
            yield _tick(found)


def _tick(messages: list[BagMessage]) -> Tick:
    messages = sorted(messages, key=attrgetter('topic'))
    return Tick(messages[0].t_ns, messages[0].sequence, tuple(messages))


def _mcap_files(path: Path) -> list[Path]:
    """Return the MCAP files of a bag directory in their order, or the file itself."""
    if not path.is_dir():
        if not path.is_file():
            raise BagError(f'{path}: no such bag')
        return [path]
    files = sorted(path.glob('*.mcap'))
    if len(files) == 1:
        return files
    names = ', '.join(file.name for file in files) or 'none'
    numbered = [_NUMBERED.fullmatch(file.name) for file in files]
    stems = {match[1] for match in numbered if match}
    if not files or not all(numbered) or len(stems) != 1:
        below = path / 'bag'
        hint = f'; did you mean {below}?' if not files and below.is_dir() else ''
        raise BagError(
            f'{path} holds {len(files)} MCAP files, must hold one, or NAME_0.mcap, NAME_1.mcap, '
            f'...: {names}{hint}')
    numbers = {int(match[2]): file for match, file in zip(numbered, files) if match}
    for number in range(len(files)):
        if number not in numbers:
            raise BagError(f'{path}: {stems.pop()}_{number}.mcap is missing among {names}')
    return [numbers[number] for number in range(len(files))]


def _refuse_strangers(parts: list[PartReader]) -> None:
    """Refuse files that are not the consecutive parts of one run."""
    first = parts[0]
    if len(parts) > 1 and first.number is not None:
        raise BagError(f'{first.path}: is labelled file {first.number!r} of a bag, not 0')
    for number, (before, part) in enumerate(zip(parts, parts[1:]), start=1):
        if not before.is_whole:
            raise BagError(f'{before.path}: is cut short, but {part.path.name} continues it')
        if not part.n_messages and not part.is_whole:
            continue  # cut short before its label
        if part.number not in (None, str(number)):
            raise BagError(f'{part.path}: is labelled file {part.number!r} of a bag, not {number}')
        if part.attachments != first.attachments or (
                part.metadata.get(RECORD) != first.metadata.get(RECORD)):
            raise BagError(f'{part.path}: belongs to another run than {first.path.name}')
        if part.types != first.types or part.type_hashes != first.type_hashes:
            raise BagError(f'{part.path}: has other topics or types than {first.path.name}')
        if part.start_ns is not None and before.end_ns is not None and (
                part.start_ns <= before.end_ns):
            raise BagError(
                f'{part.path}: begins at {part.start_ns} ns, before {before.path.name} ends '
                f'({before.end_ns} ns)')
