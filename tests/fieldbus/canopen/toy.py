"""
A toy drive with the seam of `BusDevice`: CiA 402, a mass that follows its torque, one fault.

A tick of it is `ToyDrive.tick`; what it does is exact and needs no plant.
"""

from isa_ros.fieldbus.device.abort import (
    NOT_EMPTIED_FIRST, NOT_MAPPABLE, OUT_OF_RANGE, READ_ONLY, SdoAbort, WRITE_ONLY, WRONG_STATE)
from isa_ros.fieldbus.device.bus_device import Emergency, Identity, VENDOR
from isa_ros.fieldbus.device.canopen_objects import communication_objects, pdo_parameters
from isa_ros.fieldbus.device.communication_area import error_objects
from isa_ros.fieldbus.device.objects import (
    DataType, Object, ObjectCode, ObjectEntry, ObjectTable, Value)
import numpy as np

STEP_NS = 1_000_000
FAULT_CODE = 0x3210
LOST = 0x8180
U8, U16, U32 = DataType.UNSIGNED8, DataType.UNSIGNED16, DataType.UNSIGNED32
I8, I16, I32, F32 = DataType.INTEGER8, DataType.INTEGER16, DataType.INTEGER32, DataType.REAL32
MAPPINGS = {
    0x1600: ((0x6040, 0, 16), (0x6060, 0, 8), (0x6071, 0, 16)),
    0x1601: ((0x607A, 0, 32), (0x60FF, 0, 32)),
    0x1602: ((0x2010, 1, 32), (0x2010, 2, 32)),
    0x1A00: ((0x6041, 0, 16), (0x6061, 0, 8), (0x6077, 0, 16)),
    0x1A01: ((0x6064, 0, 32), (0x606C, 0, 32)),
    0x1A02: ((0x603F, 0, 16),),
}
LIMITS = {0x6071: 1000, 0x60FF: 500_000}
SLOTS = 8
STATUS = {'disabled': 0x40, 'ready': 0x21, 'switched on': 0x23, 'enabled': 0x27, 'fault': 0x08}
STEPS = {('disabled', 0x6): 'ready', ('ready', 0x7): 'switched on', ('ready', 0xF): 'enabled',
         ('switched on', 0xF): 'enabled', ('enabled', 0x7): 'switched on',
         ('switched on', 0x6): 'ready', ('enabled', 0x6): 'ready'}


def _var(index: int, name: str, data_type: DataType, access: str = 'rw', default: Value = 0,
         pdo: str = '', unit: str = '', scale: float = 1.0) -> Object:
    return Object(index, name, ObjectCode.VAR, (
        ObjectEntry(index, 0, name, data_type, access, default, unit, scale, pdo,
                    low=-LIMITS.get(index, np.inf), high=LIMITS.get(index, np.inf)),))


def _record(index: int, name: str, rows: list[tuple[str, DataType, str, Value, str]],
            access: str = 'const') -> Object:
    return Object(index, name, ObjectCode.RECORD, (
        ObjectEntry(index, 0, 'Highest subindex', U8, access, len(rows)),
        *(ObjectEntry(index, k, text, data_type, own, default, pdo=pdo)
          for k, (text, data_type, own, default, pdo) in enumerate(rows, 1))))


def _mapping(index: int) -> Object:
    rows = [entry << 16 | sub << 8 | bits for entry, sub, bits in MAPPINGS[index]]
    return Object(index, f'Mapping {index:04X}', ObjectCode.RECORD, (
        ObjectEntry(index, 0, 'Number of mapped objects', U8, 'rw', len(rows)),
        *(ObjectEntry(index, k + 1, f'Object {k + 1}', U32, 'rw', rows[k] if k < len(rows) else 0)
          for k in range(SLOTS))))


def toy_table(name: str) -> ObjectTable:
    """Return the objects of a toy."""
    return ObjectTable([
        _var(0x1000, 'Device type', U32, 'const', 0x20192),
        _var(0x1008, 'Device name', DataType.VISIBLE_STRING, 'const', name),
        _var(0x1009, 'Manufacturer hardware version', DataType.VISIBLE_STRING, 'const', 'toy'),
        _record(0x1018, 'Identity', [
            ('Vendor id', U32, 'const', VENDOR, ''), ('Product code', U32, 'const', 7, ''),
            ('Revision', U32, 'const', 1, ''), ('Serial number', U32, 'const', 1, '')]),
        *error_objects(), *communication_objects(STEP_NS),
        *map(_mapping, MAPPINGS),
        *(pdo_parameters(one, is_on=one & 0xFF < 2) for one in MAPPINGS),
        _record(0x2002, 'MIT ranges', [
            ('Position', F32, 'rw', 0.065535, ''), ('Velocity', F32, 'rw', 0.5, ''),
            ('Stiffness', F32, 'rw', 4095.0, ''), ('Damping', F32, 'rw', 40.95, ''),
            ('Effort', F32, 'rw', 1023.75, '')]),
        _var(0x2003, 'Last refusal', DataType.VISIBLE_STRING, 'ro', ''),
        _record(0x2010, 'Impedance', [
            ('Stiffness', F32, 'rw', 0.0, 'rx'), ('Damping', F32, 'rw', 0.0, 'rx'),
            ('Effort', F32, 'rw', 0.0, 'rx')]),
        _record(0x2022, 'Force', [('Measured force', F32, 'ro', 0.0, 'tx')]),
        _var(0x2200, 'Note', DataType.VISIBLE_STRING, 'rw', 'first note'),
        _var(0x603F, 'Error code', U16, 'ro', pdo='tx'),
        _var(0x6040, 'Control word', U16, pdo='rx'),
        _var(0x6041, 'Status word', U16, 'ro', STATUS['disabled'], 'tx'),
        _var(0x6060, 'Modes of operation', I8, pdo='rx'),
        _var(0x6061, 'Mode of operation display', I8, 'ro', pdo='tx'),
        _var(0x6064, 'Position actual value', I32, 'ro', pdo='tx', unit='m', scale=1e-6),
        _var(0x606C, 'Velocity actual value', I32, 'ro', pdo='tx', unit='m/s', scale=1e-6),
        _var(0x6071, 'Target torque', I16, pdo='rx', unit='N', scale=1.0),
        _var(0x6077, 'Torque actual value', I16, 'ro', pdo='tx', unit='N', scale=1.0),
        _var(0x607A, 'Target position', I32, pdo='rx', unit='m', scale=1e-6),
        _var(0x60FF, 'Target velocity', I32, pdo='rx', unit='m/s', scale=1e-6),
        _var(0x6502, 'Supported drive modes', U32, 'ro', 0x10380)])


class ToyDrive:
    """One toy."""

    def __init__(self, name: str = 'kfe', fault_at: int | None = None) -> None:
        self.name = name
        self.identity = Identity(VENDOR, 7, 1, 1)
        self.table = toy_table(name)
        self.is_wanted = False
        self.values: dict[tuple[int, int], Value] = {
            (one.index, one.subindex): one.default for one in self.table.entries}
        self.state, self.ticks, self.fault_at = 'disabled', 0, fault_at
        self.is_operational = False
        self.ended_lost: list[bool] = []
        """For each end of operation, whether the bus was lost."""
        self._news: list[Emergency] = []
        self._register = 0
        self._word = 0
        self.position, self.velocity = 0, 0

    # The bus.

    def read(self, index: int, subindex: int) -> bytes:
        entry = self.table.entry(index, subindex)
        if not entry.is_readable:
            raise SdoAbort(WRITE_ONLY)
        return entry.data_type.pack(self.values[index, subindex])

    def write(
            self, index: int, subindex: int, data: bytes, *, is_preoperational: bool) -> None:
        entry = self.table.entry(index, subindex)
        if not entry.is_writable:
            raise SdoAbort(READ_ONLY)
        value = entry.data_type.unpack(data)
        if not isinstance(value, str) and not entry.low <= value <= entry.high:
            raise SdoAbort(OUT_OF_RANGE)
        if index in MAPPINGS:
            self._refuse_mapping(index, subindex, int(value), is_preoperational)
        self.values[index, subindex] = value
        self.is_wanted |= index == 0x6040 and value != 0

    def _refuse_mapping(self, index: int, subindex: int, value: int, may: bool) -> None:
        if not may:
            raise SdoAbort(WRONG_STATE)
        if subindex and self.values[index, 0]:
            raise SdoAbort(NOT_EMPTIED_FIRST)
        if subindex and value:
            mapped = self.table.entry(value >> 16, value >> 8 & 0xFF)
            if mapped.pdo not in ('both', 'rx' if index < 0x1A00 else 'tx') \
                    or mapped.bits != value & 0xFF:
                raise SdoAbort(NOT_MAPPABLE)
        if not subindex and value > SLOTS:
            raise SdoAbort(OUT_OF_RANGE)

    def read_all(self, index: int) -> bytes:
        raise NotImplementedError

    def write_all(self, index: int, data: bytes, *, is_preoperational: bool) -> None:
        raise NotImplementedError

    def store(self, index: int, subindex: int, value: Value) -> None:
        self.values[index, subindex] = value

    def assigned(self, assignment: int) -> list[int]:
        return [0x1600, 0x1601] if assignment == 0x1C12 else [0x1A00, 0x1A01]

    def _mapped(self, pdo: int) -> list[ObjectEntry]:
        words = [int(self.values[pdo, k + 1]) for k in range(int(self.values[pdo, 0]))]
        return [self.table.entry(word >> 16, word >> 8 & 0xFF) for word in words]

    def size(self, pdo: int) -> int:
        return sum(entry.bits for entry in self._mapped(pdo)) // 8

    def receive(self, pdo: int, data: bytes) -> None:
        for entry in self._mapped(pdo):
            size = entry.bits // 8
            value = entry.data_type.unpack(data[:size])
            self.values[entry.index, entry.subindex] = value
            self.is_wanted |= entry.index == 0x6040 and value != 0
            data = data[size:]

    def transmit(self, pdo: int) -> bytes:
        return b''.join(entry.data_type.pack(self.values[entry.index, entry.subindex])
                        for entry in self._mapped(pdo))

    def begin_operation(self) -> None:
        self.is_operational = True

    def end_operation(self, is_lost: bool) -> None:
        self.is_operational = False
        self.ended_lost.append(is_lost)
        if is_lost and self.state == 'enabled':
            self._fail(LOST)

    def restart(self, *, is_whole: bool) -> None:
        for entry in self.table.entries:
            if entry.is_writable and (is_whole or entry.index in MAPPINGS):
                self.values[entry.index, entry.subindex] = entry.default
        if is_whole:
            self.state = 'disabled'

    def emergencies(self) -> list[Emergency]:
        news, self._news = self._news, []
        return news

    # The run.

    def take_sample(self, sample: np.void, tick: int) -> None:
        raise NotImplementedError

    def fill_command(self, command: np.void) -> None:
        raise NotImplementedError

    def changes(self) -> dict[str, float]:
        return {}

    def tick(self) -> None:
        """Simulate a tick: 1 ms, 1 mN per count and gram; positions and speeds are counts."""
        word, before = int(self.values[0x6040, 0]), self._word
        self._word = word
        if self.ticks == self.fault_at:
            self._fail(FAULT_CODE)
        elif self.state == 'fault':
            if word & 0x80 and not before & 0x80:
                self.state, self.values[0x603F, 0], self._register = 'disabled', 0, 0
                self._news.append(Emergency(0, 0, bytes(5)))
        elif not word & 2:
            self.state = 'disabled'
        else:
            self.state = STEPS.get((self.state, word & 0xF), self.state)
        torque = int(self.values[0x6071, 0]) if self.state == 'enabled' else 0
        if self.state == 'enabled' and self.values[0x6060, 0] == -1:
            torque = round(self._impedance_force())
        self.velocity += torque - self.velocity // 20
        self.position += self.velocity // 1000
        self.ticks += 1
        self.values.update({
            (0x6041, 0): STATUS[self.state], (0x6061, 0): self.values[0x6060, 0],
            (0x6077, 0): torque, (0x2022, 1): float(torque), (0x6064, 0): self.position,
            (0x606C, 0): self.velocity})

    def _impedance_force(self) -> float:
        position = 1e-6 * (int(self.values[0x607A, 0]) - self.position)
        velocity = 1e-6 * (int(self.values[0x60FF, 0]) - self.velocity)
        stiffness, damping, effort = (float(self.values[0x2010, k]) for k in (1, 2, 3))
        return stiffness * position + damping * velocity + effort

    def _fail(self, code: int) -> None:
        self.state, self.values[0x603F, 0], self._register = 'fault', code, 0x05
        self.values[0x6041, 0] = STATUS['fault']
        self._news.append(Emergency(code, self._register, bytes(5)))
