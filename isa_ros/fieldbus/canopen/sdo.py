"""
The SDO server of a node (CiA 301, 7.2.4): transfers expedited, in segments or in blocks.

A request of other than 8 bytes is no request.
"""

from typing import Protocol

from isa_ros.fieldbus.canopen.block_download import (
    BLOCK_DOWNLOAD, BlockDownload, END_DOWNLOAD)
from isa_ros.fieldbus.canopen.block_upload import BLOCK_UPLOAD, BlockUpload, INITIATE_BLOCK
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
        self._block: BlockUpload | BlockDownload | None = None

    def reset(self) -> None:
        """Forget a transfer on its way."""
        self._transfer = self._block = None

    def answers(self, request: bytes) -> list[bytes]:
        """Return the frames that answer a request of 8 bytes: one, several of a block, or none."""
        if len(request) != SIZE:
            return []
        command = request[0] >> COMMAND_BITS
        try:
            if isinstance(self._block, BlockDownload) and self._block.takes(request):
                return self._block.take(request)
            if command == ABORT:
                self.reset()
                return []
            if command == BLOCK_DOWNLOAD:
                return [self._into_blocks(request)]
            if command == BLOCK_UPLOAD:
                return self._in_blocks(request)
            if command == DOWNLOAD:
                return [self._download(request)]
            if command == UPLOAD:
                return [self._upload(request)]
            if command in (DOWNLOAD_SEGMENT, UPLOAD_SEGMENT):
                return [self._segment(request, command == DOWNLOAD_SEGMENT)]
            raise SdoAbort(UNKNOWN_COMMAND)
        except SdoAbort as refused:
            return [self._aborted(request, refused)]

    def _in_blocks(self, request: bytes) -> list[bytes]:
        if request[0] & 0x03 != INITIATE_BLOCK:
            if not isinstance(self._block, BlockUpload):
                raise SdoAbort(UNKNOWN_COMMAND)
            found = self._block.answers(request)
            if found is None:
                self._block = None
            return found or []
        self.reset()
        _, index, subindex = HEAD.unpack_from(request)
        segments, threshold = request[4:6]
        data = self._dictionary.read(index, subindex)
        if threshold and len(data) <= threshold:    # the client prefers the other protocol
            return [self._upload(request)]
        self._block = BlockUpload(index, subindex, data, segments)
        return [self._block.initiated()]

    def _into_blocks(self, request: bytes) -> bytes:
        """Begin a download in blocks, or write what it has brought."""
        if not request[0] & END_DOWNLOAD:
            self.reset()
            begun = BlockDownload(request, MOST_BYTES)
            self._dictionary.size(begun.index, begun.subindex)  # refuses what does not exist
            self._block = begun
            return begun.initiated()
        if not isinstance(self._block, BlockDownload):
            raise SdoAbort(UNKNOWN_COMMAND)
        ended = self._block
        self._dictionary.write(ended.index, ended.subindex, ended.content(request))
        self._block = None
        return ended.ended()

    def _download(self, request: bytes) -> bytes:
        command, index, subindex = HEAD.unpack_from(request)
        self.reset()
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
        self.reset()
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
        on_its_way = self._transfer or self._block
        if on_its_way is not None:
            index, subindex = on_its_way.index, on_its_way.subindex
        elif not _is_continued(request):
            _, index, subindex = HEAD.unpack_from(request)
        self.reset()
        return aborted(index, subindex, refused)


def _is_continued(request: bytes) -> bool:
    """Return whether a request belongs to a transfer that has begun, and names no object."""
    command = request[0] >> COMMAND_BITS
    if command == BLOCK_UPLOAD:
        return request[0] & 0x03 != INITIATE_BLOCK
    if command == BLOCK_DOWNLOAD:
        return bool(request[0] & END_DOWNLOAD)
    return command in (DOWNLOAD_SEGMENT, UPLOAD_SEGMENT)


def _padded(answer: bytes) -> bytes:
    return answer.ljust(SIZE, b'\0')
