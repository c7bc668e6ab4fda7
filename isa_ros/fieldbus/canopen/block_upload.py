"""
The block upload of SDO (CiA 301, 7.2.4.2.13 to 7.2.4.2.15): many segments for one confirmation.

The client asks for blocks of up to 127 segments of 7 bytes, numbered from 1, and confirms the last
one that arrived in order; those behind it are sent again. The last segment has a bit of its own,
and the end has the number of its unused bytes and the CRC of the data: polynomial 0x1021, start 0.
"""

from binascii import crc_hqx
from enum import auto, Enum
import struct

from isa_ros.fieldbus.device.abort import (
    INVALID_BLOCK_SIZE, INVALID_SEQUENCE, SdoAbort, UNKNOWN_COMMAND)
from isa_ros.fieldbus.device.sdo_transfer import COMMAND_BITS, INITIATE

BLOCK_UPLOAD = 5
"""Command of a client, in the top three bits."""
INITIATE_BLOCK, END_BLOCK, CONFIRM_BLOCK, START_BLOCK = range(4)
"""What of it, in the lowest two bits."""
_ANSWERED = 6 << COMMAND_BITS       # command of the server
HAS_CRC, HAS_SIZE, _ENDS = 0x04, 0x02, 0x01
BYTES, MOST_SEGMENTS = 7, 127
"""In a segment; in a block."""
IS_LAST = 0x80
"""Beside the number of a segment."""
_END = struct.Struct('<BH5x')


class _Awaited(Enum):
    START = auto()
    CONFIRMATION = auto()
    END = auto()


class BlockUpload:
    """An upload in blocks; ``segments`` is the length of the first one."""

    def __init__(self, index: int, subindex: int, data: bytes, segments: int) -> None:
        self.index, self.subindex = index, subindex
        self._data, self._place = data, 0
        self._segments = _admitted(segments)
        self._awaited, self._sent = _Awaited.START, 0

    def initiated(self) -> bytes:
        """Return the answer to its begin: with a CRC, and the size of the data."""
        return INITIATE.pack(
            _ANSWERED | HAS_CRC | HAS_SIZE, self.index, self.subindex, len(self._data))

    def answers(self, request: bytes) -> list[bytes] | None:
        """
        Return the frames that follow a request; None: the upload has ended.

        Raises
        ------
        SdoAbort
            Another request is awaited, or its numbers are impossible.

        """
        kind = request[0] & 0x03
        if kind == START_BLOCK and self._awaited is _Awaited.START:
            return self._block()
        if kind == CONFIRM_BLOCK and self._awaited is _Awaited.CONFIRMATION:
            return self._confirmed(request[1], request[2])
        if kind == END_BLOCK and self._awaited is _Awaited.END:
            return None
        raise SdoAbort(UNKNOWN_COMMAND)

    def _block(self) -> list[bytes]:
        """Return the segments of the block at the present place; at least one, if it is empty."""
        self._awaited = _Awaited.CONFIRMATION
        parts = [self._data[k:k + BYTES] for k in range(
            self._place, self._place + self._segments * BYTES, BYTES)]
        sent = [part for part in parts if part] or [b'']
        self._sent = len(sent)
        is_whole = self._place + self._sent * BYTES >= len(self._data)
        return [
            bytes([number | (IS_LAST if is_whole and number == self._sent else 0)])
            + part.ljust(BYTES, b'\0') for number, part in enumerate(sent, 1)]

    def _confirmed(self, number: int, segments: int) -> list[bytes]:
        """Return the next block behind the segment that was confirmed, or the end."""
        if number > self._sent:
            raise SdoAbort(INVALID_SEQUENCE)
        self._segments = _admitted(segments)
        self._place += number * BYTES
        if self._place < len(self._data) or not number:
            return self._block()
        self._awaited = _Awaited.END
        unused = self._place - len(self._data)
        return [_END.pack(_ANSWERED | unused << 2 | _ENDS, crc_hqx(self._data, 0))]


def _admitted(segments: int) -> int:
    if not 0 < segments <= MOST_SEGMENTS:
        raise SdoAbort(INVALID_BLOCK_SIZE)
    return segments
