"""
The SDO server of a node: expedited and segmented transfers (CiA 301, 7.2.4).

Block transfers are refused by their code, as CiA 301 allows: a device without them answers
``unknown command``. A request of other than 8 bytes is no request.
"""

from dataclasses import dataclass, field
import struct
from typing import Protocol

from isa_ros.fieldbus.device.abort import (
    OUT_OF_MEMORY, SdoAbort, TOGGLE_BIT, TOO_LONG, TOO_SHORT, UNKNOWN_COMMAND)

SIZE = 8                # bytes of every request and answer
MOST_BYTES = 4096       # of a value that is written
SEGMENT_BYTES = 7

# Specifiers in bits 5 to 7 of the first byte: of requests | of answers.
DOWNLOAD_SEGMENT, DOWNLOAD, UPLOAD, UPLOAD_SEGMENT, ABORT = range(5)
_ANSWER_UPLOAD_SEGMENT, _ANSWER_DOWNLOAD_SEGMENT, _ANSWER_UPLOAD, _ANSWER_DOWNLOAD = range(4)
_TOGGLE = 0x10
_EXPEDITED, _HAS_SIZE, _IS_LAST = 0x02, 0x01, 0x01
_HEAD = struct.Struct('<BHB')
_ABORT = struct.Struct('<BHBI')


class Dictionary(Protocol):
    """The objects that a server gives access to."""

    def read(self, index: int, subindex: int) -> bytes:
        """Return the bytes of an entry; raises `SdoAbort`."""

    def write(self, index: int, subindex: int, data: bytes) -> None:
        """Write an entry; raises `SdoAbort`."""

    def size(self, index: int, subindex: int) -> int:
        """Return the bytes of an entry's type, 0 for a text; raises `SdoAbort`."""


@dataclass
class _Transfer:
    """A segmented transfer on its way."""

    index: int
    subindex: int
    is_download: bool
    data: bytearray = field(default_factory=bytearray)  # to send | received
    expected: int | None = None                         # bytes of a download, if announced
    toggle: int = 0


class SdoServer:
    """Answers the requests of one client."""

    def __init__(self, dictionary: Dictionary) -> None:
        self._dictionary = dictionary
        self._transfer: _Transfer | None = None

    def reset(self) -> None:
        """Forget a transfer on its way."""
        self._transfer = None

    def answer(self, request: bytes) -> bytes | None:
        """Return the answer to a request of 8 bytes; None: there is none."""
        if len(request) != SIZE:
            return None
        specifier = request[0] >> 5
        if specifier == ABORT:
            self._transfer = None
            return None
        try:
            if specifier == DOWNLOAD:
                return self._download(request)
            if specifier == UPLOAD:
                return self._upload(request)
            if specifier == DOWNLOAD_SEGMENT:
                return self._download_segment(request)
            if specifier == UPLOAD_SEGMENT:
                return self._upload_segment(request)
            raise SdoAbort(UNKNOWN_COMMAND)
        except SdoAbort as refused:
            return self._aborted(request, refused.code)

    def _download(self, request: bytes) -> bytes:
        command, index, subindex = _HEAD.unpack_from(request)
        self._transfer = None
        if command & _EXPEDITED:
            if command & _HAS_SIZE:
                size = 4 - (command >> 2 & 3)
            else:
                size = min(4, self._dictionary.size(index, subindex) or 4)
            self._dictionary.write(index, subindex, request[4:4 + size])
        else:
            self._dictionary.size(index, subindex)  # refuses what does not exist
            expected = int.from_bytes(request[4:], 'little') if command & _HAS_SIZE else None
            if expected is not None and expected > MOST_BYTES:
                raise SdoAbort(OUT_OF_MEMORY)
            self._transfer = _Transfer(index, subindex, is_download=True, expected=expected)
        return _padded(_HEAD.pack(_ANSWER_DOWNLOAD << 5, index, subindex))

    def _download_segment(self, request: bytes) -> bytes:
        transfer = self._continued(request[0], is_download=True)
        transfer.data += request[1:SIZE - (request[0] >> 1 & 7)]
        limit = MOST_BYTES if transfer.expected is None else transfer.expected
        if len(transfer.data) > limit:
            raise SdoAbort(OUT_OF_MEMORY if transfer.expected is None else TOO_LONG)
        if request[0] & _IS_LAST:
            if transfer.expected is not None and len(transfer.data) < transfer.expected:
                raise SdoAbort(TOO_SHORT)
            self._dictionary.write(transfer.index, transfer.subindex, bytes(transfer.data))
            self._transfer = None
        return _padded(bytes([_ANSWER_DOWNLOAD_SEGMENT << 5 | request[0] & _TOGGLE]))

    def _upload(self, request: bytes) -> bytes:
        _, index, subindex = _HEAD.unpack_from(request)
        self._transfer = None
        data = self._dictionary.read(index, subindex)
        if 0 < len(data) <= 4:
            command = _ANSWER_UPLOAD << 5 | 4 - len(data) << 2 | _EXPEDITED | _HAS_SIZE
            return _padded(_HEAD.pack(command, index, subindex) + data)
        self._transfer = _Transfer(index, subindex, is_download=False, data=bytearray(data))
        return _HEAD.pack(_ANSWER_UPLOAD << 5 | _HAS_SIZE, index, subindex) \
            + len(data).to_bytes(4, 'little')

    def _upload_segment(self, request: bytes) -> bytes:
        transfer = self._continued(request[0], is_download=False)
        segment = bytes(transfer.data[:SEGMENT_BYTES])
        del transfer.data[:SEGMENT_BYTES]
        command = request[0] & _TOGGLE | SEGMENT_BYTES - len(segment) << 1
        if not transfer.data:
            command |= _IS_LAST
            self._transfer = None
        return _padded(bytes([_ANSWER_UPLOAD_SEGMENT << 5 | command]) + segment)

    def _continued(self, command: int, *, is_download: bool) -> _Transfer:
        transfer = self._transfer
        if transfer is None or transfer.is_download != is_download:
            raise SdoAbort(UNKNOWN_COMMAND)
        if command & _TOGGLE != transfer.toggle:
            raise SdoAbort(TOGGLE_BIT)
        transfer.toggle ^= _TOGGLE
        return transfer

    def _aborted(self, request: bytes, code: int) -> bytes:
        index, subindex = 0, 0
        if self._transfer is not None:
            index, subindex = self._transfer.index, self._transfer.subindex
        elif request[0] >> 5 not in (DOWNLOAD_SEGMENT, UPLOAD_SEGMENT):
            _, index, subindex = _HEAD.unpack_from(request)
        self._transfer = None
        return _ABORT.pack(ABORT << 5, index, subindex, code)


def _padded(answer: bytes) -> bytes:
    return answer.ljust(SIZE, b'\0')
