"""
The recorder: writes a rosbag2 directory that can be read at any time of the run.

Provenance and metadata.yaml are written before the first message. A chunk ends with a whole
tick, contains at most half a simulated second, and is written by a thread while the next one is
filled: a killed run loses less than a simulated second, and its bag ends with a whole tick.
With a split size, the tick after the chunk that reaches it begins the next file.

Nothing depends on the host: the same run gives the same bytes. The bytes of compressed chunks
also depend on the versions of zstd and lz4, their content does not.
"""

from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
import time
from types import TracebackType

from isa_ros.bag.directory import make_directory
from isa_ros.bag.message_chunk import Buffers, Chunk, Room
from isa_ros.bag.metadata import FILE_NAME, metadata_yaml, TopicEntry
from isa_ros.bag.packed import Layout
from isa_ros.bag.part_writer import Head, PartWriter
from isa_ros.bag.provenance import Provenance
from isa_ros.bag.storage import PLAIN, Storage
from isa_ros.core.atomic_file import replace_file, sync_directory
from isa_ros.core.topic import Topic
from isa_ros.errors import BagError, RunError
from msg_adapters.definitions import definition


METADATA_PERIOD_S = 30.0
"""Host time between two writings of metadata.yaml; readers need it only at the end."""


class BagWriter:
    """
    Writer of one bag.

    ``topics`` are sorted by name; a topic's index is its position. The directory must not exist,
    except that with ``overwrite`` it may contain a bag, which is replaced as described in
    `isa_ros.bag.directory`. ``path`` is the first file. ``is_synced``: wait at each chunk until
    the disk has it, otherwise the system decides when it writes what a killed process has left.

    Raises
    ------
    BagError
        the directory already exists, is not replaced or cannot be created, or topics are not
        sorted.
    RunError
        the bag cannot be written, naming the file.

    """

    def __init__(
            self, directory: Path, topics: Sequence[Topic], provenance: Provenance,
            overwrite: bool = False, storage: Storage = PLAIN, is_synced: bool = False) -> None:
        _check_sorted(topics)
        definitions = {topic.type_name: definition(topic.type_name) for topic in topics}
        self._head = Head(
            provenance.attachments(), provenance.record(),
            [TopicEntry.of(topic, definitions[topic.type_name].type_hash) for topic in topics],
            {name: text for name, (text, _) in definitions.items()})
        self._storage = storage
        self._is_synced = is_synced
        self._metadata_path = directory / FILE_NAME
        self._stem = directory.resolve().name
        self.path = self._path(0)
        make_directory(directory, overwrite)
        if is_synced:
            sync_directory(directory.parent)
        self._parts: list[PartWriter] = []
        self._buffers = Buffers()
        self._is_full = False
        self._is_closed = False
        self._error: RunError | None = None
        self._thread = ThreadPoolExecutor(1, 'recorder')
        self._writing: Future[None] | None = None
        self._metadata_due = time.monotonic() + METADATA_PERIOD_S
        try:
            self._begin_part()
        except OSError as error:
            raise self._failure(error, self.path) from error

    def write_tick(
            self, t_ns: int, sequence: int, messages: Sequence[tuple[int, bytes]]) -> None:
        """
        Record the messages of one tick: (topic index, CDR bytes), sorted by index, possibly none.

        ``t_ns`` is log and publish time, ``sequence`` the tick's number.

        Raises
        ------
        RunError
            the bag cannot be written, or a file of it was removed, moved or truncated by others;
            the messages in it stay readable.

        """
        if self._error is not None:
            raise self._error
        try:
            self._prepare(t_ns, begins_part=bool(messages))
            self._hand_over(self._parts[-1].write_tick(t_ns, sequence, messages))
        except OSError as error:
            raise self._failure(error, self._path(len(self._parts) - 1)) from error

    def open_stretch(self, layout: Layout, t_ns: int, step_ns: int) -> Room:
        """
        Return room for consecutive ticks that the caller writes by itself.

        All have the same ``layout``, of one message or more; the first is that of ``t_ns``, the
        others follow every ``step_ns``. For tick k of them call ``append(room.buffer,
        room.at + k * room.tick_bytes, block, layout, sequence + k, t_ns + k * step_ns)``, then
        `close_stretch` with their number. Until then call nothing else of this writer. The room
        ends with the tick that completes a chunk, or where the chunk before must be written.

        Raises
        ------
        RunError
            as `write_tick`

        """
        if self._error is not None:
            raise self._error
        try:
            self._prepare(t_ns, begins_part=True)
            return self._parts[-1].open_stretch(
                layout, t_ns, step_ns, is_writing=self._writing is not None)
        except OSError as error:
            raise self._failure(error, self._path(len(self._parts) - 1)) from error

    def close_stretch(self, n_ticks: int) -> None:
        """
        Record the first ``n_ticks`` that were written since `open_stretch`, possibly none.

        Raises
        ------
        RunError
            as `write_tick`
        ValueError
            There was no room for so many ticks.

        """
        try:
            self._hand_over(self._parts[-1].close_stretch(n_ticks))
        except OSError as error:
            raise self._failure(error, self._path(len(self._parts) - 1)) from error

    def _prepare(self, t_ns: int, begins_part: bool) -> None:
        """
        Raise the error of a chunk that was written; begin the next file where one is due.

        With a split size this needs that of the file, and waits for the chunk. So do the last
        ticks of a chunk: what is not in the file is always less than a second.
        """
        if self._writing is not None and (
                self._storage.split_bytes is not None or self._writing.done()
                or self._parts[-1].must_wait(t_ns)):
            self._end_writing()
        if self._is_full and begins_part:
            self._begin_part()

    def _hand_over(self, chunk: Chunk | None) -> None:
        """Give a complete chunk to the thread, once it has written the one before."""
        if chunk is None:
            return
        self._end_writing()
        self._writing = self._thread.submit(self._write, self._parts[-1], chunk)

    def close(self) -> None:
        """
        Write pending messages, the summary and metadata.yaml; a second call does nothing.

        Raises
        ------
        RunError
            as `write_tick`; the bag stays readable like that of a killed run.

        """
        if self._is_closed:
            return
        self._is_closed = True
        part = self._parts[-1]
        try:
            self._end_writing()
            self._finish(part, is_last=True)
            self._write_metadata()
            self._check_parts()
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
        """Write a chunk, and metadata.yaml when it is due; runs in the thread."""
        part.write_chunk(chunk)
        if self._is_synced:
            part.sync()
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
        """Close; an error while closing does not replace an error of the run."""
        try:
            self.close()
        except RunError:
            if error is None:
                raise

    def _begin_part(self) -> None:
        """Finish the current file, if there is one, and begin the next."""
        if self._parts:
            self._end_writing()
            self._finish(self._parts[-1], is_last=False)
            self._parts[-1].close()
            self._check_parts()
        number = len(self._parts)
        self._parts.append(PartWriter(
            self._path(number), number, self._head, self._storage.compression, self._buffers))
        self._is_full = False
        if self._is_synced:
            self._parts[-1].sync()
        self._write_metadata()

    def _finish(self, part: PartWriter, is_last: bool) -> None:
        part.finish(is_last)
        if self._is_synced:
            part.sync()

    def _check_parts(self) -> None:
        """Raise OSError if a file, also an earlier one, is no longer as it was written."""
        for part in self._parts:
            part.check()

    def _path(self, number: int) -> Path:
        return self._metadata_path.with_name(f'{self._stem}_{number}.mcap')

    def _write_metadata(self) -> None:
        """Replace metadata.yaml atomically."""
        text = metadata_yaml(
            [(part.path.name, part.counts) for part in self._parts], self._head.topics,
            self._head.custom)
        replace_file(self._metadata_path, text.encode(), is_durable=self._is_synced)

    def _failure(self, error: OSError, path: Path) -> RunError:
        self._error = RunError(
            f'{error.filename or path}: cannot record, {error.strerror or error}')
        if self._parts:
            self._parts[-1].discard_pending()
        return self._error


def _check_sorted(topics: Sequence[Topic]) -> None:
    names = [topic.name for topic in topics]
    if names != sorted(set(names)):
        raise BagError(f'topics = {", ".join(names)}, must be sorted by name, each once')
