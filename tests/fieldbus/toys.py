"""A small device with every kind of object, for tests of buses."""

import struct

from isa_ros.fieldbus.device import abort
from isa_ros.fieldbus.device.abort import SdoAbort
from isa_ros.fieldbus.device.bus_device import Emergency, Identity, VENDOR
from isa_ros.fieldbus.device.objects import (
    DataType, Object, ObjectCode, ObjectEntry, ObjectTable, Value)
import numpy as np

LONG_TEXT = ''.join(chr(33 + k % 90) for k in range(700))
"""Longer than two mailboxes."""
RX, TX = 0x1600, 0x1A00
OUTPUTS, INPUTS = struct.Struct('<Hi'), struct.Struct('<Hi')
"""Process data: control word and target; status word and position."""


def _record(index: int, name: str, *entries: tuple[str, DataType, Value, str]) -> Object:
    """Return an object of several entries behind their number."""
    rows = [ObjectEntry(index, 0, 'number of entries', DataType.UNSIGNED8,
                        'rw' if entries[0][3] == 'rw' else 'ro', len(entries))]
    rows += [ObjectEntry(index, subindex, one, kind, access, value)
             for subindex, (one, kind, value, access) in enumerate(entries, 1)]
    return Object(index, name, ObjectCode.RECORD, tuple(rows))


def _single(index: int, name: str, kind: DataType, value: Value = 0, access: str = 'ro',
            pdo: str = '') -> Object:
    return Object(index, name, ObjectCode.VAR, (
        ObjectEntry(index, 0, name, kind, access, value, pdo=pdo),))


def _mapped(index: int, bits: int) -> int:
    return index << 16 | bits


def toy_table(identity: Identity, name: str, filler: int = 0) -> ObjectTable:
    """Return the objects of a toy; ``filler`` further double words are mapped in either way."""
    u8, u16, u32 = DataType.UNSIGNED8, DataType.UNSIGNED16, DataType.UNSIGNED32
    more = [('filler', u32, _mapped(0x2200, 32), 'rw')] * filler
    return ObjectTable([
        _single(0x1000, 'device type', u32, 0x00020192),
        _single(0x1008, 'device name', DataType.VISIBLE_STRING, name),
        _record(0x1018, 'identity', *(
            (one, u32, value, 'ro') for one, value in zip(Identity._fields, identity))),
        _record(RX, 'outputs', ('control word', u32, _mapped(0x6040, 16), 'rw'),
                ('target', u32, _mapped(0x607A, 32), 'rw'), *more),
        _record(TX, 'inputs', ('status word', u32, _mapped(0x6041, 16), 'rw'),
                ('position', u32, _mapped(0x6064, 32), 'rw'), *more),
        _record(0x1C00, 'sync manager types', *((f'{k}', u8, k, 'ro') for k in (1, 2, 3, 4))),
        _record(0x1C12, 'outputs assigned', ('PDO', u16, RX, 'rw')),
        _record(0x1C13, 'inputs assigned', ('PDO', u16, TX, 'rw')),
        _single(0x2000, 'gain', DataType.REAL32, 1.5, 'rw'),
        _single(0x2001, 'long text', DataType.VISIBLE_STRING, LONG_TEXT, 'rw'),
        _single(0x2002, 'key', u16, 7, 'wo'),
        _single(0x2200, 'filler', u32, 0, 'rw', 'both'),
        _single(0x6040, 'control word', u16, 0, 'rw', 'rx'),
        _single(0x6041, 'status word', u16, 0, 'ro', 'tx'),
        _single(0x6064, 'position', DataType.INTEGER32, 0, 'ro', 'tx'),
        _single(0x607A, 'target', DataType.INTEGER32, 0, 'rw', 'rx')])


class Toy:
    """A device that answers what it was sent: the status word counts its ticks."""

    def __init__(self, name: str = 'toy', product: int = 1, filler: int = 0) -> None:
        self.name = name
        self.identity = Identity(VENDOR, product, 1, 1)
        self.table = toy_table(self.identity, name, filler)
        self.is_wanted = False
        self.is_operational = False
        self.was_lost = False
        self.restarts: list[bool] = []
        self.received: list[bytes] = []
        self.pending: list[Emergency] = []
        self._values = {(one.index, one.subindex): one.data_type.pack(one.default)
                        for one in self.table.entries}
        self._filler = filler
        self.control = self.target = self.ticks = 0

    def read(self, index: int, subindex: int) -> bytes:
        """Return the bytes of an entry."""
        if not self.table.entry(index, subindex).is_readable:
            raise SdoAbort(abort.WRITE_ONLY)
        return self._values[index, subindex]

    def write(self, index: int, subindex: int, data: bytes, *, is_preoperational: bool) -> None:
        """Write an entry."""
        entry = self.table.entry(index, subindex)
        if not entry.is_writable:
            raise SdoAbort(abort.READ_ONLY)
        if 0x1600 <= index < 0x2000 and not is_preoperational:
            raise SdoAbort(abort.WRONG_STATE)
        entry.data_type.unpack(data)
        self._values[index, subindex] = bytes(data)

    def read_all(self, index: int) -> bytes:
        """Return all entries, the number as 16 bit."""
        entries = self.table.at(index).entries
        if len(entries) == 1:
            raise SdoAbort(abort.NO_COMPLETE_ACCESS)
        values = [self.read(index, one.subindex) for one in entries]
        return values[0] + b'\0' + b''.join(values[1:])

    def write_all(self, index: int, data: bytes, *, is_preoperational: bool) -> None:
        """Write as many entries as there are data."""
        at = 2
        for entry in self.table.at(index).entries:
            if entry.subindex and at >= len(data):
                break
            size = entry.bits // 8
            start = at if entry.subindex else 0
            self.write(index, entry.subindex, data[start:start + size],
                       is_preoperational=is_preoperational)
            at += size if entry.subindex else 0

    def store(self, index: int, subindex: int, value: Value) -> None:
        """Set an entry without checks."""
        self._values[index, subindex] = self.table.entry(index, subindex).data_type.pack(value)

    def assigned(self, assignment: int) -> list[int]:
        """Return the PDOs assigned."""
        number = self._values[assignment, 0][0]
        return [int.from_bytes(self._values[assignment, k + 1], 'little') for k in range(number)]

    def size(self, pdo: int) -> int:
        """Return the bytes of a PDO."""
        number = self._values[pdo, 0][0]
        return sum(self._values[pdo, k + 1][0] for k in range(number)) // 8

    def receive(self, pdo: int, data: bytes) -> None:
        """Take outputs."""
        assert pdo == RX
        self.received.append(data)
        self.control, self.target = OUTPUTS.unpack_from(data)
        self.is_wanted |= self.control != 0

    def transmit(self, pdo: int) -> bytes:
        """Return inputs."""
        assert pdo == TX
        return INPUTS.pack(self.ticks & 0xFFFF, self.target) + bytes(4 * self._filler)

    def begin_operation(self) -> None:
        """Note that operation has begun."""
        self.is_operational, self.was_lost = True, False

    def end_operation(self, is_lost: bool) -> None:
        """Note that operation has ended."""
        self.is_operational, self.was_lost = False, is_lost

    def restart(self, *, is_whole: bool) -> None:
        """Note that power-on is wanted."""
        self.restarts.append(is_whole)

    def emergencies(self) -> list[Emergency]:
        """Return the emergencies since the last call."""
        found, self.pending = self.pending, []
        return found

    def take_sample(self, sample: np.void, tick: int) -> None:
        """Count a tick."""
        self.ticks = tick

    def fill_command(self, command: np.void) -> None:
        """Command nothing."""

    def changes(self) -> dict[str, float]:
        """Return no gains."""
        return {}
