"""
The electronic data sheet (EDS, CiA 306) of a device on CANopen, from its object table.

It has the keys of the standard and no others: strict readers, Lely's ``dcfgen`` among them, refuse
a file with ``Unit`` or ``Factor``. Unit, SI per count and meaning of an entry are a comment above
its section. The default of a REAL32 is its IEEE 754 bits in hexadecimal digits (CiA 306, 4.6.3.3).
"""

from collections.abc import Iterator

from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.device.objects import DataType, Object, ObjectCode, ObjectEntry
from isa_ros.fieldbus.device.process_data import CAN_PDOS

VENDOR_NAME = 'isa_ros (placeholder, no assigned vendor id)'
_DATE = '11-22-2026'
"""Of revision 1 of the object tables."""
_BAUD_RATES = (10, 20, 50, 125, 250, 500, 800, 1000)
_MANDATORY = (0x1000, 0x1001, 0x1018)
_MANUFACTURER = range(0x2000, 0x6000)
_ACCESS = {'rx': 'rww', 'tx': 'ro'}
"""Access of mappable entries."""
_KINDS = {ObjectCode.VAR: '0x7', ObjectCode.ARRAY: '0x8', ObjectCode.RECORD: '0x9'}


def eds_text(device: BusDevice) -> str:
    """Return the EDS of a device."""
    return '\n'.join(_lines(device)) + '\n'


def _lines(device: BusDevice) -> Iterator[str]:
    objects = device.table.on('canopen').objects
    model = device.read(0x1009, 0).decode('ascii')
    yield from _section('FileInfo', [
        ('FileName', f'{model}.eds'), ('FileVersion', '1'),
        ('FileRevision', str(device.identity.revision)), ('EDSVersion', '4.0'),
        ('Description', f'simulated hydraulic actuator {model}'), ('CreationTime', '12:00AM'),
        ('CreationDate', _DATE), ('CreatedBy', 'isa_ros'), ('ModificationTime', '12:00AM'),
        ('ModificationDate', _DATE), ('ModifiedBy', 'isa_ros')])
    yield from _device_information(device, model)
    yield from _section('DummyUsage', [(f'Dummy{k:04X}', '0') for k in range(1, 8)])
    yield from _section('Comments', [('Lines', '0')])
    groups = {
        'MandatoryObjects': [one for one in objects if one.index in _MANDATORY],
        'OptionalObjects': [one for one in objects if one.index not in _MANDATORY
                            and one.index not in _MANUFACTURER],
        'ManufacturerObjects': [one for one in objects if one.index in _MANUFACTURER]}
    for name, group in groups.items():
        yield from _section(name, [('SupportedObjects', str(len(group))), *(
            (str(k + 1), f'0x{one.index:04X}') for k, one in enumerate(group))])
    for one in objects:
        yield from _object(one)


def _section(name: str, keys: list[tuple[str, str]]) -> Iterator[str]:
    yield f'[{name}]'
    yield from (f'{key}={value}' for key, value in keys)
    yield ''


def _comment(entry: ObjectEntry) -> Iterator[str]:
    """Yield unit, scale and meaning of an entry, if it has any; a reader skips the line."""
    scale = f'{entry.scale:g} {entry.unit} a count' if entry.scale != 1.0 else entry.unit
    text = ': '.join(filter(None, (scale, entry.meaning)))
    if text:
        yield f'; {text}'


def _device_information(device: BusDevice, model: str) -> Iterator[str]:
    identity = device.identity
    return _section('DeviceInfo', [
        ('VendorName', VENDOR_NAME), ('VendorNumber', f'0x{identity.vendor:08X}'),
        ('ProductName', model), ('ProductNumber', f'0x{identity.product:08X}'),
        ('RevisionNumber', f'0x{identity.revision:08X}'), ('OrderCode', model),
        *((f'BaudRate_{rate}', '1') for rate in _BAUD_RATES),
        ('SimpleBootUpMaster', '0'), ('SimpleBootUpSlave', '1'), ('Granularity', '8'),
        ('DynamicChannelsSupported', '0'), ('CompactPDO', '0'), ('GroupMessaging', '0'),
        ('NrOfRXPDO', str(CAN_PDOS)), ('NrOfTXPDO', str(CAN_PDOS)), ('LSS_Supported', '1')])


def _object(one: Object) -> Iterator[str]:
    section = f'{one.index:04X}'
    if one.kind is ObjectCode.VAR:
        yield from _comment(one.entries[0])
        yield from _section(section, [('ParameterName', one.name), *_entry(one.entries[0])])
    else:
        yield from _record(section, one)


def _record(section: str, one: Object) -> Iterator[str]:
    yield from _section(section, [
        ('ParameterName', one.name), ('ObjectType', _KINDS[one.kind]),
        ('SubNumber', str(len(one.entries)))])
    for entry in one.entries:
        yield from _comment(entry)
        yield from _section(f'{section}sub{entry.subindex:X}', [
            ('ParameterName', entry.name), *_entry(entry)])


def _entry(entry: ObjectEntry) -> list[tuple[str, str]]:
    keys = [
        ('ObjectType', _KINDS[ObjectCode.VAR]), ('DataType', f'0x{entry.data_type.number:04X}'),
        ('AccessType', _ACCESS.get(entry.pdo, entry.access)), ('DefaultValue', _default(entry)),
        ('PDOMapping', str(int(bool(entry.pdo))))]
    if entry.data_type.is_integer and entry.is_writable:
        low, high = entry.data_type.limits
        if entry.low > low:
            keys.append(('LowLimit', str(int(entry.low))))
        if entry.high < high:
            keys.append(('HighLimit', str(int(entry.high))))
    return keys


def _default(entry: ObjectEntry) -> str:
    if entry.adds_node:
        return f'$NODEID+0x{int(entry.default):X}'
    if entry.data_type is DataType.REAL32:
        bits = int.from_bytes(entry.data_type.pack(entry.default), 'little')
        return f'0x{bits:08X}'
    return str(entry.default)
