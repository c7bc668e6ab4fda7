"""One chunk of an MCAP file as it is read: where its messages are, and what their heads say."""

from typing import NamedTuple

from isa_ros.bag.message_chunk import MESSAGE_HEADER
from isa_ros.core.kernel import kernel
from isa_ros.errors import BagError
from mcap.opcode import Opcode
import numpy as np
from numpy.typing import NDArray

RECORD_HEAD = 9     # bytes: opcode, length
_OPCODE, _BEGIN, _END, _CHANNEL, _SEQUENCE, _TIME = range(6)
_MESSAGE = int(Opcode.MESSAGE)
_MESSAGE_HEAD = MESSAGE_HEADER.size
_CHANNEL_AT, _SEQUENCE_AT, _TIME_AT = 9, 11, 15     # in a message record
_WHOLE, _BEYOND, _TOO_MANY, _UNKNOWN, _SHORT = range(5)


@kernel
def _number(content, at, n):
    """Return ``n`` bytes, little endian, as an integer; 8 of them may be negative."""
    value = np.int64(0)
    for k in range(n):
        value |= np.int64(content[at + k]) << np.int64(8 * k)
    return value


@kernel
def _find_records(content, most, found):
    """
    Fill a row of ``found`` for each record; return their number and the error behind them.

    A row is opcode, begin, end and, of a message, channel, sequence and time. Of a record that is
    too short to be a message, the row has its opcode and its size.
    """
    n, end, size = 0, 0, len(content)
    while end < size:
        begin = end
        if begin + RECORD_HEAD > size:
            return n, _BEYOND
        length = _number(content, begin + 1, 8)
        if length < 0 or length > size - begin - RECORD_HEAD:
            return n, _BEYOND
        end = begin + RECORD_HEAD + length
        if n == most:
            return n, _TOO_MANY
        opcode = content[begin]
        if opcode == 0:
            return n, _UNKNOWN
        found[n, _OPCODE], found[n, _BEGIN], found[n, _END] = opcode, begin, end
        if opcode == _MESSAGE:
            if end - begin < _MESSAGE_HEAD:
                return n, _SHORT
            found[n, _CHANNEL] = _number(content, begin + _CHANNEL_AT, 2)
            found[n, _SEQUENCE] = _number(content, begin + _SEQUENCE_AT, 4)
            found[n, _TIME] = _number(content, begin + _TIME_AT, 8)
        n += 1
    return n, _WHOLE


class MessageTable(NamedTuple):
    """The messages of a chunk in their order; arrays are (n,)."""

    content: bytes
    """The uncompressed chunk."""
    channels: NDArray[np.int64]
    sequences: NDArray[np.int64]
    times: NDArray[np.uint64]
    """ns."""
    begins: NDArray[np.int64]
    """Of their CDR bytes in the content."""
    ends: NDArray[np.int64]

    def of(self, channel: int) -> 'MessageTable':
        """Return the messages of one channel."""
        own = np.flatnonzero(self.channels == channel)
        return MessageTable(self.content, self.channels[own], self.sequences[own],
                            self.times[own], self.begins[own], self.ends[own])

    def bytes_of(self) -> NDArray[np.uint8] | None:
        """Return their CDR bytes, (n, size), without a copy if possible; None: of two sizes."""
        sizes = self.ends - self.begins
        if (sizes != sizes[0]).any():
            return None
        content, size = np.frombuffer(self.content, np.uint8), int(sizes[0])
        strides = np.diff(self.begins)
        if len(strides) and (strides == strides[0]).all():
            return np.ndarray(      # as the recorder writes ticks: evenly spaced
                (len(sizes), size), np.uint8, content.data, int(self.begins[0]),
                (int(strides[0]), 1))
        gathered: NDArray[np.uint8] = content[self.begins[:, None] + np.arange(size)]
        return gathered


Declaration = tuple[int, bytes]
"""Opcode and content of a record of a chunk that is no message."""


def messages_in(content: bytes, most: int, where: str) -> tuple[MessageTable, list[Declaration]]:
    """
    Return the messages of a chunk and its other records, of which there are at most ``most``.

    Raises
    ------
    BagError
        A record reaches beyond the chunk, is of no kind or too short, or there are too many.

    """
    room = min(most, len(content) // RECORD_HEAD + 1)
    found = np.empty((room + 1, 6), np.int64)
    n, error = _find_records(np.frombuffer(content, np.uint8), most, found)
    if error:
        raise BagError(f'{where}: {_complaint(error, found[n], most)}')
    rows = found[:n]
    is_message = rows[:, _OPCODE] == _MESSAGE
    others = [(int(row[_OPCODE]), content[row[_BEGIN] + RECORD_HEAD:row[_END]])
              for row in rows[~is_message]]
    own = rows[is_message]
    return MessageTable(
        content, own[:, _CHANNEL], own[:, _SEQUENCE], own[:, _TIME].view(np.uint64),
        own[:, _BEGIN] + _MESSAGE_HEAD, own[:, _END]), others


def _complaint(error: int, row: NDArray[np.int64], most: int) -> str:
    """Return an error of `_find_records` in words; ``row`` is that of the record."""
    if error == _BEYOND:
        return 'a record reaches beyond its chunk'
    if error == _TOO_MANY:
        return f'more records in a chunk than its compressed bytes allow, must be <= {most}'
    if error == _UNKNOWN:
        return 'unknown record 0x00 in a chunk'
    return f'a message record of {row[_END] - row[_BEGIN]} bytes'
