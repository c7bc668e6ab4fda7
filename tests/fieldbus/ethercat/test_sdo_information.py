"""SDO information: lists of objects, descriptions, errors, by bytes written by hand."""

import struct

from isa_ros.fieldbus.device import abort
import pytest
from tests.fieldbus.ethercat.raw_master import RawMaster


def ask(master: RawMaster, operation: int, content: bytes) -> tuple[int, int, bytes]:
    """Return operation, fragments left and content of the answer."""
    answer = master.ask(struct.pack('<HBBH', 0x8000, operation, 0, 0) + content)
    return fragment(answer)


def fragment(answer: bytes) -> tuple[int, int, bytes]:
    """Return operation, fragments left and content."""
    service, operation, _, left = struct.unpack_from('<HBBH', answer)
    assert service == 0x8000
    return operation, left, answer[6:]


def listed(master: RawMaster, kind: int) -> list[int]:
    """Return a list of 16 bit numbers."""
    operation, left, content = ask(master, 1, struct.pack('<H', kind))
    while left:
        assert operation == 0x82
        operation, left, more = fragment(master.fetch()[1])
        content += more
    assert operation == 2
    numbers = struct.unpack(f'<{len(content) // 2}H', content)
    assert numbers[0] == kind
    return list(numbers[1:])


def test_the_lists_name_the_objects(master):
    table = master.toys[0].table
    assert listed(master, 1) == [one.index for one in table]
    assert listed(master, 2) == [0x2200, 0x6040, 0x607A]
    assert listed(master, 3) == [0x2200, 0x6041, 0x6064]
    assert listed(master, 4) == listed(master, 5) == []
    assert listed(master, 0) == [len(listed(master, kind)) for kind in range(1, 6)]


def test_a_list_longer_than_a_mail_comes_in_fragments(monkeypatch, master):
    monkeypatch.setattr('isa_ros.fieldbus.ethercat.coe.CAPACITY', 20)
    operation, left, content = ask(master, 1, struct.pack('<H', 1))
    assert (operation, left, len(content)) == (0x82, 2, 14)
    parts = [fragment(master.fetch()[1]) for _ in range(2)]
    assert [(one[0], one[1]) for one in parts] == [(0x82, 1), (2, 0)]
    content += b''.join(one[2] for one in parts)
    assert content == struct.pack('<H', 1) + b''.join(
        struct.pack('<H', one.index) for one in master.toys[0].table)


def test_an_object_is_described(master):
    assert ask(master, 3, struct.pack('<H', 0x1018)) == (
        4, 0, struct.pack('<HHBB', 0x1018, 7, 4, 9) + b'identity')
    assert ask(master, 3, struct.pack('<H', 0x2001)) == (
        4, 0, struct.pack('<HHBB', 0x2001, 9, 0, 7) + b'long text')


@pytest.mark.parametrize(('index', 'subindex', 'kind', 'bits', 'access', 'name'), [
    (0x6040, 0, 6, 16, 0x7F, b'control word'), (0x6041, 0, 6, 16, 0x87, b'status word'),
    (0x2002, 0, 6, 16, 0x38, b'key'), (0x1C12, 1, 6, 16, 0x0F, b'PDO'),
    (0x2001, 0, 9, 5600, 0x3F, b'long text'), (0x1018, 0, 5, 8, 0x07, b'number of entries')])
def test_an_entry_is_described(master, index, subindex, kind, bits, access, name):
    """Access: read and written in PREOP, SAFEOP, OP, then mappable to RxPDO and TxPDO."""
    answer = ask(master, 5, struct.pack('<HBB', index, subindex, 0))
    assert answer == (6, 0, struct.pack('<HBBHHH', index, subindex, 0, kind, bits, access) + name)


@pytest.mark.parametrize(('operation', 'content', 'code'), [
    (3, b'\x99\x99', abort.NO_OBJECT), (5, b'\x18\x10\x09\x00', abort.NO_SUBINDEX),
    (1, b'\x09\x00', abort.OUT_OF_RANGE), (9, b'', abort.UNKNOWN_COMMAND)])
def test_what_is_not_there_is_refused(master, operation, content, code):
    assert ask(master, operation, content) == (7, 0, struct.pack('<I', code))


@pytest.mark.parametrize(
    'asked', [b'', b'\x01\0\0\0', b'\x03\0\0\0\x18', b'\x05\0\0\0\x18\x10'])
def test_a_request_that_is_too_short_is_a_wrong_mail(master, asked):
    master.post(b'\x00\x80' + asked)
    assert master.fetch() == (0, struct.pack('<HH', 1, 6))
