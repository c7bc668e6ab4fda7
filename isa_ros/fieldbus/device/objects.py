"""
The object table of a device: everything that a master can read, write or map, as data.

Dictionary, SII, ESI, EDS and docs page are made from it. A value on the bus is little endian; its
count times ``scale`` is SI.
"""

from collections.abc import Iterator, Sequence
from enum import Enum
import math
import struct

from isa_ros.core.frozen import frozen
from isa_ros.fieldbus.device.abort import NO_OBJECT, NO_SUBINDEX, SdoAbort, TOO_LONG, TOO_SHORT

Value = int | float | str
"""Content of an entry: an integer, a real number or a text, in which an octet is a letter."""


class DataType(Enum):
    """Types of CiA 301: number, name, bits and the format of `struct`; '' is a text."""

    BOOLEAN = (0x01, 'BOOL', 1, '?')
    INTEGER8 = (0x02, 'SINT', 8, 'b')
    INTEGER16 = (0x03, 'INT', 16, 'h')
    INTEGER32 = (0x04, 'DINT', 32, 'i')
    UNSIGNED8 = (0x05, 'USINT', 8, 'B')
    UNSIGNED16 = (0x06, 'UINT', 16, 'H')
    UNSIGNED32 = (0x07, 'UDINT', 32, 'I')
    REAL32 = (0x08, 'REAL', 32, 'f')
    VISIBLE_STRING = (0x09, 'STRING', 0, '')
    OCTETS_16 = (0x0A, 'OCTET_STRING(16)', 128, '')

    def __init__(self, number: int, short_name: str, bits: int, code: str) -> None:
        self.number = number
        """Index of the type in the dictionary."""
        self.short_name = short_name
        """Name in ESI files (IEC 61131-3)."""
        self.bits = bits
        """Length; 0: that of the text."""
        self.code = code

    @property
    def encoding(self) -> str:
        """Return that of a text."""
        return 'latin-1' if self is DataType.OCTETS_16 else 'ascii'

    @property
    def is_integer(self) -> bool:
        """Return whether values are whole numbers."""
        return self.code not in ('f', '')

    def pack(self, value: Value) -> bytes:
        """Return the bytes of a value; an integer or a real number beyond the range saturates."""
        if isinstance(value, str):
            return value.encode(self.encoding, errors='replace')
        if self.code == 'f':
            return struct.pack('<f', min(max(float(value), -_LARGEST_REAL32), _LARGEST_REAL32)
                               if math.isfinite(value) else value)
        low, high = self.limits
        return struct.pack(f'<{self.code}', min(max(int(value), low), high))

    def unpack(self, data: bytes) -> Value:
        """
        Return the value of bytes.

        Raises
        ------
        SdoAbort
            The length is not that of the type, or a text is not ASCII.

        """
        if not self.code:
            return data.decode(self.encoding, errors='replace')
        size = self.bits + 7 >> 3
        if len(data) != size:
            raise SdoAbort(TOO_LONG if len(data) > size else TOO_SHORT)
        value: Value = struct.unpack(f'<{self.code}', data)[0]
        return value

    @property
    def limits(self) -> tuple[int, int]:
        """Return the least and the greatest integer."""
        if self.name.startswith('INTEGER'):
            return -(1 << self.bits - 1), (1 << self.bits - 1) - 1
        return 0, (1 << self.bits) - 1


_LARGEST_REAL32: float = struct.unpack('<f', b'\xff\xff\x7f\x7f')[0]


@frozen
class ObjectEntry:
    """One value of the dictionary."""

    index: int
    subindex: int
    name: str
    data_type: DataType
    access: str = 'ro'
    """``ro``, ``rw``, ``wo`` or ``const``."""
    default: Value = 0
    unit: str = ''
    """SI unit of the value times ``scale``; '' for codes and bits."""
    scale: float = 1.0
    """SI value of one count."""
    pdo: str = ''
    """Where it can be mapped: '', ``rx`` (from the master), ``tx`` (to it), ``both``."""
    meaning: str = ''
    low: float = -math.inf
    high: float = math.inf
    """Range of what may be written, in counts."""
    choices: tuple[int, ...] = ()
    """The only values that may be written; (): all of the range."""
    source: str = ''
    """Field of `SAMPLE` that it shows; '': another value."""
    adds_node: bool = False
    """Whether the default grows by the CANopen node id."""
    longest: int = 0
    """Bytes of the longest text, where it is longer than the default."""

    @property
    def bits(self) -> int:
        """Return the length; of a text the longest."""
        return self.data_type.bits or 8 * max(self.longest, len(str(self.default)))

    @property
    def is_readable(self) -> bool:
        """Return whether a master may read it."""
        return self.access != 'wo'

    @property
    def is_writable(self) -> bool:
        """Return whether a master may write it."""
        return self.access in ('rw', 'wo')


class ObjectCode(Enum):
    """Kinds of objects of CiA 301 and their numbers."""

    VAR = 7
    ARRAY = 8
    RECORD = 9


@frozen
class Object:
    """All entries of one index."""

    index: int
    name: str
    kind: ObjectCode
    entries: tuple[ObjectEntry, ...]
    """By subindex; without a gap for an array."""
    bus: str = ''
    """The bus it is for: ``ethercat``, ``canopen``; '' for both."""


class ObjectTable:
    """The objects of one device, by index."""

    def __init__(self, objects: Sequence[Object]) -> None:
        self.objects: tuple[Object, ...] = tuple(sorted(objects, key=lambda one: one.index))
        self.entries: tuple[ObjectEntry, ...] = tuple(
            entry for one in self.objects for entry in one.entries)
        self._objects = {one.index: one for one in self.objects}
        self._entries = {(entry.index, entry.subindex): entry for entry in self.entries}

    def __iter__(self) -> Iterator[Object]:
        """Iterate over the objects by index."""
        return iter(self.objects)

    def __contains__(self, key: object) -> bool:
        """Return whether there is an index, or an (index, subindex)."""
        return key in self._objects or key in self._entries

    def at(self, index: int) -> Object:
        """
        Return an object.

        Raises
        ------
        SdoAbort
            There is no such index.

        """
        if index not in self._objects:
            raise SdoAbort(NO_OBJECT)
        return self._objects[index]

    def entry(self, index: int, subindex: int = 0) -> ObjectEntry:
        """
        Return an entry.

        Raises
        ------
        SdoAbort
            There is no such index, or it has no such subindex.

        """
        found = self._entries.get((index, subindex))
        if found is None:
            self.at(index)
            raise SdoAbort(NO_SUBINDEX)
        return found

    def on(self, bus: str) -> 'ObjectTable':
        """Return the table of one bus, ``ethercat`` or ``canopen``."""
        return ObjectTable([one for one in self.objects if one.bus in ('', bus)])


def variable(entry: ObjectEntry, bus: str = '') -> Object:
    """Return an object that is one entry."""
    return Object(entry.index, entry.name, ObjectCode.VAR, (entry,), bus)


def record_of(index: int, name: str, entries: Sequence[ObjectEntry], bus: str = '') -> Object:
    """Return a record: entries of subindex 1 on, behind their highest subindex."""
    count = ObjectEntry(
        index, 0, 'Highest subindex', DataType.UNSIGNED8, 'const', entries[-1].subindex)
    return Object(index, name, ObjectCode.RECORD, (count, *entries), bus)
