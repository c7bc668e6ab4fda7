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
from isa_ros.fieldbus.ethercat.sdo_information import answer_information
from isa_ros.fieldbus.ethercat.slave_mailbox import (
    CAPACITY, MailError, TOO_SHORT, UNSUPPORTED_SERVICE)

_SERVICE = struct.Struct('<H')
_SERVICE_BITS = 12
EMERGENCY, SDO_REQUEST, SDO_RESPONSE, SDO_INFORMATION = 1, 2, 3, 8
"""Services; those of PDOs by mail (4 to 7) are refused."""
_INITIATE = struct.Struct('<BHBI')
_COMMAND_BITS = 5
_DOWNLOAD_SEGMENT, _DOWNLOAD, _UPLOAD, _UPLOAD_SEGMENT, _ABORT = range(5)
"""Commands of a master, in the top three bits."""
_UPLOADED, _DOWNLOADED, _DOWNLOADED_SEGMENT, _UPLOADED_SEGMENT = 2, 3, 1, 0
"""Answers of a slave, in the top three bits."""
_COMPLETE, _TOGGLE = 0x10, 0x10
_EXPEDITED, _HAS_SIZE = 0x02, 0x01
_LAST_SEGMENT = 0x01
_EXPEDITED_SIZE, _LEAST_SEGMENT = 4, 7
MOST_BYTES = 0x10000
"""Longest object that a master can download."""


class _Transfer:
    """A transfer in segments that is under way."""

    def __init__(self, index: int, subindex: int, is_complete: bool, content: bytes,
                 size: int) -> None:
        self.index, self.subindex, self.is_complete = index, subindex, is_complete
        self.content = bytearray(content)
        """What is still to upload, or has been downloaded so far."""
        self.size = size
        """Bytes of a download when it is complete; 0 for an upload."""
        self.toggle = 0


class CanOverEthercat:
    """The SDO server of a device."""

    def __init__(self, device: BusDevice) -> None:
        self._device, self._table = device, device.table.on('ethercat')
        self.is_preoperational = True
        """Whether mappings may be written."""
        self._transfer: _Transfer | None = None

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
        command = request[0] >> _COMMAND_BITS
        if command in (_DOWNLOAD_SEGMENT, _UPLOAD_SEGMENT):
            return [self._segment(command, request)]
        if len(request) < _INITIATE.size:
            raise MailError(TOO_SHORT)
        self._transfer = None
        if command == _ABORT:
            return []
        _, index, subindex, size = _INITIATE.unpack_from(request)
        try:
            if command == _UPLOAD:
                return [self._upload(request[0], index, subindex)]
            if command == _DOWNLOAD:
                return [self._download(request, index, subindex, size)]
            raise SdoAbort(abort.UNKNOWN_COMMAND)
        except SdoAbort as refused:
            return [_aborted(index, subindex, refused)]

    def _upload(self, command: int, index: int, subindex: int) -> bytes:
        """
        Answer with the content of an entry or object.

        Of one that does not fit into a mail only the size is sent, as CANopen does: all known
        masters accept it, and not all accept a first part here.
        """
        is_complete = bool(command & _COMPLETE)
        content = self._read(index, subindex, is_complete)
        flags = _UPLOADED << _COMMAND_BITS | (command & _COMPLETE) | _HAS_SIZE
        if len(content) <= _EXPEDITED_SIZE and content:
            unused = _EXPEDITED_SIZE - len(content)
            return _response(struct.pack(
                '<BHB', flags | _EXPEDITED | unused << 2, index, subindex) + content.ljust(
                    _EXPEDITED_SIZE, b'\0'))
        head = _INITIATE.pack(flags, index, subindex, len(content))
        if _SERVICE.size + len(head) + len(content) <= CAPACITY:
            return _response(head + content)
        self._transfer = _Transfer(index, subindex, is_complete, content, 0)
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
        if command & _EXPEDITED:
            unused = command >> 2 & 3 if command & _HAS_SIZE else 0
            content = request[4:_INITIATE.size - unused]
        else:
            if size > MOST_BYTES:
                raise SdoAbort(abort.OUT_OF_MEMORY)
            content = request[_INITIATE.size:_INITIATE.size + size]
            if len(content) < size:
                self._transfer = _Transfer(index, subindex, is_complete, content, size)
        if self._transfer is None:
            self._write(index, subindex, is_complete, content)
        return _response(_INITIATE.pack(
            _DOWNLOADED << _COMMAND_BITS | command & _COMPLETE, index, subindex, 0))

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

    def _segment(self, command: int, request: bytes) -> bytes:
        """Answer a segment; one that does not belong to the transfer ends it."""
        transfer = self._transfer
        index, subindex = (transfer.index, transfer.subindex) if transfer else (0, 0)
        try:
            if transfer is None or (command == _UPLOAD_SEGMENT) != (transfer.size == 0):
                raise SdoAbort(abort.UNKNOWN_COMMAND)
            if request[0] & _TOGGLE != transfer.toggle:
                raise SdoAbort(abort.TOGGLE_BIT)
            return (self._next_upload(transfer) if command == _UPLOAD_SEGMENT
                    else self._next_download(transfer, request))
        except SdoAbort as refused:
            self._transfer = None
            return _aborted(index, subindex, refused)

    def _next_upload(self, transfer: _Transfer) -> bytes:
        """Return the next part of an upload."""
        room = CAPACITY - _SERVICE.size - 1
        part = bytes(transfer.content[:room])
        del transfer.content[:room]
        unused = max(0, _LEAST_SEGMENT - len(part))
        flags = _UPLOADED_SEGMENT << _COMMAND_BITS | transfer.toggle | unused << 1
        if not transfer.content:
            flags |= _LAST_SEGMENT
            self._transfer = None
        transfer.toggle ^= _TOGGLE
        return _response(bytes([flags]) + part.ljust(_LEAST_SEGMENT, b'\0'))

    def _next_download(self, transfer: _Transfer, request: bytes) -> bytes:
        """Take the next part of a download; the last one is written."""
        unused = request[0] >> 1 & 7 if len(request) == 1 + _LEAST_SEGMENT else 0
        transfer.content += request[1:len(request) - unused]
        if len(transfer.content) > transfer.size:
            raise SdoAbort(abort.TOO_LONG)
        if request[0] & _LAST_SEGMENT:
            if len(transfer.content) < transfer.size:
                raise SdoAbort(abort.TOO_SHORT)
            self._write(transfer.index, transfer.subindex, transfer.is_complete,
                        bytes(transfer.content))
            self._transfer = None
        flags = _DOWNLOADED_SEGMENT << _COMMAND_BITS | transfer.toggle
        transfer.toggle ^= _TOGGLE
        return _response(bytes([flags]).ljust(_INITIATE.size, b'\0'))


def _service(number: int) -> bytes:
    return _SERVICE.pack(number << _SERVICE_BITS)


def _response(content: bytes) -> bytes:
    return _service(SDO_RESPONSE) + content


def _aborted(index: int, subindex: int, refused: SdoAbort) -> bytes:
    """Return the abort of a transfer, which is a request in either direction."""
    return _service(SDO_REQUEST) + _INITIATE.pack(
        _ABORT << _COMMAND_BITS, index, subindex, refused.code)
