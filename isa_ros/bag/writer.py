"""
The recorder: a rosbag2 directory that can be read at any moment of the run.

Provenance and metadata.yaml are written before the first message. A chunk ends with the
tick that reaches 1 MiB or 500 ticks, and is in the operating system's hands when
`BagWriter.write_tick` returns: a killed run loses 500 ticks at most, and what is left ends
with a whole tick. Nothing is compressed, nothing is taken from the host: the same run gives
the same bytes.
"""

from collections.abc import Sequence
from pathlib import Path
from types import TracebackType

from isa_ros.bag.mcap_file import McapFile
from isa_ros.bag.metadata import Counts, FILE_NAME, metadata_yaml, NO_START
from isa_ros.bag.metadata import storage_metadata, Topic
from isa_ros.bag.provenance import MEDIA_TYPES, Provenance, RECORD
from isa_ros.errors import BagError, RunError
from msg_adapters.definitions import definition, ENCODING

LIBRARY = 'isa_ros'  # without a version: the same run gives the same bytes everywhere
CHUNK_BYTES = 1024 * 1024
CHUNK_TICKS = 500


class BagWriter:
    """
    One bag under construction.

    ``topics`` are sorted by name; a topic's place in them is its index. The directory must
    not exist, unless it is to be overwritten and holds a bag: then that bag is removed, and
    nothing else.

    Raises
    ------
    BagError
        the directory exists or cannot be made, or topics are not sorted.
    RunError
        the bag cannot be written, naming the file.

    """

    def __init__(
            self, directory: Path, topics: Sequence[Topic], provenance: Provenance,
            overwrite: bool = False) -> None:
        _check_sorted(topics)
        definitions = {topic.type_name: definition(topic.type_name) for topic in topics}
        self._topics = [(topic, definitions[topic.type_name].type_hash) for topic in topics]
        self._custom = provenance.record()
        self._metadata_path = directory / FILE_NAME
        self.path = directory / f'{directory.resolve().name}_0.mcap'
        _make_directory(directory, overwrite)
        self._start_ns, self._end_ns = NO_START, NO_START
        self._counts = [0] * len(topics)
        self._ticks = 0
        self._is_closed = False
        self._error: RunError | None = None
        try:
            self._file = McapFile(self.path, LIBRARY)
            self._write_head(provenance)
            for name, (text, _) in definitions.items():
                self._file.add_schema(name, ENCODING, text.encode())
            self._add_channels(list(definitions))
            self._write_metadata()
        except OSError as error:
            raise self._failure(error) from error
        self._chunk = self._file.new_chunk()

    def write_tick(
            self, t_ns: int, sequence: int, messages: Sequence[tuple[int, bytes]]) -> None:
        """
        Record the messages of one tick: (topic index, CDR bytes), sorted by index.

        ``t_ns`` is log and publish time, ``sequence`` the tick's number.

        Raises
        ------
        RunError
            the bag cannot be written; what it held stays readable.

        """
        if self._error is not None:
            raise self._error
        self._chunk.add(t_ns, sequence, messages)
        self._ticks += 1
        if self._ticks == CHUNK_TICKS or self._chunk.size >= CHUNK_BYTES:
            try:
                self._end_chunk()
                self._write_metadata()
            except OSError as error:
                raise self._failure(error) from error

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
        try:
            self._end_chunk()
            self._file.finish()
            self._write_metadata()
        except OSError as error:
            raise self._failure(error) from error
        finally:
            self._file.close()

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

    def _write_head(self, provenance: Provenance) -> None:
        for name, data in provenance.attachments().items():
            self._file.add_attachment(name, MEDIA_TYPES[name], data)
        self._file.add_metadata(RECORD, self._custom)
        self._file.add_metadata(
            'rosbag2', {'serialized_metadata': storage_metadata(self._custom)})

    def _add_channels(self, types: list[str]) -> None:
        for topic, type_hash in self._topics:
            self._file.add_channel(topic.name, types.index(topic.type_name) + 1, {
                'offered_qos_profiles': topic.qos.to_yaml(), 'topic_type_hash': type_hash})

    def _end_chunk(self) -> None:
        chunk, self._ticks = self._chunk, 0
        self._chunk = self._file.new_chunk()
        indices = chunk.message_indices()
        if not indices:
            return
        self._file.add_chunk(chunk)
        self._chunk = self._file.new_chunk()
        if self._start_ns == NO_START:
            self._start_ns = chunk.start_ns
        self._end_ns = chunk.end_ns
        for channel, index in indices:
            self._counts[channel - 1] += len(index)

    def _write_metadata(self) -> None:
        """Replace metadata.yaml in one step."""
        counts = Counts(self._start_ns, self._end_ns, self._counts)
        text = metadata_yaml(self.path.name, self._topics, counts, self._custom)
        temporary = self._metadata_path.with_suffix('.yaml.tmp')
        temporary.write_text(text, encoding='utf-8')
        temporary.replace(self._metadata_path)

    def _failure(self, error: OSError) -> RunError:
        self._error = RunError(
            f'{error.filename or self.path}: cannot record, {error.strerror or error}')
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
