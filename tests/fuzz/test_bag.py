"""Altered bags are read as they were stored, or refused in one line."""

from collections.abc import Callable

from isa_ros.bag import part_reader, reader, records
from isa_ros.bag.part_reader import PartReader
from isa_ros.bag.records import chunk_content
from isa_ros.replay import topic_comparison
from isa_ros.replay.topic_comparison import TopicComparison
from mcap.records import Chunk
from msg_adapters import cdr_reader
import pytest
from tests.fuzz.bag_door import corpus, fuzz_chunks, fuzz_files, fuzz_messages, Stored
from tests.fuzz.property import Broken

CASES, MANY = 1500, 50_000
Plant = Callable[[pytest.MonkeyPatch], None]


@pytest.fixture(scope='module')
def stored(tmp_path_factory: pytest.TempPathFactory) -> list[Stored]:
    return corpus(tmp_path_factory.mktemp('corpus'))


def files(stored: list[Stored], cases: int, seed: int) -> int:
    return fuzz_files(stored, cases, seed)


def chunks(stored: list[Stored], cases: int, seed: int) -> int:
    return fuzz_chunks(stored[0], cases, seed)


def messages(stored: list[Stored], cases: int, seed: int) -> int:
    return fuzz_messages(cases, seed)


FUZZERS = pytest.mark.parametrize('fuzz', [files, chunks, messages])


@FUZZERS
def test_what_is_altered_is_read_as_stored_or_refused(
        fuzz: Callable[..., int], stored: list[Stored]) -> None:
    """Both occur: otherwise the cases are no test."""
    assert 0 < fuzz(stored, CASES, 1) < CASES


@pytest.mark.long
@FUZZERS
def test_every_one_of_many_cases_is_read_or_refused(
        fuzz: Callable[..., int], stored: list[Stored]) -> None:
    print(f'{fuzz.__name__}: {fuzz(stored, MANY, 1_000_000)} of {MANY} refused')


def without_checksums(patch: pytest.MonkeyPatch) -> None:
    """Trust the content of chunks."""
    def content(chunk: Chunk, where: str) -> bytes:
        chunk.uncompressed_crc = 0
        return chunk_content(chunk, where)

    patch.setattr(part_reader, 'chunk_content', content)


@pytest.mark.parametrize('fuzz, plant', [
    (files, without_checksums),
    (files, lambda patch: patch.setattr(part_reader, '_is_index_of', lambda *given: True)),
    (files, lambda patch: patch.setattr(reader, 'has_custom', lambda *given: True)),
    (files, lambda patch: patch.setattr(records, 'EndOfFile', ZeroDivisionError)),
    (chunks, lambda patch: patch.setattr(PartReader, '_register_topic', lambda *given: None)),
    (chunks, lambda patch: patch.setattr(part_reader, '_refuse_unless', lambda *given: None)),
    (messages, lambda patch: patch.setattr(cdr_reader._Decoder, '_fail', lambda *given: None)),
    (messages, lambda patch: patch.setattr(topic_comparison, 'CdrError', ZeroDivisionError)),
    (messages, lambda patch: patch.setattr(
        TopicComparison, '_compare_bytes', lambda *given: None)),
], ids=lambda value: getattr(value, '__name__', ''))
def test_a_guard_that_is_missing_is_found(
        fuzz: Callable[..., int], plant: Plant, stored: list[Stored],
        monkeypatch: pytest.MonkeyPatch) -> None:
    """The one of the provenance is found late; the others among the first 250 cases."""
    plant(monkeypatch)
    with pytest.raises(Broken):
        fuzz(stored, 10 * CASES, 1)
