"""
The object dictionary of one device: values by index and subindex, read and written by their rules.

Values that change by themselves are computed when they are read.
"""

from collections.abc import Callable, Mapping
import math

from isa_ros.fieldbus.device.abort import (
    NO_COMPLETE_ACCESS, OUT_OF_RANGE, READ_ONLY, SdoAbort, TOO_HIGH, TOO_LOW, WRITE_ONLY,
    WRONG_LENGTH)
from isa_ros.fieldbus.device.objects import (
    DataType, Object, ObjectCode, ObjectEntry, ObjectTable, Value)

Key = tuple[int, int]
"""Index and subindex."""
LAST_OF_COMMUNICATION = 0x1FFF
"""Objects up to it are those of the bus, CiA 301."""
Actuals = Mapping[Key, Callable[[], Value]]
"""Functions that return the present value of an entry."""


class ObjectDictionary:
    """
    Keeps the values of a table.

    ``admit`` is called with entry and value before a value is written, and raises `SdoAbort` to
    refuse it.
    """

    def __init__(
            self, table: ObjectTable, actuals: Actuals,
            admit: Callable[[ObjectEntry, Value], None]) -> None:
        self.table = table
        self.values: dict[Key, Value] = {
            (one.index, one.subindex): one.default for one in table.entries}
        """Stored values; those of ``actuals`` are not used."""
        self._actuals = actuals
        self._admit = admit

    def restart(self) -> None:
        """Return to the values of power-on, but for the communication area."""
        for entry in self.table.entries:
            if entry.index > LAST_OF_COMMUNICATION and entry.is_writable:
                self.values[entry.index, entry.subindex] = entry.default

    def value(self, key: Key) -> Value:
        """Return the present value of an existing entry."""
        actual = self._actuals.get(key)
        return self.values[key] if actual is None else actual()

    def read(self, index: int, subindex: int) -> bytes:
        """Return the bytes of an entry; raises `SdoAbort`."""
        entry = self.table.entry(index, subindex)
        if not entry.is_readable:
            raise SdoAbort(WRITE_ONLY)
        return entry.data_type.pack(self.value((index, subindex)))

    def write(self, index: int, subindex: int, data: bytes) -> None:
        """Write the bytes of an entry; raises `SdoAbort`."""
        entry = self.table.entry(index, subindex)
        self.values[index, subindex] = self.admitted(entry, data)

    def admitted(self, entry: ObjectEntry, data: bytes) -> Value:
        """Return the value of bytes that may be written; raises `SdoAbort`."""
        if not entry.is_writable:
            raise SdoAbort(READ_ONLY)
        value = entry.data_type.unpack(data)
        refuse_beyond(entry, value)
        self._admit(entry, value)
        return value

    def read_all(self, index: int) -> bytes:
        """Return all entries of an object, subindex 0 as 16 bit; raises `SdoAbort`."""
        first, *others = _complete(self.table.at(index))
        count = self.value((index, first.subindex))
        return DataType.UNSIGNED16.pack(count) + b''.join(
            self.read(index, entry.subindex) for entry in others)

    def write_all(self, index: int, data: bytes) -> None:
        """Write all entries of an object or none, subindex 0 as 16 bit; raises `SdoAbort`."""
        first, *others = _complete(self.table.at(index))
        if len(data) != 2 + sum(entry.bits + 7 >> 3 for entry in others):
            raise SdoAbort(WRONG_LENGTH)
        if int.from_bytes(data[:2], 'little') != self.value((index, first.subindex)):
            raise SdoAbort(OUT_OF_RANGE)
        found: dict[Key, Value] = {}
        offset = 2
        for entry in others:
            size = entry.bits + 7 >> 3
            found[index, entry.subindex] = self.admitted(entry, data[offset:offset + size])
            offset += size
        self.values.update(found)


def _complete(found: Object) -> tuple[ObjectEntry, ...]:
    """Return the entries of an object that has complete access."""
    if found.kind is ObjectCode.VAR or any(not entry.data_type.bits for entry in found.entries):
        raise SdoAbort(NO_COMPLETE_ACCESS)
    return found.entries


def refuse_beyond(entry: ObjectEntry, value: Value) -> None:
    """
    Refuse a value that is not one of the choices or leaves the range of its entry.

    Raises
    ------
    SdoAbort
        With the code of the side that is left.

    """
    if isinstance(value, str):
        return
    place = f'0x{entry.index:04X}:{entry.subindex} {entry.name} = {value:.9g}'
    if entry.choices and value not in entry.choices:
        known = ', '.join(map(str, entry.choices))
        raise SdoAbort(OUT_OF_RANGE, f'{place}, must be {known}')
    if not math.isfinite(value):
        raise SdoAbort(OUT_OF_RANGE, f'{place}, must be finite')
    if value > entry.high:
        raise SdoAbort(TOO_HIGH, f'{place}, must be <= {entry.high:.9g}')
    if value < entry.low:
        raise SdoAbort(TOO_LOW, f'{place}, must be >= {entry.low:.9g}')
