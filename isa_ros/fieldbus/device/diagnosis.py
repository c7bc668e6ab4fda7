"""
The diagnosis history of EtherCAT (ETG.1020), object 0x10F3: the last errors with their times.

A message is 16 bytes: diagnosis code, flags, text and time stamp. The code is that of an
emergency, the text one of `TEXTS`, which the ESI has. The oldest message is overwritten; the
master acknowledges by the subindex of a message, and deletes all by 0.
"""

import struct

from isa_ros.core.conditions import CONDITIONS, ErrorCode
from isa_ros.fieldbus.device.abort import OUT_OF_RANGE, SdoAbort, TOO_HIGH, TOO_LOW
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.faults import OWN_CODES
from isa_ros.fieldbus.device.objects import DataType, Object, ObjectEntry, record_of, Value

DIAGNOSIS = 0x10F3
MESSAGES = 16
_NEWEST, _AVAILABLE, _FIRST = (DIAGNOSIS, 2), (DIAGNOSIS, 4), 6
ACKNOWLEDGED = DIAGNOSIS, 3
_LAST = _FIRST + MESSAGES - 1
TEXTS = tuple(dict.fromkeys([*(one.error for one in CONDITIONS), *OWN_CODES]))
"""The errors by number of their text, from 1 on."""
_MESSAGE = struct.Struct('<HHHHQ')
_EMERGENCY_CODE = 0xE800    # kind of diagnosis code, beside that of the emergency
_ERROR, _LOCAL_TIME = 0x0002, 0x0010    # flags
_SENDS_EMERGENCIES = 0x0001
_NOTHING = '\0' * _MESSAGE.size


def diagnosis_object() -> Object:
    """Return the object; its messages are written by `note_message`."""
    u8 = DataType.UNSIGNED8
    return record_of(DIAGNOSIS, 'Diagnosis history', [
        ObjectEntry(DIAGNOSIS, 1, 'Maximum messages', u8, 'const', MESSAGES),
        ObjectEntry(DIAGNOSIS, 2, 'Newest message', u8, meaning='its subindex; 0: none'),
        ObjectEntry(DIAGNOSIS, 3, 'Newest acknowledged message', u8, 'rw',
                    meaning='its subindex; 0 deletes all'),
        ObjectEntry(DIAGNOSIS, 4, 'New messages available', DataType.BOOLEAN),
        ObjectEntry(DIAGNOSIS, 5, 'Flags', DataType.UNSIGNED16, 'const', _SENDS_EMERGENCIES,
                    meaning='bit 0: emergencies are sent too; the oldest message is overwritten'),
        *(ObjectEntry(DIAGNOSIS, k, f'Diagnosis message {k - _FIRST + 1}', DataType.OCTETS_16,
                      default=_NOTHING, meaning='code, flags, text, time in ns')
          for k in range(_FIRST, _LAST + 1))], 'ethercat')


def note_message(values: dict[Key, Value], error: ErrorCode, t_ns: int) -> None:
    """Write an error, at the simulated time ``t_ns``, over the oldest message."""
    newest = int(values[_NEWEST])
    place = newest + 1 if _FIRST <= newest < _LAST else _FIRST
    values[DIAGNOSIS, place] = _MESSAGE.pack(
        _EMERGENCY_CODE, error.code, _ERROR | _LOCAL_TIME, TEXTS.index(error) + 1,
        t_ns).decode('latin-1')
    values[_NEWEST], values[_AVAILABLE] = place, 1
    if values[ACKNOWLEDGED] == place:
        values[ACKNOWLEDGED] = 0    # it has been overwritten


def refuse_acknowledgement(values: dict[Key, Value], subindex: int) -> None:
    """Refuse to acknowledge what is no message; raises `SdoAbort`."""
    if subindex > _LAST:
        raise SdoAbort(TOO_HIGH, f'0x10F3:3 = {subindex}, must be <= {_LAST}')
    if 0 < subindex < _FIRST:
        raise SdoAbort(TOO_LOW, f'0x10F3:3 = {subindex}, must be 0 or >= {_FIRST}')
    if subindex and values[DIAGNOSIS, subindex] == _NOTHING:
        raise SdoAbort(OUT_OF_RANGE, f'0x10F3:3 = {subindex}, which is no message')


def take_acknowledgement(values: dict[Key, Value]) -> None:
    """Take what has been acknowledged; 0 deletes all messages."""
    if not values[ACKNOWLEDGED]:
        delete_messages(values)
    values[_AVAILABLE] = int(values[_NEWEST] != values[ACKNOWLEDGED])


def delete_messages(values: dict[Key, Value]) -> None:
    """Delete all messages."""
    values[_NEWEST] = values[ACKNOWLEDGED] = values[_AVAILABLE] = 0
    for k in range(_FIRST, _LAST + 1):
        values[DIAGNOSIS, k] = _NOTHING
