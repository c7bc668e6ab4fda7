"""
The door of bags: damaged files, messages and chunks.

Damage of a file is found by its checksums, so that nothing but what was stored is read, up to the
end of a bag cut short. Chunks and messages with the right checksums may hold anything.
"""

from collections.abc import Iterator
import os
from pathlib import Path
import random
from typing import NamedTuple

from isa_ros.bag import part_writer, records
from isa_ros.bag.provenance import Provenance
from isa_ros.bag.reader import Bag, BagMessage
from isa_ros.bag.storage import Storage
from isa_ros.bag.writer import BagWriter
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.core.topic import Topic
from isa_ros.errors import IsaError
from isa_ros.replay.compare import Comparer
from isa_ros.replay.replay import recorded_events, recorded_inputs
from mcap.opcode import Opcode
from msg_adapters import event
import pytest
from tests.bag.golden import GOLDEN
from tests.bag.test_checksums import of, records as records_of
from tests.fuzz.bytes_of import altered
from tests.fuzz.property import refused

N_TICKS, CHUNK_TICKS = 8, 2
_OFTEN = 5
_HEAD_BYTES = 40    # of a record: kind, length, and the fields before the data of a chunk


class MemoryFile:
    """A file in memory with a path; creating one on a disk takes longer than a case."""

    def __init__(self) -> None:
        self._descriptor = os.memfd_create('bag')
        self.path = Path(f'/proc/self/fd/{self._descriptor}')

    def write(self, data: bytes) -> None:
        """Replace the content."""
        os.ftruncate(self._descriptor, 0)
        os.pwrite(self._descriptor, data, 0)

    def __enter__(self) -> 'MemoryFile':
        return self

    def __exit__(self, *error: object) -> None:
        os.close(self._descriptor)


class Stored(NamedTuple):
    """A bag of one file, and what was stored in it."""

    data: bytes
    places: list[int]
    """Offsets of its records, chunks several times."""
    messages: list[BagMessage]
    types: dict[str, str]
    provenance: Provenance


def corpus(directory: Path) -> list[Stored]:
    """Return bags of four chunks: plain and compressed, whole and cut in the last chunk."""
    found = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(part_writer, 'CHUNK_TICKS', CHUNK_TICKS)
        for codec in ('none', 'zstd', 'lz4'):
            path = _recorded(directory / codec, codec)
            found += [_stored(path, is_cut) for is_cut in (False, True)]
    return found


def _recorded(directory: Path, codec: str) -> Path:
    """Record the first ticks of a golden run, with events."""
    golden = Bag(GOLDEN / 'rotor_step')
    topics = [Topic(name, golden.types[name]) for name in sorted(golden.types)]
    index = {topic.name: k for k, topic in enumerate(topics)}
    with BagWriter(directory, topics, golden.provenance,
                   storage=Storage(compression=codec, split_mb=0.0)) as writer:
        for tick in golden.ticks():
            if tick.sequence < N_TICKS:
                writer.write_tick(tick.t_ns, tick.sequence, [
                    (index[m.topic], m.data) for m in tick.messages])
    return writer.path


def _stored(path: Path, is_cut: bool) -> Stored:
    data, bag = path.read_bytes(), Bag(path)
    chunks = of(data, Opcode.CHUNK)
    places = [record.start for record in (*records_of(data), *_OFTEN * chunks)]
    if is_cut:
        last = chunks[-1]
        data = data[:last.start + len(last.content) // 2]
    return Stored(data, [place for place in places if place < len(data)],
                  list(bag.messages()), bag.types, bag.provenance)


def _altered_at(data: bytes, places: list[int], dice: random.Random) -> bytes:
    """Return data altered anywhere, or at the head of a record."""
    if dice.random() < 0.5:
        return altered(data, dice)
    at = dice.choice(places)
    head = data[at:at + _HEAD_BYTES]
    if dice.random() < 0.5:
        return data[:at] + bytes([dice.randrange(256)]) + data[at + 1:]
    return data[:at] + altered(head, dice) + data[at + _HEAD_BYTES:]


def fuzz_files(stored: list[Stored], cases: int, seed: int) -> int:
    """Read altered files; return how many were refused."""
    n_refused = 0
    with MemoryFile() as file:
        for case in range(seed, seed + cases):
            dice = random.Random(case)
            own = dice.choice(stored)
            file.write(_altered_at(own.data, own.places, dice))
            n_refused += refused(lambda: _check_file(file.path, own), f'file {case}')
    return n_refused


def _check_file(path: Path, own: Stored) -> None:
    """Read a file, which must hold what was stored, up to some chunk."""
    bag = Bag(path)
    messages = list(bag.messages())
    assert messages == own.messages[:len(messages)], 'other messages'
    assert not bag.is_whole or messages == own.messages, 'is whole, but messages are missing'
    assert not messages or bag.types == own.types, 'other types'
    assert sum(len(tick.messages) for tick in bag.ticks()) == len(messages)
    assert not bag.has_provenance or bag.provenance == own.provenance, 'another provenance'


def fuzz_chunks(stored: Stored, cases: int, seed: int) -> int:
    """Read files whose only chunk has altered content and the right checksum."""
    first = of(stored.data, Opcode.CHUNK)[0]
    chunk = records.parse_record(Opcode.CHUNK, first.content, 'corpus')
    places = [begin for _, begin, _ in records.chunk_records(chunk.data, 'corpus')]
    n_refused = 0
    with MemoryFile() as file:
        for case in range(seed, seed + cases):
            content = _altered_at(chunk.data, places, random.Random(case))
            size = len(content).to_bytes(8, 'little')
            record = first.content[:16] + size + bytes(8) + size + content
            file.write(stored.data[:first.start] + bytes([Opcode.CHUNK])
                       + len(record).to_bytes(8, 'little') + record)
            n_refused += refused(lambda: _check_chunk(file.path, stored), f'chunk {case}')
    return n_refused


def _check_chunk(path: Path, own: Stored) -> None:
    """Read a file in both ways."""
    bag = Bag(path)
    messages = list(bag.messages())
    assert len(messages) == bag.n_messages == sum(len(tick.messages) for tick in bag.ticks())
    assert {message.topic for message in messages} <= set(bag.types)
    assert all(topic.isprintable() for topic in bag.types), 'topics that are no names'
    assert bag.provenance == own.provenance


class OneMessage(Bag):
    """A bag of one message, in memory."""

    def __init__(self, path: Path, types: dict[str, str], message: BagMessage) -> None:
        self.path, self.types, self.n_messages = path, types, 1
        self._message = message

    def messages(self) -> Iterator[BagMessage]:
        """Yield it."""
        yield self._message


def fuzz_messages(cases: int, seed: int) -> int:
    """Take altered messages as inputs of a replay, and compare them with the true ones."""
    golden = Bag(GOLDEN / 'rotor_step')
    run, topics = run_of_text(golden.provenance.configuration), sorted(golden.types)
    originals = [m for m in golden.messages() if m.sequence < N_TICKS]
    originals.append(BagMessage(0, 0, event.TOPIC[0], event.pack(0, 'pause')))
    n_refused = 0
    for case in range(seed, seed + cases):
        dice = random.Random(case)
        original = dice.choice(originals)
        bag = OneMessage(
            golden.path, golden.types, original._replace(data=altered(original.data, dice)))
        n_refused += refused(
            lambda: _check_message(bag, original, run, topics), f'message {case}')
    return n_refused


def _check_message(
        bag: OneMessage, original: BagMessage, run: RunConfig, topics: list[str]) -> None:
    """Read one message; it must be equal to the byte, or be noticed, or be located."""
    message = next(bag.messages())
    try:
        recorded_inputs(bag, run)
        recorded_events(bag)
        comparer = Comparer(bag, topics, is_exact=True)
        comparer.write_tick(message.t_ns, message.sequence, [
            (topics.index(message.topic), original.data)])
        is_equal = comparer.finish().is_equal
    except IsaError as error:
        assert str(error).startswith(
            f'{bag.path}: message 1 of 1, {message.topic}, tick {message.sequence} '), str(error)
        raise
    assert is_equal == (message.data == original.data), 'a difference is not noticed'
