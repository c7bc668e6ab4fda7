"""
The frame of the serial line: start, kind, number, length, content, check.

::

    0x49 0x53 | kind u8 | number u8 | length u16 | content | CRC u16

All numbers are little endian. ``number`` is any number of the master, ``length`` that of the
content in bytes; the CRC is CRC-16/IBM-3740 (polynomial 0x1021, start 0xFFFF, also known as
CCITT-FALSE) of everything between start and CRC. The answer has the kind of its request plus 0x80,
the same number, and a content that begins with an abort code (u32; 0: done) and with the number of
requests that have been discarded for a wrong CRC (u16, modulo 65536).
"""

from binascii import crc_hqx
import struct
from typing import NamedTuple

START = b'\x49\x53'
ANSWERED = 0x80             # bit of the kind of an answer
PROCESS_DATA, READ, WRITE = 0x01, 0x02, 0x03
MOST_CONTENT = 8192         # bytes
_HEAD = struct.Struct('<2sBBH')
_CRC = struct.Struct('<H')
_CRC_START = 0xFFFF
OVERHEAD = _HEAD.size + _CRC.size
"""Bytes of a frame beside its content."""

STATUS = struct.Struct('<IH')
"""Abort code and discarded requests, at the begin of each answer."""
OBJECT = struct.Struct('<BHB')
"""Actuator (0: the first), index and subindex, at the begin of the content of `READ`, `WRITE`."""


class SerialFrame(NamedTuple):
    """What a frame carries."""

    kind: int
    number: int
    content: bytes


def packed(frame: SerialFrame) -> bytes:
    """Return the bytes of a frame."""
    head = _HEAD.pack(START, frame.kind, frame.number, len(frame.content))
    return head + frame.content + _CRC.pack(_crc(head[len(START):] + frame.content))


class FrameReader:
    """
    Finds the frames in a stream of bytes.

    A frame that is announced and not there yet, because its length has been changed on the way, is
    given up as soon as a whole one follows.
    """

    def __init__(self) -> None:
        self.discarded = 0
        """Frames with a wrong CRC, or given up."""
        self._bytes = bytearray()

    def feed(self, data: bytes) -> None:
        """Append bytes of the line."""
        self._bytes += data

    def take(self) -> SerialFrame | None:
        """Return the next whole frame, None until more bytes are there."""
        while self._find_start():
            end = self._end(0)
            if end > len(self._bytes):
                return self._later()
            if end and (frame := self._frame(0, end)) is not None:
                del self._bytes[:end]
                return frame
            self.discarded += end > 0
            del self._bytes[0]  # the next frame may begin within this one
        return None

    def _find_start(self) -> bool:
        """Drop what is before a start; return whether the head behind it is there."""
        place = self._bytes.find(START)
        if place < 0:
            place = len(self._bytes) - self._bytes.endswith(START[:1])
        del self._bytes[:place]
        return len(self._bytes) >= _HEAD.size

    def _end(self, place: int) -> int:
        """Return the end of the frame that begins at a place, 0 if no frame is that long."""
        length: int = _HEAD.unpack_from(self._bytes, place)[-1]
        return place + OVERHEAD + length if length <= MOST_CONTENT else 0

    def _frame(self, place: int, end: int) -> SerialFrame | None:
        """Return the frame between two places, None if its CRC is wrong."""
        checked = bytes(self._bytes[place + len(START):end - _CRC.size])
        if _crc(checked) != _CRC.unpack_from(self._bytes, end - _CRC.size)[0]:
            return None
        return SerialFrame(checked[0], checked[1], checked[_HEAD.size - len(START):])

    def _later(self) -> SerialFrame | None:
        """Return a whole frame behind the first start, and give up what is before it."""
        place = self._bytes.find(START, 1)
        while 0 < place <= len(self._bytes) - _HEAD.size:
            end = self._end(place)
            if place < end <= len(self._bytes):
                frame = self._frame(place, end)
                if frame is not None:
                    self.discarded += 1
                    del self._bytes[:end]
                    return frame
            place = self._bytes.find(START, place + 1)
        return None


def _crc(data: bytes) -> int:
    return crc_hqx(data, _CRC_START)
