"""
Process data: which entries a PDO holds, and which PDOs EtherCAT exchanges.

CANopen has four PDOs of at most 8 bytes in each direction, EtherCAT one for everything. A mapping
or assignment is written as CiA 301 wants it: its number of entries to 0, the entries, the number.
"""

from collections.abc import Iterable, Sequence
import math
import struct
from typing import NamedTuple

from isa_ros.fieldbus.device.abort import (
    NOT_EMPTIED_FIRST, NOT_MAPPABLE, OUT_OF_RANGE, PDO_TOO_LONG, SdoAbort, TOO_HIGH, WRONG_LENGTH,
    WRONG_STATE)
from isa_ros.fieldbus.device.bus_device import (
    BusDevice, RECEIVE_ASSIGNMENT, TRANSMIT_ASSIGNMENT)
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.objects import (
    DataType, Object, ObjectCode, ObjectEntry, ObjectTable, Value)

RECEIVE, TRANSMIT = 0x1600, 0x1A00
"""The first mapping of each direction."""
CAN_PDOS, CAN_BYTES = 4, 8
"""PDOs of CANopen in each direction, and the bytes of a frame."""
ETHERCAT_PDO = 0x10
"""Place of EtherCAT's PDO: 0x1610 and 0x1A10."""
INTEGER_PDO = 0x11
"""Place of the same without real numbers: 0x1611 and 0x1A11."""
_MOST_ENTRIES = 32
_MOST_BYTES = 128
_ASSIGNED = 4
_NAMES = {ETHERCAT_PDO: 'EtherCAT', INTEGER_PDO: 'EtherCAT integers'}
_GAP = 0
"""Index in a mapping of EtherCAT that stands for unused bits."""

Mapped = Sequence[Key | int]
"""Content of a PDO by default: keys, and bits of a gap."""


class _Layout(NamedTuple):
    """A mapping as it is used at every tick."""

    packing: struct.Struct
    keys: tuple[Key, ...]
    bounded: tuple[ObjectEntry, ...]
    """Integers with a range of their own: a value beyond it is refused."""


def is_mapping(index: int) -> bool:
    """Return whether an object is the mapping of a PDO."""
    return RECEIVE <= index < RECEIVE + 0x200 or TRANSMIT <= index < TRANSMIT + 0x200


def is_changed_in_preop(index: int) -> bool:
    """Return whether an object may be written in the state preoperational only."""
    return is_mapping(index) or index in (RECEIVE_ASSIGNMENT, TRANSMIT_ASSIGNMENT)


def mapping_object(pdo: int, mapped: Mapped, entries: dict[Key, ObjectEntry]) -> Object:
    """Return the object of a mapping; ``entries`` are those of the device by key."""
    is_can = pdo & 0xFF < CAN_PDOS
    place = (pdo & 0xFF) + 1 if is_can else _NAMES[pdo & 0xFF]
    name = f'{"RPDO" if pdo < TRANSMIT else "TPDO"} {place}'
    words = [_word(one, entries) for one in mapped]
    most = CAN_BYTES if is_can else _MOST_ENTRIES
    words += [0] * (most - len(words))
    count = ObjectEntry(pdo, 0, 'Number of mapped objects', DataType.UNSIGNED8, 'rw', len(mapped),
                        meaning='written in PREOP only', high=most)
    return Object(pdo, f'{name} mapping', ObjectCode.ARRAY, (count, *(
        ObjectEntry(pdo, k + 1, f'Mapped object {k + 1}', DataType.UNSIGNED32, 'rw', word)
        for k, word in enumerate(words))), '' if is_can else 'ethercat')


def _word(one: Key | int, entries: dict[Key, ObjectEntry]) -> int:
    if isinstance(one, int):
        return one
    index, subindex = one
    return index << 16 | subindex << 8 | entries[one].bits


def mapped_words(device: BusDevice, pdo: int) -> list[int]:
    """Return the entries in use of a mapping, gaps included."""
    count = device.read(pdo, 0)[0]
    return [int.from_bytes(device.read(pdo, k + 1), 'little') for k in range(count)]


def mapped_keys(device: BusDevice, pdo: int) -> list[Key]:
    """Return what a PDO holds, without gaps."""
    return [(word >> 16, word >> 8 & 0xFF) for word in mapped_words(device, pdo)
            if word >> 16 != _GAP]


def assignment_object(index: int, pdos: Iterable[int]) -> Object:
    """Return 0x1C12 or 0x1C13, with the PDO of EtherCAT assigned; ``pdos`` are all there are."""
    first = RECEIVE if index == RECEIVE_ASSIGNMENT else TRANSMIT
    known = tuple(sorted(pdo for pdo in pdos if (pdo < TRANSMIT) == (first == RECEIVE)))
    count = ObjectEntry(index, 0, 'Number of assigned PDOs', DataType.UNSIGNED8, 'rw', 1,
                        meaning='written in PREOP only', high=_ASSIGNED)
    side = 'RxPDO' if first == RECEIVE else 'TxPDO'
    return Object(index, f'{side} assignment', ObjectCode.ARRAY, (count, *(
        ObjectEntry(index, k + 1, f'Assigned PDO {k + 1}', DataType.UNSIGNED16, 'rw',
                    0 if k else first + ETHERCAT_PDO, choices=known) for k in range(_ASSIGNED))),
                  'ethercat')


class ProcessData:
    """The mappings and assignments of one dictionary, whose ``values`` they are kept in."""

    def __init__(self, table: ObjectTable, values: dict[Key, Value]) -> None:
        self._table = table
        self._values = values
        self._layouts: dict[int, _Layout] = {}

    def restart(self) -> None:
        """Return to the mappings and assignments of power-on."""
        for entry in self._table.entries:
            if is_changed_in_preop(entry.index):
                self._values[entry.index, entry.subindex] = entry.default
        self._layouts.clear()

    def _listed(self, index: int, count: int | None = None) -> list[int]:
        """Return the entries in use of a mapping or assignment."""
        used = self._values[index, 0] if count is None else count
        return [int(self._values[index, k + 1]) for k in range(int(used))]

    def assigned(self, assignment: int) -> list[int]:
        """Return the assigned PDOs in their order."""
        return self._listed(assignment)

    def layout(self, pdo: int) -> _Layout:
        """Return format and keys of a PDO; raises `SdoAbort` for one that does not exist."""
        found = self._layouts.get(pdo)
        if found is None:
            self._table.at(pdo)
            found = self._layouts[pdo] = self._layout_of(pdo, self._listed(pdo))
        return found

    def _layout_of(self, pdo: int, words: Sequence[int]) -> _Layout:
        text, keys, entries = '<', list[Key](), list[ObjectEntry]()
        for word in words:
            if word >> 16 == _GAP:
                text += f'{(word & 0xFF) >> 3}x'
                continue
            keys.append((word >> 16, word >> 8 & 0xFF))
            entries.append(self._table.entry(*keys[-1]))
            text += entries[-1].data_type.code
        found = _Layout(struct.Struct(text), tuple(keys), tuple(
            one for one in entries if one.data_type.is_integer
            and (one.low, one.high) != (-math.inf, math.inf)))
        if found.packing.size > (CAN_BYTES if pdo & 0xFF < CAN_PDOS else _MOST_BYTES):
            raise SdoAbort(PDO_TOO_LONG)
        return found

    def write(self, index: int, subindex: int, value: int, is_preoperational: bool) -> None:
        """Write an entry of a mapping or assignment; raises `SdoAbort`."""
        if not is_preoperational:
            raise SdoAbort(WRONG_STATE)
        if subindex == 0:
            self._refuse(index, self._listed(index, value))
        elif self._values[index, 0]:
            raise SdoAbort(NOT_EMPTIED_FIRST)
        elif value:
            self._refuse(index, [value])
        self._values[index, subindex] = value
        self._layouts.pop(index, None)

    def write_all(self, index: int, data: bytes, is_preoperational: bool) -> None:
        """Write number and entries at once; raises `SdoAbort`, and then nothing is written."""
        if not is_preoperational:
            raise SdoAbort(WRONG_STATE)
        count, *entries = self._table.at(index).entries
        size = entries[0].bits >> 3
        number = int.from_bytes(data[:2], 'little')
        if len(data) < 2 or (len(data) - 2) % size or len(data) - 2 < number * size:
            raise SdoAbort(WRONG_LENGTH)
        if number > count.high:
            raise SdoAbort(TOO_HIGH)
        found = [int.from_bytes(data[2 + k * size:2 + (k + 1) * size], 'little')
                 for k in range(number)]
        self._refuse(index, found)
        for k, value in enumerate(found):
            self._values[index, k + 1] = value
        self._values[index, 0] = number
        self._layouts.pop(index, None)

    def read_all(self, index: int) -> bytes:
        """Return the number of entries as 16 bit, and those in use."""
        entry = self._table.entry(index, 1)
        listed = self._listed(index)
        return DataType.UNSIGNED16.pack(len(listed)) + b''.join(
            entry.data_type.pack(value) for value in listed)

    def _refuse(self, index: int, values: Sequence[int]) -> None:
        """Refuse entries that this mapping or assignment cannot have."""
        if not is_mapping(index):
            if any(value not in self._table.entry(index, 1).choices for value in values):
                raise SdoAbort(OUT_OF_RANGE)
            return
        for word in values:
            self._refuse_object(index, word)
        self._layout_of(index, values)

    def _refuse_object(self, pdo: int, word: int) -> None:
        bits = word & 0xFF
        if word >> 16 == _GAP:
            if pdo & 0xFF < CAN_PDOS or bits % 8 or not bits or word >> 8:
                raise SdoAbort(NOT_MAPPABLE)
            return
        entry = self._table.entry(word >> 16, word >> 8 & 0xFF)
        side = 'rx' if pdo < TRANSMIT else 'tx'
        if entry.pdo not in (side, 'both') or entry.bits != bits:
            raise SdoAbort(NOT_MAPPABLE)
