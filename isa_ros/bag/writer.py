"""
The recorder: a rosbag2 directory that can be read at any moment of the run.

Provenance and metadata.yaml are written before the first message. A chunk ends with a whole
tick, holds at most half a simulated second, and is written by a thread while the next one is
filled: a killed run loses less than a simulated second, and what is left ends with a whole tick.
With a size to split at, the tick after the chunk that reaches it begins the next file.

Nothing is taken from the host: the same run gives the same bytes. Compressed ones depend on
the libraries' versions besides, zstd's or lz4's; what is in them does not.
"""

from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
import time
from types import TracebackType

from isa_ros.bag.message_chunk import Chunk
from isa_ros.bag.metadata import FILE_NAME, metadata_yaml
from isa_ros.bag.part_writer import Head, PartWriter
from isa_ros.bag.provenance import Provenance
from isa_ros.config.recording import PLAIN, Storage
from isa_ros.core.topic import Topic
from isa_ros.errors import BagError, RunError
from msg_adapters.definitions import definition


METADATA_PERIOD_S = 1.0
"""Host time between two writings of metadata.yaml: readers need it at the end alone."""


class BagWriter:
    """
    One bag under construction.

    ``topics`` are sorted by name; a topic's place in them is its index. The directory must
    not exist, unless it is to be overwritten and holds a bag: then that bag is removed, and
    nothing else. ``path`` is the first file.

    Raises
    ------
    BagError
        the directory exists or cannot be made, or topics are not sorted.
    RunError
        the bag cannot be written, naming the file.

    """

    def __init__(
            self, directory: Path, topics: Sequence[Topic], provenance: Provenance,
            overwrite: bool = False, storage: Storage = PLAIN) -> None:
        _check_sorted(topics)
        definitions = {topic.type_name: definition(topic.type_name) for topic in topics}
        self._head = Head(
            provenance.attachments(), provenance.record(),
            [(topic, definitions[topic.type_name].type_hash) for topic in topics],
            {name: text for name, (text, _) in definitions.items()})
        self._storage = storage
        self._metadata_path = directory / FILE_NAME
        self._stem = directory.resolve().name
        self.path = self._path(0)
        _make_directory(directory, overwrite)
        self._parts: list[PartWriter] = []
        self._is_full = False
        self._is_closed = False
        self._error: RunError | None = None
        self._thread = ThreadPoolExecutor(1, 'recorder')
        self._writing: Future[None] | None = None
        self._metadata_due = 0.0
        try:
            self._begin_part()
        except OSError as error:
            raise self._failure(error, self.path) from error

    def write_tick(
            self, t_ns: int, sequence: int, messages: Sequence[tuple[int, bytes]]) -> None:
        """
        Record the messages of one tick: (topic index, CDR bytes), sorted by index, maybe none.

        ``t_ns`` is log and publish time, ``sequence`` the tick's number.

        Raises
        ------
        RunError
            the bag cannot be written; what it held stays readable.

        """
        if self._error is not None:
            raise self._error
        try:
            if self._is_full and messages:
                self._begin_part()
            chunk = self._parts[-1].write_tick(t_ns, sequence, messages)
            if chunk is not None:
                self._end_writing()
                self._writing = self._thread.submit(self._write, self._parts[-1], chunk)
                if self._storage.split_bytes is not None:  # its size decides on the next tick
                    self._end_writing()
        except OSError as error:
            raise self._failure(error, self._path(len(self._parts) - 1)) from error

    def close(self) -> None:
        """
        Write what is pending, the summary and metadata.yaml; a second call does nothing.

        Raises
        ------
        RunError
            the bag cannot be written; it stays readable like one cut short.

        """
        if self._is_closed:
            return
        self._is_closed = True
        part = self._parts[-1]
        try:
            self._end_writing()
            part.finish(is_last=True)
            self._write_metadata()
        except OSError as error:
            raise self._failure(error, part.path) from error
        finally:
            self._thread.shutdown()
            part.close()

    def _end_writing(self) -> None:
        """Wait for the chunk that is being written, if there is one; raise its error."""
        writing, self._writing = self._writing, None
        if writing is not None:
            writing.result()

    def _write(self, part: PartWriter, chunk: Chunk) -> None:
        """Write a chunk, and from time to time what the bag holds so far; in the thread."""
        part.write_chunk(chunk)
        split = self._storage.split_bytes
        self._is_full = split is not None and part.size >= split
        now = time.monotonic()
        if now >= self._metadata_due:
            self._metadata_due = now + METADATA_PERIOD_S
            self._write_metadata()

    def __enter__(self) -> 'BagWriter':
        return self

    def __exit__(
            self, kind: type[BaseException] | None, error: BaseException | None,
            traceback: TracebackType | None) -> None:
        """Close; an error of the run is not replaced by one of closing."""
        try:
            self.close()
        except RunError:
            if error is None:
                raise

    def _begin_part(self) -> None:
        """End the file that is full, if there is one, and begin the next."""
        if self._parts:
            self._end_writing()
            self._parts[-1].finish(is_last=False)
            self._parts[-1].close()
        number = len(self._parts)
        self._parts.append(PartWriter(
            self._path(number), number, self._head, self._storage.compression))
        self._is_full = False
        self._write_metadata()

    def _path(self, number: int) -> Path:
        return self._metadata_path.with_name(f'{self._stem}_{number}.mcap')

    def _write_metadata(self) -> None:
        """Replace metadata.yaml in one step."""
        text = metadata_yaml(
            [(part.path.name, part.counts) for part in self._parts], self._head.topics,
            self._head.custom)
        temporary = self._metadata_path.with_suffix('.yaml.tmp')
        temporary.unlink(missing_ok=True)  # never written through a link that lay there
        with temporary.open('x', encoding='utf-8') as file:
            file.write(text)
        temporary.replace(self._metadata_path)

    def _failure(self, error: OSError, path: Path) -> RunError:
        self._error = RunError(
            f'{error.filename or path}: cannot record, {error.strerror or error}')
        return self._error


def _check_sorted(topics: Sequence[Topic]) -> None:
    names = [topic.name for topic in topics]
    if names != sorted(set(names)):
        raise BagError(f'topics must be sorted by name, each once: {", ".join(names)}')


def _make_directory(directory: Path, overwrite: bool) -> None:
    try:
        if overwrite and directory.exists():
            _remove_bag(directory)
        directory.mkdir(parents=True, exist_ok=overwrite)
    except FileExistsError:
        raise BagError(f'{directory} exists, must not, unless asked to overwrite') from None
    except OSError as error:
        raise BagError(f'{directory}: cannot be made, {error.strerror}') from None


def _remove_bag(directory: Path) -> None:
    """Remove the bag in a directory: its metadata.yaml and MCAP files, nothing else."""
    if directory.is_dir() and not any(directory.iterdir()):
        return
    if not (directory / FILE_NAME).is_file():
        raise BagError(f'{directory} holds no bag ({FILE_NAME}), so it is not overwritten')
    for path in [*sorted(directory.glob('*.mcap')), directory / FILE_NAME]:
        path.unlink()
