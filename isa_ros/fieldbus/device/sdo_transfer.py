"""What SDO transfers of CANopen and EtherCAT share: commands, and segments on their way."""

import struct

from isa_ros.fieldbus.device.abort import (
    OUT_OF_MEMORY, SdoAbort, TOGGLE_BIT, TOO_LONG, TOO_SHORT, UNKNOWN_COMMAND)

HEAD = struct.Struct('<BHB')        # command, index, subindex
INITIATE = struct.Struct('<BHBI')   # and 4 bytes of data, of a size, or of an abort code
COMMAND_BITS = 5
DOWNLOAD_SEGMENT, DOWNLOAD, UPLOAD, UPLOAD_SEGMENT, ABORT = range(5)
"""Commands of a client, in the top three bits."""
UPLOADED_SEGMENT, DOWNLOADED_SEGMENT, UPLOADED, DOWNLOADED = range(4)
"""Answers of a server, in the top three bits."""
TOGGLE = 0x10
EXPEDITED, HAS_SIZE, IS_LAST = 0x02, 0x01, 0x01
EXPEDITED_BYTES, LEAST_SEGMENT = 4, 7


class Transfer:
    """A transfer in segments; ``expected`` are the bytes of a download, None: not announced."""

    def __init__(
            self, index: int, subindex: int, data: bytes = b'', *, is_download: bool,
            expected: int | None = None, most: int = 0, is_complete: bool = False) -> None:
        self.index, self.subindex = index, subindex
        self.is_complete = is_complete
        """Whether it is of all entries of the object."""
        self.data = bytearray(data)
        """What is still to send, or has been received so far."""
        self._is_download, self._expected, self._most = is_download, expected, most
        self._toggle = 0

    def take(self, request: bytes, unused: int) -> bool:
        """Take a segment without its last bytes; return whether it was the last one."""
        self.data += request[1:len(request) - unused]
        if self._expected is None and len(self.data) > self._most:
            raise SdoAbort(OUT_OF_MEMORY)
        if self._expected is not None and len(self.data) > self._expected:
            raise SdoAbort(TOO_LONG)
        is_last = bool(request[0] & IS_LAST)
        if is_last and self._expected is not None and len(self.data) < self._expected:
            raise SdoAbort(TOO_SHORT)
        return is_last

    def give(self, command: int, room: int) -> bytes:
        """Return the answer with the next segment, of at most ``room`` bytes."""
        part = bytes(self.data[:room])
        del self.data[:room]
        unused = max(0, LEAST_SEGMENT - len(part))
        answer = UPLOADED_SEGMENT << COMMAND_BITS | command & TOGGLE | unused << 1
        if not self.data:
            answer |= IS_LAST
        return bytes([answer]) + part.ljust(LEAST_SEGMENT, b'\0')

    def refuse_other(self, command: int) -> None:
        """Refuse a segment of another transfer, or one that comes twice."""
        if self._is_download != (command >> COMMAND_BITS == DOWNLOAD_SEGMENT):
            raise SdoAbort(UNKNOWN_COMMAND)
        if command & TOGGLE != self._toggle:
            raise SdoAbort(TOGGLE_BIT)
        self._toggle ^= TOGGLE


def refuse_size(size: int, most: int) -> None:
    """Refuse a download that is announced as longer than ``most`` bytes."""
    if size > most:
        raise SdoAbort(OUT_OF_MEMORY)


def uploaded(index: int, subindex: int, data: bytes, flags: int = 0) -> bytes:
    """Return the answer with 1 to 4 bytes, or with the size of others."""
    head = UPLOADED << COMMAND_BITS | HAS_SIZE | flags
    if 0 < len(data) <= EXPEDITED_BYTES:
        head |= EXPEDITED | EXPEDITED_BYTES - len(data) << 2
        return HEAD.pack(head, index, subindex) + data.ljust(EXPEDITED_BYTES, b'\0')
    return INITIATE.pack(head, index, subindex, len(data))


def aborted(index: int, subindex: int, refused: SdoAbort) -> bytes:
    """Return the abort of a transfer, which is a request in either direction."""
    return INITIATE.pack(ABORT << COMMAND_BITS, index, subindex, refused.code)
