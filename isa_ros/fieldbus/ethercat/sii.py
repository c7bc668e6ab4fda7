"""
Slave information interface (SII): the EEPROM of a slave, built from its device (ETG.2010).

Words of 16 bit: configuration and identity, then categories. A master reads from it what the
slave is called, which mailboxes it has, and which sync managers carry its process data.
"""

from collections.abc import Iterable, Sequence
import struct

from isa_ros.fieldbus.device.bus_device import BusDevice, RECEIVE_ASSIGNMENT, TRANSMIT_ASSIGNMENT
from isa_ros.fieldbus.ethercat.layout import Area, AREAS
from isa_ros.fieldbus.ethercat.sync_manager import INPUTS, MAILBOX_IN, MAILBOX_OUT, OUTPUTS

ALIAS_WORD, CHECKSUM_WORD = 4, 7
_HEADER_SIZE, _PDI_ON_CHIP = 0x80, 0x80
_IDENTITY, _MAILBOXES, _SIZE = 0x10, 0x30, 0x7C
"""Offsets in bytes: identity, standard mailbox, size and version."""
_COE = 0x0004
"""Mailbox protocols: CAN application protocol over EtherCAT."""
_STRINGS, _GENERAL, _FMMU, _SYNC_MANAGER, _TX_PDO, _RX_PDO, _DC = 10, 30, 40, 41, 50, 51, 60
_FMMU_OUTPUTS, _FMMU_INPUTS, _FMMU_MAILBOX, _FMMU_NONE = 1, 2, 3, 0
_GROUP = 'Drives'
_COE_DETAILS = 0x2F
"""SDO, SDO information, PDO assignment and configuration, complete access."""
_PORTS_MII = 0x0011
_END = 0xFFFF
_POLYNOMIAL = 0x07


def checksum(configuration: bytes | bytearray) -> int:
    """Return the CRC-8 (x^8 + x^2 + x + 1, from 0xFF) of the first seven words."""
    crc = 0xFF
    for byte in configuration:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ _POLYNOMIAL if crc & 0x80 else crc << 1) & 0xFF
    return crc


def build_sii(device: BusDevice) -> bytearray:
    """Return the SII of a device with its present process data; its station alias is 0."""
    strings = _Strings()
    categories = b''.join((
        _category(_GENERAL, _general(strings, device)),
        _category(_FMMU, bytes((_FMMU_OUTPUTS, _FMMU_INPUTS, _FMMU_MAILBOX, _FMMU_NONE))),
        _category(_SYNC_MANAGER, _sync_managers(device)),
        _pdos(_TX_PDO, device, TRANSMIT_ASSIGNMENT, INPUTS, strings),
        _pdos(_RX_PDO, device, RECEIVE_ASSIGNMENT, OUTPUTS, strings),
        _category(_DC, _clock(strings))))
    image = bytearray(_header(device) + _category(_STRINGS, strings.content()) + categories
                      + struct.pack('<H', _END))
    kibit = -(-len(image) * 8 // 1024)
    struct.pack_into('<HH', image, _SIZE, kibit - 1, 1)
    return image.ljust(kibit * 1024 // 8, b'\xff')


class _Strings:
    """The texts of an SII, referred to by their number from 1 on; the first is the name."""

    def __init__(self) -> None:
        self._texts: list[bytes] = []

    def number(self, text: str) -> int:
        """Return the number of a text, 0 (none) if there are too many."""
        encoded = text.encode('ascii', errors='replace')[:255]
        if encoded not in self._texts:
            if len(self._texts) == 255:
                return 0
            self._texts.append(encoded)
        return self._texts.index(encoded) + 1

    def content(self) -> bytes:
        """Return the content of the category."""
        return bytes([len(self._texts)]) + b''.join(
            bytes([len(text)]) + text for text in self._texts)


def _header(device: BusDevice) -> bytes:
    """Return the configuration area, identity and mailboxes."""
    head = bytearray(_HEADER_SIZE)
    struct.pack_into('<H', head, 0, _PDI_ON_CHIP)
    head[2 * CHECKSUM_WORD] = checksum(head[:2 * CHECKSUM_WORD])
    struct.pack_into('<IIII', head, _IDENTITY, *device.identity)
    out, into = AREAS[MAILBOX_OUT], AREAS[MAILBOX_IN]
    struct.pack_into(
        '<HHHHH', head, _MAILBOXES, out.start, out.length, into.start, into.length, _COE)
    return bytes(head)


def _category(kind: int, content: bytes) -> bytes:
    """Return a category: its number, its length in words, its content."""
    words = len(content) + 1 >> 1
    return struct.pack('<HH', kind, words) + content.ljust(2 * words, b'\0')


def _general(strings: _Strings, device: BusDevice) -> bytes:
    """Return the category with name and features."""
    name = strings.number(device.name)
    content = bytearray(32)
    content[0], content[2], content[3] = strings.number(_GROUP), name, name
    content[5] = _COE_DETAILS
    struct.pack_into('<H', content, 16, _PORTS_MII)
    return bytes(content)


def _sync_managers(device: BusDevice) -> bytes:
    """Return start, length, control and use of each sync manager."""
    sizes = process_data_sizes(device)
    return b''.join(_sync_manager(area, sizes.get(number, area.length), number + 1)
                    for number, area in enumerate(AREAS))


def _sync_manager(area: Area, length: int, use: int) -> bytes:
    return struct.pack('<HHBBBB', area.start, length, area.control, 0, int(length > 0), use)


def process_data_sizes(device: BusDevice) -> dict[int, int]:
    """Return the bytes of the sync managers of process data by the PDOs assigned now."""
    return {manager: sum(device.size(pdo) for pdo in device.assigned(assignment))
            for manager, assignment in (
                (OUTPUTS, RECEIVE_ASSIGNMENT), (INPUTS, TRANSMIT_ASSIGNMENT))}


def _pdos(kind: int, device: BusDevice, assignment: int, manager: int,
          strings: _Strings) -> bytes:
    """Return a category for each PDO assigned."""
    return b''.join(_category(kind, _pdo(device, pdo, manager, strings))
                    for pdo in device.assigned(assignment))


def _pdo(device: BusDevice, pdo: int, manager: int, strings: _Strings) -> bytes:
    """Return the description of a PDO and of its entries."""
    mapped = [struct.unpack('<I', device.read(pdo, subindex))[0]
              for subindex in range(1, device.read(pdo, 0)[0] + 1)]
    head = struct.pack('<HBBBBH', pdo, len(mapped), manager, 0,
                       strings.number(device.table.at(pdo).name), 0)
    return head + b''.join(_entries(device, mapped, strings))


def _entries(device: BusDevice, mapped: Sequence[int], strings: _Strings) -> Iterable[bytes]:
    """Yield the entries of a PDO; index 0 is a gap."""
    for one in mapped:
        index, subindex, bits = one >> 16, one >> 8 & 0xFF, one & 0xFF
        entry = device.table.entry(index, subindex) if index else None
        yield struct.pack(
            '<HBBBBH', index, subindex, strings.number(entry.name) if entry else 0,
            entry.data_type.number if entry else 0, bits, 0)


def _clock(strings: _Strings) -> bytes:
    """Return the operation modes of the clock: without SYNC, and with SYNC0 each cycle."""
    modes = ((0x0000, 'frame'), (0x0300, 'SYNC0'))
    return b''.join(struct.pack('<IIIhHhBBI', 0, 0, 0, 0, activate, 1, strings.number(name), 0, 0)
                    for activate, name in modes)
