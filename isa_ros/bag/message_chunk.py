"""
One chunk of an MCAP file while it is written: message records in a buffer, filled by a kernel.

The official ``mcap.writer.Writer`` creates an object and makes ten small packs for each message;
here one call writes all messages of a tick. A loop that is compiled itself calls `append` for each
of its ticks, into the `Room` that it got.
"""

from collections.abc import Sequence
import struct
from typing import NamedTuple

from isa_ros.bag.packed import Layout, Packed
from isa_ros.core.kernel import kernel
from mcap.opcode import Opcode
import numpy as np
from numpy.typing import NDArray

Entries = NDArray[np.uint64]
"""Index of one channel's messages: rows of log time, ns, and offset in the chunk."""

MESSAGE_HEADER = struct.Struct('<BQHIQQ')
"""Opcode, length of the rest, channel, sequence, log time, publish time."""

_BUFFER_BYTES = 1024 * 1024 + 64 * 1024  # of a chunk and the tick that ends it
_BUFFERS = 2  # one is filled while the other is written
_MESSAGE = int(Opcode.MESSAGE)
_HEADER_BYTES = MESSAGE_HEADER.size
_LENGTH_EXCESS = _HEADER_BYTES - 9  # length field of a message record minus length of its data


@kernel
def put(buffer, at, value, n):
    """Write ``value`` as ``n`` bytes, little endian; return the offset after it."""
    for k in range(n):
        buffer[at + k] = value >> 8 * k & 255
    return at + n


@kernel
def append(buffer, at, block, layout, sequence, t_ns):
    """
    Append the message records of one tick to ``buffer`` at ``at``.

    ``layout`` gives the position of each message in ``block``. The caller makes the buffer large
    enough.
    """
    for k in range(len(layout.topics)):
        size, start = layout.sizes[k], layout.starts[k]
        at = put(buffer, at, _MESSAGE, 1)
        at = put(buffer, at, size + _LENGTH_EXCESS, 8)
        at = put(buffer, at, layout.topics[k] + 1, 2)
        at = put(buffer, at, sequence, 4)
        at = put(buffer, at, t_ns, 8)
        at = put(buffer, at, t_ns, 8)
        into, message = buffer[at:at + size], block[start:start + size]
        for j in range(size):   # an assigned slice takes 20 times as long to compile
            into[j] = message[j]
        at += size


class _Ticks(NamedTuple):
    """Chunk layout shared by all ticks of one `Layout`."""

    layout: Layout
    channels: list[int]
    offsets: list[int]
    """Of each record, relative to the first of the tick."""
    size: int
    repeats: bool
    """Whether a channel has several messages in a tick."""


class Layouts:
    """Cache of the layouts that the ticks of a file have had so far."""

    def __init__(self) -> None:
        self._by_identity: dict[int, _Ticks] = {}
        self._by_content: dict[tuple[bytes, bytes], _Ticks] = {}

    def of(self, layout: Layout) -> _Ticks:
        """Return the chunk layout of a tick; the same object for equal layouts."""
        found = self._by_identity.get(id(layout))
        if found is not None and found.layout is layout:
            return found
        key = layout.topics.tobytes(), layout.sizes.tobytes()
        found = self._by_content.get(key)
        if found is None:
            ends = np.cumsum(layout.sizes + _HEADER_BYTES).tolist()
            channels = (layout.topics + 1).tolist()
            found = self._by_content[key] = _Ticks(
                layout, channels, [0, *ends[:-1]], ends[-1], len(set(channels)) < len(channels))
            self._by_identity[id(layout)] = found
        return found


class _Stretch(NamedTuple):
    """Consecutive ticks of one layout, one behind the other."""

    ticks: _Ticks
    start: int
    """Offset of the first in the chunk."""
    times: list[int]
    """Of each, ns."""


class Room(NamedTuple):
    """
    Memory for consecutive ticks of one layout, behind what a chunk has so far.

    The records of tick k begin at ``at + k tick_bytes``; `append` writes them.
    """

    buffer: NDArray[np.uint8]
    """Memory of the whole chunk."""
    at: int
    """Offset of the first tick in it."""
    tick_bytes: int
    """Size of the records of a tick."""
    n_ticks: int
    """Number of ticks that may be written."""


class Buffers:
    """Memory that chunks are filled in again: the first use of a page costs a tick a fault."""

    def __init__(self) -> None:
        self._free: list[NDArray[np.uint8]] = []

    def take(self) -> NDArray[np.uint8]:
        """Return memory for a chunk."""
        return self._free.pop() if self._free else np.empty(_BUFFER_BYTES, np.uint8)

    def give(self, buffer: NDArray[np.uint8]) -> None:
        """Keep the memory of a chunk that is written, as far as the next ones need it."""
        if len(self._free) < _BUFFERS:
            self._free.append(buffer)


class Chunk:
    """
    Messages of one chunk and the position of each.

    ``buffer`` is memory for its bytes. A larger one replaces it when needed: reuse `buffer`, not
    the argument, once the chunk is written.
    """

    def __init__(self, prefix: bytes, layouts: Layouts, buffer: NDArray[np.uint8]) -> None:
        self._layouts = layouts
        self._stretches: list[_Stretch] = []
        self.buffer = buffer
        self.size = 0
        self.start_ns = self.end_ns = 0
        self._reserve(len(prefix))
        self.buffer[:len(prefix)] = np.frombuffer(prefix, np.uint8)
        self.size = len(prefix)

    def _reserve(self, n: int) -> None:
        if self.size + n > len(self.buffer):
            grown = np.empty(2 * (self.size + n), np.uint8)
            grown[:self.size] = self.buffer[:self.size]
            self.buffer = grown

    def add(self, t_ns: int, sequence: int, messages: Sequence[tuple[int, bytes]]) -> None:
        """Append the messages of one instant: (topic index, CDR bytes)."""
        if not messages:
            return
        packed = Packed.of(messages)
        self._reserve(self.tick_bytes(packed.layout))
        append(self.buffer, self.size, packed.block, packed.layout, sequence, t_ns)
        self.count(packed.layout, (t_ns,))

    def tick_bytes(self, layout: Layout) -> int:
        """Return the size of the records of a tick."""
        return self._layouts.of(layout).size

    def room(self, layout: Layout, n_ticks: int) -> Room:
        """Return memory for ticks, which `count` makes a part of the chunk once it is filled."""
        size = self.tick_bytes(layout)
        self._reserve(n_ticks * size)
        return Room(self.buffer, self.size, size, n_ticks)

    def count(self, layout: Layout, times: Sequence[int]) -> None:
        """Take the ticks that were written behind the last one; ``times`` ns of each, (n,)."""
        ticks = self._layouts.of(layout)
        if not self._stretches:
            self.start_ns = times[0]
        if not self._stretches or self._stretches[-1].ticks is not ticks:
            self._stretches.append(_Stretch(ticks, self.size, []))
        self._stretches[-1].times.extend(times)
        self.end_ns = times[-1]
        self.size += len(times) * ticks.size

    def data(self) -> memoryview:
        """Return the content of the chunk without a copy."""
        return self.buffer[:self.size].data

    def release(self) -> None:
        """Give the memory back; the chunk must not be used any more."""
        self.buffer = np.empty(0, np.uint8)

    @property
    def is_empty(self) -> bool:
        """Return whether the chunk has no messages."""
        return not self._stretches

    def message_indices(self) -> list[tuple[int, Entries]]:
        """Return (channel id, entries (n, 2) of time and offset) of each channel with messages."""
        pieces: dict[int, list[Entries]] = {}
        for ticks, start, times in self._stretches:
            entries = np.empty((len(ticks.channels), len(times), 2), np.uint64)
            entries[:, :, 0] = times
            entries[:, :, 1] = np.add.outer(
                ticks.offsets, start + ticks.size * np.arange(len(times)))
            for channel, own in zip(ticks.channels, entries):
                pieces.setdefault(channel, []).append(own)
        is_sorted = not any(stretch.ticks.repeats for stretch in self._stretches)
        return [(channel, _joined(pieces[channel], is_sorted)) for channel in sorted(pieces)]


def _joined(pieces: Sequence[Entries], is_sorted: bool) -> Entries:
    """Return the entries of a channel in the order of the file."""
    if len(pieces) == 1:
        return pieces[0]
    entries = np.concatenate(pieces)
    return entries if is_sorted else entries[np.argsort(entries[:, 1])]
