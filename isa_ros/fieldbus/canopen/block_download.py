"""
The block download of SDO (CiA 301, 7.2.4.2.9 to 7.2.4.2.12): one confirmation for many segments.

The client sends blocks of up to 127 segments of 7 bytes, numbered from 1. A segment out of
order is not taken; the answer to the last of a block names the last one that was, and the client
goes on behind it. The end has the number of unused bytes in the last segment and the CRC of the
data, if the client computes one.
"""

from binascii import crc_hqx
import struct

from isa_ros.fieldbus.canopen.block_upload import BYTES, HAS_CRC, HAS_SIZE, IS_LAST, MOST_SEGMENTS
from isa_ros.fieldbus.device.abort import (
    CRC_ERROR, INVALID_SEQUENCE, OUT_OF_MEMORY, SdoAbort, TOO_LONG, TOO_SHORT)
from isa_ros.fieldbus.device.sdo_transfer import COMMAND_BITS, INITIATE

BLOCK_DOWNLOAD = 6
"""Command of a client, in the top three bits."""
END_DOWNLOAD = 0x01
"""Bit of it: the end, not the begin."""
_ANSWERED = 5 << COMMAND_BITS       # command of the server
_ENDED, _CONFIRMED = 1, 2           # what of it
_END = struct.Struct('<BH5x')


class BlockDownload:
    """A download in blocks of at most ``most`` bytes, begun by a request."""

    def __init__(self, request: bytes, most: int) -> None:
        command, self.index, self.subindex, size = INITIATE.unpack(request)
        self._has_crc = bool(command & HAS_CRC)
        self._expected = size if command & HAS_SIZE else None
        self._most = most
        if size > most and self._expected is not None:
            raise SdoAbort(OUT_OF_MEMORY)
        self._data = bytearray()
        self._taken = 0     # of the present block
        self._is_receiving = True

    def initiated(self) -> bytes:
        """Return the answer to its begin: with a CRC, and the length of a block."""
        return INITIATE.pack(_ANSWERED | HAS_CRC, self.index, self.subindex, MOST_SEGMENTS)

    def takes(self, request: bytes) -> bool:
        """Return whether a frame is a segment: all are until the last one, but for an abort."""
        return self._is_receiving and request[0] != IS_LAST

    def take(self, segment: bytes) -> list[bytes]:
        """
        Take a segment; return the confirmation of a block, nothing within one.

        Raises
        ------
        SdoAbort
            It has no number, or there is more than announced or than can be.

        """
        number, is_last = segment[0] & ~IS_LAST, bool(segment[0] & IS_LAST)
        if not number:
            raise SdoAbort(INVALID_SEQUENCE)
        if number == self._taken + 1:
            self._taken = number
            self._data += segment[1:]
            self._is_receiving = not is_last
            self._refuse_more(len(self._data) - BYTES)
        if not is_last and number < MOST_SEGMENTS:
            return []
        taken, self._taken = self._taken, 0
        return [bytes([_ANSWERED | _CONFIRMED, taken, MOST_SEGMENTS, 0, 0, 0, 0, 0])]

    def content(self, request: bytes) -> bytes:
        """
        Return the data, at the request that ends it.

        Raises
        ------
        SdoAbort
            Length or CRC are not those of the data.

        """
        command, crc = _END.unpack(request)
        content = bytes(self._data[:len(self._data) - (command >> 2 & 7)])
        self._refuse_more(len(content))
        if self._expected is not None and len(content) < self._expected:
            raise SdoAbort(TOO_SHORT)
        if self._has_crc and crc != crc_hqx(content, 0):
            raise SdoAbort(CRC_ERROR)
        return content

    def ended(self) -> bytes:
        """Return the answer to its end."""
        return bytes([_ANSWERED | _ENDED]).ljust(INITIATE.size, b'\0')

    def _refuse_more(self, size: int) -> None:
        """Refuse that there are at least ``size`` bytes."""
        if size > (self._most if self._expected is None else self._expected):
            raise SdoAbort(OUT_OF_MEMORY if self._expected is None else TOO_LONG)
