"""The SII: what a master reads of it, by the offsets of ETG.2010, and its registers."""

from collections.abc import Iterator
import struct

from isa_ros.fieldbus.ethercat.eeprom import Eeprom
from isa_ros.fieldbus.ethercat.registers import power_on
from isa_ros.fieldbus.ethercat.sii import build_sii, checksum
import pytest
from tests.fieldbus.ethercat.raw_master import RawMaster
from tests.fieldbus.toys import Toy


def categories(image: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield number and content of each category."""
    at = 0x80
    while True:
        kind, words = struct.unpack_from('<HH', image, at)
        if kind == 0xFFFF:
            return
        yield kind, bytes(image[at + 4:at + 4 + 2 * words])
        at += 4 + 2 * words


def texts(content: bytes) -> list[str]:
    """Return the texts of the category of strings."""
    found, at = [], 1
    for _ in range(content[0]):
        found.append(content[at + 1:at + 1 + content[at]].decode())
        at += 1 + content[at]
    return found


@pytest.fixture(scope='module')
def image() -> bytes:
    """Return the SII of a toy."""
    return bytes(build_sii(Toy('joint', 7)))


def test_identity_and_mailboxes_are_where_masters_look(image):
    assert struct.unpack_from('<IIII', image, 2 * 0x08) == (0xBAD, 7, 1, 1)
    assert struct.unpack_from('<HHHH', image, 2 * 0x18) == (0x1000, 256, 0x1100, 256)
    assert struct.unpack_from('<H', image, 2 * 0x1C) == (0x0004,)
    assert struct.unpack_from('<HHHH', image, 2 * 0x14) == (0, 0, 0, 0)  # no bootstrap


def test_the_size_is_that_of_the_image(image):
    kibit = struct.unpack_from('<H', image, 2 * 0x3E)[0] + 1
    assert len(image) == kibit * 128


def test_the_checksum_is_the_crc_of_seven_words(image):
    head = bytes.fromhex('05080344 0a000000 00000000 0000')
    assert checksum(head) == divided(head)
    assert checksum(image[:14]) == image[14]


def divided(content: bytes) -> int:
    """Return the CRC by division of polynomials, bit by bit."""
    bits = [int(bit) for byte in content for bit in f'{byte:08b}']
    bits[:8] = [bit ^ 1 for bit in bits[:8]]
    bits += [0] * 8
    for k in range(len(bits) - 8):
        if bits[k]:
            for offset in (0, 6, 7, 8):
                bits[k + offset] ^= 1
    return int(''.join(map(str, bits[-8:])), 2)


def test_categories_describe_the_device(image):
    found = dict(categories(image))
    strings = texts(found[10])
    assert strings[0] == 'joint'
    assert strings[found[30][3] - 1] == 'joint'
    assert found[30][5] == 0x2F
    assert found[40] == bytes([1, 2, 3, 0])
    managers = [struct.unpack_from('<HHBBBB', found[41], 8 * k) for k in range(4)]
    assert managers == [
        (0x1000, 256, 0x26, 0, 1, 1), (0x1100, 256, 0x22, 0, 1, 2),
        (0x1200, 6, 0x64, 0, 1, 3), (0x1E00, 6, 0x20, 0, 1, 4)]
    for kind, pdo, manager, entries in (
            (51, 0x1600, 2, [(0x6040, 6, 16), (0x607A, 4, 32)]),
            (50, 0x1A00, 3, [(0x6041, 6, 16), (0x6064, 4, 32)])):
        assert struct.unpack_from('<HBB', found[kind]) == (pdo, 2, manager)
        rows = [struct.unpack_from('<HBBBBH', found[kind], 8 + 8 * k) for k in range(2)]
        assert [(row[0], row[3], row[4]) for row in rows] == entries
    assert strings[found[51][8 + 3] - 1] == 'control word'
    assert [struct.unpack_from('<H', found[60], at + 14)[0] for at in (0, 24)] == [0, 0x0300]


def command(master: RawMaster, command: int, address: int) -> int:
    """Write address and command as masters do, in one datagram; return the status."""
    assert master.write(0x0502, struct.pack('<HI', command, address)) == 1
    return master.number(0x0502)


def test_the_master_reads_four_words(image):
    master = RawMaster(Toy('joint', 7))
    for word in (0, 8, 10, 0x40):
        assert command(master, 0x0100, word) == 0x0040
        assert master.read(0x0508, 8) == image[2 * word:2 * word + 8]
    command(master, 0x0100, 0xFFFF_FFF0)
    assert master.read(0x0508, 8) == b'\xff' * 8


def test_a_word_is_written_with_leave_only():
    master = RawMaster()
    master.write(0x0508, b'\x34\x12')
    assert command(master, 0x0200, 0x20) == 0x4040
    assert command(master, 0x0201, 0x20) == 0x0040
    command(master, 0x0100, 0x20)
    assert master.read(0x0508, 2) == b'\x34\x12'
    assert command(master, 0x0201, 0x10_0000) == 0x2040


def test_commands_are_refused_while_the_application_has_the_sii():
    master = RawMaster()
    master.write(0x0500, b'\x01')
    assert command(master, 0x0100, 0) == 0x2040
    master.write(0x0500, b'\x00')
    assert command(master, 0x0100, 0) == 0x0040
    assert command(master, 0x0700, 0) == 0x2040
    assert command(master, 0x0000, 0) == 0x0040


def test_a_wrong_checksum_is_shown_and_the_alias_kept():
    memory = power_on()
    eeprom = Eeprom(memory, build_sii(Toy()))
    eeprom.image[8] = 5
    memory[0x0502:0x0504] = struct.pack('<H', 0x0400)
    eeprom.execute()
    assert struct.unpack_from('<H', memory, 0x0502) == (0x0840,)
    assert struct.unpack_from('<H', memory, 0x0012) == (0,)
