"""
Writer of one file of a bag: its head, chunks of whole ticks, its end.

Every file can be read alone: provenance, schemas and channels are in each of them.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from isa_ros.bag.mcap_file import McapFile
from isa_ros.bag.message_chunk import Buffers, Chunk, Room
from isa_ros.bag.metadata import Counts, NO_START, storage_metadata, TopicEntry
from isa_ros.bag.packed import Layout
from isa_ros.bag.provenance import MEDIA_TYPES, RECORD
from msg_adapters.definitions import ENCODING

LIBRARY = 'isa_ros'  # without a version: the same run gives the same bytes everywhere
CHUNK_BYTES = 1024 * 1024
CHUNK_TICKS = 500
CHUNK_NS = 500_000_000
WAIT_NS = 400_000_000
"""Length from which on a chunk is filled only once the one before is in the file."""
QOS, TYPE_HASH = 'offered_qos_profiles', 'topic_type_hash'
"""Keys of a channel's metadata, as rosbag2 has them."""
ROSBAG2, SERIALIZED = 'rosbag2', 'serialized_metadata'
"""Name and key of the record with rosbag2's own metadata."""
PART, CONTINUES = 'isa_ros.part', 'isa_ros.continues'
"""Names of the records of a split bag: a file's number at its head, the next one's at its end."""
NUMBER = 'number'


class Head(NamedTuple):
    """Content of the head of every file of a bag."""

    attachments: Mapping[str, bytes]
    custom: Mapping[str, str]
    topics: Sequence[TopicEntry]
    schemas: Mapping[str, str]
    """Definition text by type name."""


class _OpenTicks(NamedTuple):
    """Ticks that a caller may write into the chunk by itself."""

    layout: Layout
    times: range
    """Time of each, ns."""


class PartWriter:
    """
    Writer of the file with this ``number`` in a bag.

    A chunk ends with the tick that reaches 1 MiB, 500 ticks or half a simulated second.
    Every method that writes, and `check`, raises an OSError.
    """

    def __init__(
            self, path: Path, number: int, head: Head, compression: str,
            buffers: Buffers) -> None:
        self.path = path
        self._number = number
        self._file = McapFile(path, LIBRARY, compression, buffers)
        self._is_finished = False
        self._start_ns, self._end_ns = NO_START, NO_START
        self._counts = [0] * len(head.topics)
        self._ticks = 0
        self._stretch: _OpenTicks | None = None
        try:
            self._write_head(head)
        except OSError:
            self._file.close()
            raise
        self._chunk = self._file.new_chunk()

    @property
    def counts(self) -> Counts:
        """Return the counts of the complete chunks."""
        return Counts(self._start_ns, self._end_ns, tuple(self._counts))

    @property
    def size(self) -> int:
        """Return the number of bytes written."""
        return self._file.size

    def write_tick(
            self, t_ns: int, sequence: int, messages: Sequence[tuple[int, bytes]]
            ) -> Chunk | None:
        """
        Add the messages of one tick, possibly none.

        Return the chunk that this tick completed, which must be passed to `write_chunk` before
        the next one is complete.
        """
        self._stretch = None
        if messages:
            self._chunk.add(t_ns, sequence, messages)
            self._ticks += 1
        elif not self._ticks:
            return None
        return self._completed(t_ns)

    def must_wait(self, t_ns: int) -> bool:
        """Return whether the tick of ``t_ns`` needs the chunk before to be in the file."""
        return not self._chunk.is_empty and t_ns - self._chunk.start_ns >= WAIT_NS

    def open_stretch(
            self, layout: Layout, t_ns: int, step_ns: int, is_writing: bool = False) -> Room:
        """
        Return room for ticks of ``layout``, at ``t_ns`` and then every ``step_ns``.

        The last one that it has room for completes the chunk, unless `close_stretch` takes fewer;
        while the chunk before ``is_writing`` it is the one before the first that `must_wait`.
        """
        chunk = self._chunk
        size = chunk.tick_bytes(layout)
        start_ns = t_ns if chunk.is_empty else chunk.start_ns
        end_ns = start_ns + (WAIT_NS - step_ns if is_writing else CHUNK_NS)
        room = chunk.room(layout, max(1, min(
            CHUNK_TICKS - self._ticks, -((chunk.size - CHUNK_BYTES) // size),
            1 - (t_ns - end_ns) // step_ns)))
        self._stretch = _OpenTicks(layout, range(t_ns, t_ns + room.n_ticks * step_ns, step_ns))
        return room

    def close_stretch(self, n_ticks: int) -> Chunk | None:
        """
        Take the first ticks of the open stretch, whose records the caller has written.

        Returns as `write_tick`.

        Raises
        ------
        ValueError
            No stretch is open, or it has no room for so many ticks.

        """
        stretch, self._stretch = self._stretch, None
        room = 0 if stretch is None else len(stretch.times)
        if not 0 <= n_ticks <= room:
            raise ValueError(f'{n_ticks} ticks in a stretch with room for {room}')
        if stretch is None or not n_ticks:
            return None
        self._chunk.count(stretch.layout, stretch.times[:n_ticks])
        self._ticks += n_ticks
        return self._completed(stretch.times[n_ticks - 1])

    def _completed(self, t_ns: int) -> Chunk | None:
        """Return the chunk if the tick of ``t_ns`` ends it."""
        if (self._ticks < CHUNK_TICKS and self._chunk.size < CHUNK_BYTES
                and t_ns - self._chunk.start_ns < CHUNK_NS):
            return None
        return self._take_chunk()

    def write_chunk(self, chunk: Chunk) -> None:
        """Write a chunk to the file, which must be as it was left; see `McapFile.check`."""
        self.check()
        if chunk.is_empty:
            return
        counts = self._file.add_chunk(chunk)
        if self._start_ns == NO_START:
            self._start_ns = chunk.start_ns
        self._end_ns = chunk.end_ns
        for channel, count in counts:
            self._counts[channel - 1] += count

    def check(self) -> None:
        """Raise OSError if the file was removed, moved or changed by others."""
        self._file.check()

    def sync(self) -> None:
        """Wait until the disk has everything written."""
        self._file.sync()

    def discard_pending(self) -> None:
        """Drop the messages of the incomplete chunk: those before them could not be written."""
        self._take_chunk()

    def finish(self, is_last: bool) -> None:
        """Write pending messages and the summary; a second call does nothing."""
        if self._is_finished:
            return
        self.write_chunk(self._take_chunk())
        if not is_last:
            self._file.add_metadata(CONTINUES, {NUMBER: str(self._number + 1)})
        self._file.finish()
        self._is_finished = True

    def close(self) -> None:
        """Close the file, finished or not, and release its memory: a bag may have many."""
        self._file.close()
        self._chunk.release()

    def _write_head(self, head: Head) -> None:
        for name, data in head.attachments.items():
            self._file.add_attachment(name, MEDIA_TYPES[name], data)
        self._file.add_metadata(RECORD, head.custom)
        if self._number:
            self._file.add_metadata(PART, {NUMBER: str(self._number)})
        self._file.add_metadata(ROSBAG2, {SERIALIZED: storage_metadata(head.custom)})
        types = list(head.schemas)
        for name in types:
            self._file.add_schema(name, ENCODING, head.schemas[name].encode())
        for topic in head.topics:
            self._file.add_channel(topic.name, types.index(topic.type_name) + 1, {
                QOS: topic.qos, TYPE_HASH: topic.type_hash})

    def _take_chunk(self) -> Chunk:
        chunk, self._chunk = self._chunk, self._file.new_chunk()
        self._ticks = 0
        self._stretch = None
        return chunk
