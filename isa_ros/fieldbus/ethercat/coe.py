"""
CAN application protocol over EtherCAT (ETG.1000.6): SDO transfers and emergencies.

A mail's content is a service in the top four bits of 2 bytes, then that service. An SDO has
command (1 byte), index (2), subindex (1) and 4 bytes of data or size.
"""

from collections.abc import Iterable
import struct

from isa_ros.fieldbus.device import abort
from isa_ros.fieldbus.device.abort import SdoAbort
from isa_ros.fieldbus.device.bus_device import BusDevice, Emergency
from isa_ros.fieldbus.device.sdo_transfer import (
    ABORT, aborted, COMMAND_BITS, DOWNLOAD, DOWNLOAD_SEGMENT, DOWNLOADED, DOWNLOADED_SEGMENT,
    EXPEDITED, EXPEDITED_BYTES, HAS_SIZE, INITIATE, LEAST_SEGMENT, refuse_size, TOGGLE, Transfer,
    UPLOAD, UPLOAD_SEGMENT, uploaded)
from isa_ros.fieldbus.ethercat.sdo_information import answer_information
from isa_ros.fieldbus.ethercat.slave_mailbox import (
    CAPACITY, MailError, TOO_SHORT, UNSUPPORTED_SERVICE)

_SERVICE = struct.Struct('<H')
_SERVICE_BITS = 12
EMERGENCY, SDO_REQUEST, SDO_RESPONSE, SDO_INFORMATION = 1, 2, 3, 8
"""Services; those of PDOs by mail (4 to 7) are refused."""
_COMPLETE = 0x10
"""Bit of a command: all entries of an object."""
MOST_BYTES = 0x10000
"""Longest object that a master can download."""


class CanOverEthercat:
    """The SDO server of a device."""

    def __init__(self, device: BusDevice) -> None:
        self._device, self._table = device, device.table.on('ethercat')
        self.is_preoperational = True
        """Whether mappings may be written."""
        self._transfer: Transfer | None = None

    def reset(self) -> None:
        """Give up a transfer that is under way."""
        self._transfer = None

    def emergency(self, emergency: Emergency) -> bytes:
        """Return the content of a mail for an emergency."""
        return _service(EMERGENCY) + struct.pack('<HB', emergency.code, emergency.register) + (
            emergency.data[:5].ljust(5, b'\0'))

    def answers(self, request: bytes) -> Iterable[bytes]:
        """Return the answers to a mail's content; raises `MailError`."""
        if len(request) < _SERVICE.size:
            raise MailError(TOO_SHORT)
        service, content = _SERVICE.unpack_from(request)[0] >> _SERVICE_BITS, request[2:]
        if service == SDO_REQUEST:
            return self._sdo(content)
        if service == SDO_INFORMATION:
            return [_service(SDO_INFORMATION) + one
                    for one in answer_information(self._table, content, CAPACITY - _SERVICE.size)]
        raise MailError(UNSUPPORTED_SERVICE)

    def _sdo(self, request: bytes) -> list[bytes]:
        """Return the answer to an SDO: a response, an abort, or nothing to an abort."""
        if not request:
            raise MailError(TOO_SHORT)
        command = request[0] >> COMMAND_BITS
        if command in (DOWNLOAD_SEGMENT, UPLOAD_SEGMENT):
            return [self._segment(request, command == DOWNLOAD_SEGMENT)]
        if len(request) < INITIATE.size:
            raise MailError(TOO_SHORT)
        self._transfer = None
        if command == ABORT:
            return []
        _, index, subindex, size = INITIATE.unpack_from(request)
        try:
            if command == UPLOAD:
                return [self._upload(request[0], index, subindex)]
            if command == DOWNLOAD:
                return [self._download(request, index, subindex, size)]
            raise SdoAbort(abort.UNKNOWN_COMMAND)
        except SdoAbort as refused:
            return [_service(SDO_REQUEST) + aborted(index, subindex, refused)]

    def _upload(self, command: int, index: int, subindex: int) -> bytes:
        """
        Answer with the content of an entry or object.

        Of one that does not fit into a mail only the size is sent, as CANopen does: all known
        masters accept it, and not all accept a first part here.
        """
        is_complete = bool(command & _COMPLETE)
        content = self._read(index, subindex, is_complete)
        head = uploaded(index, subindex, content, command & _COMPLETE)
        if 0 < len(content) <= EXPEDITED_BYTES:
            return _response(head)
        if _SERVICE.size + len(head) + len(content) <= CAPACITY:
            return _response(head + content)
        self._transfer = Transfer(index, subindex, content, is_download=False)
        return _response(head)

    def _read(self, index: int, subindex: int, is_complete: bool) -> bytes:
        if not is_complete:
            return self._device.read(index, subindex)
        if subindex > 1:
            raise SdoAbort(abort.UNSUPPORTED_ACCESS)
        return self._device.read_all(index)[2 * subindex:]

    def _download(self, request: bytes, index: int, subindex: int, size: int) -> bytes:
        """Write an entry or object, or begin to collect its segments."""
        command = request[0]
        is_complete = bool(command & _COMPLETE)
        if command & EXPEDITED:
            unused = command >> 2 & 3 if command & HAS_SIZE else 0
            content = request[4:INITIATE.size - unused]
        else:
            refuse_size(size, MOST_BYTES)
            content = request[INITIATE.size:INITIATE.size + size]
            if len(content) < size:
                self._transfer = Transfer(
                    index, subindex, content, is_download=True, expected=size,
                    is_complete=is_complete)
        if self._transfer is None:
            self._write(index, subindex, is_complete, content)
        return _response(INITIATE.pack(
            DOWNLOADED << COMMAND_BITS | command & _COMPLETE, index, subindex, 0))

    def _write(self, index: int, subindex: int, is_complete: bool, content: bytes) -> None:
        if not is_complete:
            self._device.write(
                index, subindex, content, is_preoperational=self.is_preoperational)
            return
        if subindex > 1:
            raise SdoAbort(abort.UNSUPPORTED_ACCESS)
        if subindex == 1:
            content = self._device.read_all(index)[:2] + content
        self._device.write_all(index, content, is_preoperational=self.is_preoperational)

    def _segment(self, request: bytes, is_download: bool) -> bytes:
        """Answer a segment; one that does not belong to the transfer ends it."""
        transfer = self._transfer
        index, subindex = (transfer.index, transfer.subindex) if transfer else (0, 0)
        try:
            if transfer is None:
                raise SdoAbort(abort.UNKNOWN_COMMAND)
            transfer.refuse_other(request[0])
            return _response(self._taken(transfer, request) if is_download
                             else self._next(transfer, request))
        except SdoAbort as refused:
            self._transfer = None
            return _service(SDO_REQUEST) + aborted(index, subindex, refused)

    def _next(self, transfer: Transfer, request: bytes) -> bytes:
        """Return the next part of an upload."""
        answer = transfer.give(request[0], CAPACITY - _SERVICE.size - 1)
        if not transfer.data:
            self._transfer = None
        return answer

    def _taken(self, transfer: Transfer, request: bytes) -> bytes:
        """Take the next part of a download; the last one is written."""
        is_least = len(request) == 1 + LEAST_SEGMENT
        if transfer.take(request, request[0] >> 1 & 7 if is_least else 0):
            self._write(transfer.index, transfer.subindex, transfer.is_complete,
                        bytes(transfer.data))
            self._transfer = None
        flags = DOWNLOADED_SEGMENT << COMMAND_BITS | request[0] & TOGGLE
        return bytes([flags]).ljust(INITIATE.size, b'\0')


def _service(number: int) -> bytes:
    return _SERVICE.pack(number << _SERVICE_BITS)


def _response(content: bytes) -> bytes:
    return _service(SDO_RESPONSE) + content
