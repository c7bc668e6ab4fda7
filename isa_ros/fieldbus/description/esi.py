"""
The slave information (ESI, ETG.2000) of devices on EtherCAT as XML, from their object tables.

Devices with the same product have one description: that of the first.
"""

from collections.abc import Iterator, Sequence
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from isa_ros.fieldbus.description.eds import VENDOR_NAME
from isa_ros.fieldbus.device.bus_device import (
    BusDevice, RECEIVE_ASSIGNMENT, TRANSMIT_ASSIGNMENT, VENDOR)
from isa_ros.fieldbus.device.diagnosis import TEXTS
from isa_ros.fieldbus.device.objects import Object, ObjectCode, ObjectEntry
from isa_ros.fieldbus.device.process_data import CAN_PDOS, mapped_words
from isa_ros.fieldbus.ethercat.layout import AREAS
from isa_ros.fieldbus.ethercat.sii import build_sii, process_data_sizes

_GROUP, _ENGLISH = 'Drives', '1033'
_SYNC_MANAGERS = ('MBoxOut', 'MBoxIn', 'Outputs', 'Inputs')
_OUTPUTS, _INPUTS = 2, 3
_FMMUS = ('Outputs', 'Inputs', 'MBoxState')
_PROFILE_OF = 16
"""Place of the profile's number in a product."""
_CONFIGURATION_BYTES = 14
_ACCESS = {'ro': 'ro', 'const': 'ro', 'rw': 'rw', 'wo': 'wo'}
_MAPPABLE = {'rx': 'R', 'tx': 'T', 'both': 'RT'}
_MANDATORY = (0x1000, 0x1018)


def esi_text(devices: Sequence[BusDevice]) -> str:
    """Return the XML of all kinds among devices."""
    root = Element('EtherCATInfo', Version='1.6')
    vendor = SubElement(root, 'Vendor')
    _text(vendor, 'Id', _hexadecimal(VENDOR))
    _text(vendor, 'Name', VENDOR_NAME)
    descriptions = SubElement(root, 'Descriptions')
    group = SubElement(SubElement(descriptions, 'Groups'), 'Group')
    _text(group, 'Type', _GROUP)
    _text(group, 'Name', 'Hydraulic actuators', LcId=_ENGLISH)
    listed = SubElement(descriptions, 'Devices')
    for device in {one.identity.product: one for one in reversed(devices)}.values():
        listed.insert(0, _device(device))
    ElementTree.indent(root)
    return ElementTree.tostring(root, 'unicode', xml_declaration=True) + '\n'


def _text(parent: Element, tag: str, content: object, **attributes: str) -> Element:
    """Add an element with a text."""
    child = SubElement(parent, tag, attributes)
    child.text = str(content)
    return child


def _hexadecimal(number: int, digits: int = 0) -> str:
    return f'#x{number:0{digits}X}'


def _device(device: BusDevice) -> Element:
    """Return the description of a device."""
    identity, model = device.identity, device.read(0x1009, 0).decode('ascii')
    found = Element('Device', Physics='YY')
    _text(found, 'Type', model, ProductCode=_hexadecimal(identity.product, 8),
          RevisionNo=_hexadecimal(identity.revision, 8))
    _text(found, 'Name', f'{model}, simulated', LcId=_ENGLISH)
    _text(found, 'GroupType', _GROUP)
    _profile(found, device)
    for use in _FMMUS:
        _text(found, 'Fmmu', use)
    sizes = process_data_sizes(device)
    for number, (use, area) in enumerate(zip(_SYNC_MANAGERS, AREAS)):
        _text(found, 'Sm', use, DefaultSize=str(sizes.get(number, area.length)),
              StartAddress=_hexadecimal(area.start), ControlByte=_hexadecimal(area.control),
              Enable='1')
    for tag, assignment, manager in (
            ('RxPdo', RECEIVE_ASSIGNMENT, _OUTPUTS), ('TxPdo', TRANSMIT_ASSIGNMENT, _INPUTS)):
        assigned = device.assigned(assignment)
        known = device.table.entry(assignment, 1).choices
        pdos = sorted(known, key=lambda pdo: (pdo & 0xFF < CAN_PDOS, pdo))
        for pdo in pdos:
            found.append(_pdo(device, tag, pdo, manager if pdo in assigned else None))
    mailbox = SubElement(found, 'Mailbox', DataLinkLayer='1')
    SubElement(mailbox, 'CoE', SdoInfo='1', PdoAssign='1', PdoConfig='1', CompleteAccess='1')
    _clock(found)
    _eeprom(found, device)
    return found


def _pdo(device: BusDevice, tag: str, pdo: int, manager: int | None) -> Element:
    found = Element(tag, {} if manager is None else {'Sm': str(manager)})
    _text(found, 'Index', _hexadecimal(pdo))
    _text(found, 'Name', device.table.at(pdo).name.removesuffix(' mapping'))
    for word in mapped_words(device, pdo):
        entry = SubElement(found, 'Entry')
        index, subindex, bits = word >> 16, word >> 8 & 0xFF, word & 0xFF
        _text(entry, 'Index', _hexadecimal(index))
        if index:
            mapped = device.table.entry(index, subindex)
            _text(entry, 'SubIndex', subindex)
            _text(entry, 'BitLen', bits)
            _text(entry, 'Name', mapped.name)
            _text(entry, 'DataType', mapped.data_type.short_name)
        else:
            _text(entry, 'BitLen', bits)
    return found


def _clock(found: Element) -> None:
    clock = SubElement(found, 'Dc')
    for name, description, word in (
            ('Synchron', 'SM synchronous', 0), ('DC', 'DC synchronous', 0x300)):
        mode = SubElement(clock, 'OpMode')
        _text(mode, 'Name', name)
        _text(mode, 'Desc', description)
        _text(mode, 'AssignActivate', _hexadecimal(word))


def _eeprom(found: Element, device: BusDevice) -> None:
    image = build_sii(device)
    eeprom = SubElement(found, 'Eeprom')
    _text(eeprom, 'ByteSize', len(image))
    _text(eeprom, 'ConfigData', image[:_CONFIGURATION_BYTES].hex().upper())


# The dictionary.

def _profile(found: Element, device: BusDevice) -> None:
    profile = SubElement(found, 'Profile')
    _text(profile, 'ProfileNo', device.identity.product >> _PROFILE_OF)
    dictionary = SubElement(profile, 'Dictionary')
    types, objects = SubElement(dictionary, 'DataTypes'), SubElement(dictionary, 'Objects')
    basic: dict[str, int] = {}
    for one in device.table.on('ethercat'):
        _object(objects, one)
        for entry in one.entries:
            basic[_type_name(entry)] = entry.bits
        if one.kind is not ObjectCode.VAR:
            types.append(_record_type(one))
    for name, bits in sorted(basic.items(), reverse=True):
        data_type = Element('DataType')
        _text(data_type, 'Name', name)
        _text(data_type, 'BitSize', bits)
        types.insert(0, data_type)
    messages = SubElement(profile, 'DiagMessages')
    for number, error in enumerate(TEXTS, 1):
        message = SubElement(messages, 'DiagMessage')
        _text(message, 'TextId', _hexadecimal(number, 4))
        _text(message, 'MessageText', error.words, LcId=_ENGLISH)


def _type_name(entry: ObjectEntry) -> str:
    """Return the name of a type; that of a text has its length."""
    name = entry.data_type.short_name
    return name if entry.data_type.bits else f'{name}({entry.bits >> 3})'


def _filled(entry: ObjectEntry) -> int:
    """Return the bits of an entry in complete access, whole bytes."""
    return entry.bits + 7 & ~7


def _places(one: Object) -> Iterator[tuple[ObjectEntry, int]]:
    """Yield the entries with their place in bits; subindex 0 fills 16."""
    place = 0
    for entry in one.entries:
        yield entry, place
        place += _filled(entry) if entry.subindex else 16


def _bits(one: Object) -> int:
    """Return the length of an object in complete access, or of its only entry."""
    if one.kind is ObjectCode.VAR:
        return one.entries[0].bits
    return 16 + sum(_filled(entry) for entry in one.entries if entry.subindex)


def _record_type(one: Object) -> Element:
    found = Element('DataType')
    _text(found, 'Name', f'DT{one.index:04X}')
    _text(found, 'BitSize', _bits(one))
    for entry, place in _places(one):
        item = SubElement(found, 'SubItem')
        _text(item, 'SubIdx', entry.subindex)
        _text(item, 'Name', entry.name)
        _text(item, 'Type', _type_name(entry))
        _text(item, 'BitSize', entry.bits)
        _text(item, 'BitOffs', place)
        _flags(item, entry)
    return found


def _object(objects: Element, one: Object) -> None:
    found, is_variable = SubElement(objects, 'Object'), one.kind is ObjectCode.VAR
    first = one.entries[0]
    _text(found, 'Index', _hexadecimal(one.index, 4))
    _text(found, 'Name', one.name)
    _text(found, 'Type', _type_name(first) if is_variable else f'DT{one.index:04X}')
    _text(found, 'BitSize', _bits(one))
    information = SubElement(found, 'Info')
    if is_variable:
        _default(information, first)
    else:
        for entry in one.entries:
            item = SubElement(information, 'SubItem')
            _text(item, 'Name', entry.name)
            _default(SubElement(item, 'Info'), entry)
    category = 'm' if one.index in _MANDATORY else 'o'
    if is_variable:
        _flags(found, first, category)
    else:
        _text(SubElement(found, 'Flags'), 'Category', category)


def _default(information: Element, entry: ObjectEntry) -> None:
    if data := entry.data_type.pack(entry.default):
        _text(information, 'DefaultData', data.hex().upper())


def _flags(parent: Element, entry: ObjectEntry, category: str = '') -> None:
    flags = SubElement(parent, 'Flags')
    _text(flags, 'Access', _ACCESS[entry.access])
    if category:
        _text(flags, 'Category', category)
    if entry.pdo:
        _text(flags, 'PdoMapping', _MAPPABLE[entry.pdo])
