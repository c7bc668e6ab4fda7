"""
SDO information (ETG.1000.6): which objects and entries a device has.

A mail has operation (1 byte, bit 7: more fragments follow), reserved (1) and the number of
fragments left (2), then the content of the operation.
"""

from collections.abc import Iterator, Sequence
import struct

from isa_ros.fieldbus.device import abort
from isa_ros.fieldbus.device.abort import SdoAbort
from isa_ros.fieldbus.device.objects import Object, ObjectEntry, ObjectTable
from isa_ros.fieldbus.ethercat.slave_mailbox import MailError, TOO_SHORT

_HEADER = struct.Struct('<BBH')
_LIST, _LIST_ANSWER, _OBJECT, _OBJECT_ANSWER, _ENTRY, _ENTRY_ANSWER, _ERROR = range(1, 8)
_OPERATION, _INCOMPLETE = 0x7F, 0x80
_LENGTHS, _ALL, _RX_MAPPABLE, _TX_MAPPABLE, _BACKUP, _SETTINGS = range(6)
"""Kinds of lists; 0: how long each of the others is."""
_READ, _WRITE, _WRITE_PREOPERATIONAL = 0x07, 0x38, 0x08
"""Access in PREOP, SAFEOP and OP, or in PREOP alone."""
_RX, _TX = 0x40, 0x80
_ASSIGNMENTS_AND_MAPPINGS = (range(0x1600, 0x1C00), range(0x1C10, 0x1C30))


def answer_information(table: ObjectTable, request: bytes, room: int) -> Iterator[bytes]:
    """
    Yield the answers to a request, each at most ``room`` bytes.

    Raises
    ------
    MailError
        The request is shorter than its operation needs.

    """
    if len(request) < _HEADER.size:
        raise MailError(TOO_SHORT)
    operation, content = request[0] & _OPERATION, request[_HEADER.size:]
    try:
        if operation == _LIST:
            yield from _list(table, _number(content, 0, 2), room)
        elif operation == _OBJECT:
            found = table.at(_number(content, 0, 2))
            yield _HEADER.pack(_OBJECT_ANSWER, 0, 0) + _described(found, room - _HEADER.size)
        elif operation == _ENTRY:
            entry = table.entry(_number(content, 0, 2), _number(content, 2, 1))
            yield _HEADER.pack(_ENTRY_ANSWER, 0, 0) + _entry(entry, room - _HEADER.size)
        else:
            raise SdoAbort(abort.UNKNOWN_COMMAND)
    except SdoAbort as refused:
        yield _HEADER.pack(_ERROR, 0, 0) + struct.pack('<I', refused.code)


def _number(content: bytes, at: int, size: int) -> int:
    if len(content) < at + size:
        raise MailError(TOO_SHORT)
    return int.from_bytes(content[at:at + size], 'little')


def _list(table: ObjectTable, kind: int, room: int) -> Iterator[bytes]:
    """Yield the indices of a list, or the lengths of all lists, in as many mails as needed."""
    if kind > _SETTINGS:
        raise SdoAbort(abort.OUT_OF_RANGE)
    numbers = (_indices(table, kind) if kind != _LENGTHS else
               [len(_indices(table, one)) for one in range(_ALL, _SETTINGS + 1)])
    content = struct.pack(f'<H{len(numbers)}H', kind, *numbers)
    size = (room - _HEADER.size) // 2 * 2
    parts = [content[at:at + size] for at in range(0, len(content), size)]
    for left, part in zip(reversed(range(len(parts))), parts):
        yield _HEADER.pack(_LIST_ANSWER | (_INCOMPLETE if left else 0), 0, left) + part


def _indices(table: ObjectTable, kind: int) -> Sequence[int]:
    """Return the indices of a list; none are stored by the device."""
    if kind in (_BACKUP, _SETTINGS):
        return []
    wanted = {_RX_MAPPABLE: ('rx', 'both'), _TX_MAPPABLE: ('tx', 'both')}.get(kind)
    return [one.index for one in table
            if wanted is None or any(entry.pdo in wanted for entry in one.entries)]


def _described(found: Object, room: int) -> bytes:
    """Return index, type, highest subindex, kind and name of an object."""
    entry = found.entries[-1]
    return (struct.pack('<HHBB', found.index, entry.data_type.number, entry.subindex,
                        found.kind.value) + found.name.encode('ascii', 'replace'))[:room]


def _entry(entry: ObjectEntry, room: int) -> bytes:
    """Return type, bits, access and name of an entry."""
    access = (_READ if entry.is_readable else 0) | (_write_access(entry))
    access |= (_RX if entry.pdo in ('rx', 'both') else 0) | (
        _TX if entry.pdo in ('tx', 'both') else 0)
    return (struct.pack('<HBBHHH', entry.index, entry.subindex, 0, entry.data_type.number,
                        entry.bits, access) + entry.name.encode('ascii', 'replace'))[:room]


def _write_access(entry: ObjectEntry) -> int:
    """Return in which states an entry can be written."""
    if not entry.is_writable:
        return 0
    is_mapping = any(entry.index in one for one in _ASSIGNMENTS_AND_MAPPINGS)
    return _WRITE_PREOPERATIONAL if is_mapping else _WRITE
