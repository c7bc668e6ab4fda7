"""
The SDO server of a node: expedited and segmented transfers (CiA 301, 7.2.4).

Block transfers are refused by their code, as CiA 301 allows: a device without them answers
``unknown command``. A request of other than 8 bytes is no request.
"""

from typing import Protocol

from isa_ros.fieldbus.device.abort import SdoAbort, UNKNOWN_COMMAND
from isa_ros.fieldbus.device.sdo_transfer import (
    ABORT, aborted, COMMAND_BITS, DOWNLOAD, DOWNLOAD_SEGMENT, DOWNLOADED, DOWNLOADED_SEGMENT,
    EXPEDITED, EXPEDITED_BYTES, HAS_SIZE, HEAD, LEAST_SEGMENT, refuse_size, TOGGLE, Transfer,
    UPLOAD, UPLOAD_SEGMENT, uploaded)

SIZE = 8                # bytes of every request and answer
MOST_BYTES = 4096       # of a value that is written


class ServedObjects(Protocol):
    """The objects that a server gives access to."""

    def read(self, index: int, subindex: int) -> bytes:
        """Return the bytes of an entry; raises `SdoAbort`."""

    def write(self, index: int, subindex: int, data: bytes) -> None:
        """Write an entry; raises `SdoAbort`."""

    def size(self, index: int, subindex: int) -> int:
        """Return the bytes of an entry's type, 0 for a text; raises `SdoAbort`."""


class SdoServer:
    """Answers the requests of one client."""

    def __init__(self, dictionary: ServedObjects) -> None:
        self._dictionary = dictionary
        self._transfer: Transfer | None = None

    def reset(self) -> None:
        """Forget a transfer on its way."""
        self._transfer = None

    def answer(self, request: bytes) -> bytes | None:
        """Return the answer to a request of 8 bytes; None: there is none."""
        if len(request) != SIZE:
            return None
        command = request[0] >> COMMAND_BITS
        if command == ABORT:
            self._transfer = None
            return None
        try:
            if command == DOWNLOAD:
                return self._download(request)
            if command == UPLOAD:
                return self._upload(request)
            if command in (DOWNLOAD_SEGMENT, UPLOAD_SEGMENT):
                return self._segment(request, command == DOWNLOAD_SEGMENT)
            raise SdoAbort(UNKNOWN_COMMAND)
        except SdoAbort as refused:
            return self._aborted(request, refused)

    def _download(self, request: bytes) -> bytes:
        command, index, subindex = HEAD.unpack_from(request)
        self._transfer = None
        if command & EXPEDITED:
            if command & HAS_SIZE:
                size = EXPEDITED_BYTES - (command >> 2 & 3)
            else:
                size = min(EXPEDITED_BYTES,
                           self._dictionary.size(index, subindex) or EXPEDITED_BYTES)
            self._dictionary.write(index, subindex, request[4:4 + size])
        else:
            self._dictionary.size(index, subindex)  # refuses what does not exist
            expected = int.from_bytes(request[4:], 'little') if command & HAS_SIZE else None
            refuse_size(expected or 0, MOST_BYTES)
            self._transfer = Transfer(
                index, subindex, is_download=True, expected=expected, most=MOST_BYTES)
        return _padded(HEAD.pack(DOWNLOADED << COMMAND_BITS, index, subindex))

    def _upload(self, request: bytes) -> bytes:
        _, index, subindex = HEAD.unpack_from(request)
        self._transfer = None
        data = self._dictionary.read(index, subindex)
        if not 0 < len(data) <= EXPEDITED_BYTES:
            self._transfer = Transfer(index, subindex, data, is_download=False)
        return uploaded(index, subindex, data)

    def _segment(self, request: bytes, is_download: bool) -> bytes:
        transfer = self._transfer
        if transfer is None:
            raise SdoAbort(UNKNOWN_COMMAND)
        transfer.refuse_other(request[0])
        if not is_download:
            answer = transfer.give(request[0], LEAST_SEGMENT)
            if not transfer.data:
                self._transfer = None
            return answer
        if transfer.take(request, request[0] >> 1 & 7):
            self._dictionary.write(transfer.index, transfer.subindex, bytes(transfer.data))
            self._transfer = None
        return _padded(bytes([DOWNLOADED_SEGMENT << COMMAND_BITS | request[0] & TOGGLE]))

    def _aborted(self, request: bytes, refused: SdoAbort) -> bytes:
        index, subindex = 0, 0
        if self._transfer is not None:
            index, subindex = self._transfer.index, self._transfer.subindex
        elif request[0] >> COMMAND_BITS not in (DOWNLOAD_SEGMENT, UPLOAD_SEGMENT):
            _, index, subindex = HEAD.unpack_from(request)
        self._transfer = None
        return aborted(index, subindex, refused)


def _padded(answer: bytes) -> bytes:
    return answer.ljust(SIZE, b'\0')
