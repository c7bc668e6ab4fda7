"""The mailbox: counters, repetition, errors, and answers that wait."""

import struct

from isa_ros.fieldbus.device.bus_device import Emergency
from isa_ros.fieldbus.ethercat.slave_mailbox import MOST_WAITING
import pytest
from tests.fieldbus.ethercat.raw_master import INIT, PREOP, RawMaster

UPLOAD = struct.pack('<HBHBI', 0x2000, 0x40, 0x1000, 0, 0)


def raw_fetch(master: RawMaster) -> bytes:
    """Return a mail with its header."""
    return master.read(0x1100, 256)


def detail_of(master: RawMaster) -> int:
    """Return the detail of a mailbox error: type 0, then 1 and the detail."""
    kind, content = master.fetch()
    assert kind == 0 and content[:2] == b'\x01\x00'
    return struct.unpack_from('<H', content, 2)[0]


@pytest.mark.parametrize('kind', [1, 2, 4, 5, 15])
def test_other_protocols_are_refused(master, kind):
    """AoE, EoE, FoE, SoE and VoE: error 2, unsupported protocol."""
    assert master.post(bytes(10), kind) == 1
    assert detail_of(master) == 2


@pytest.mark.parametrize(('content', 'length', 'detail'), [
    (UPLOAD, 251, 8), (UPLOAD, 0xFFFF, 8), (b'', 0, 6), (b'\0', 1, 6), (UPLOAD[:6], 6, 6),
    (struct.pack('<H', 0x4000) + bytes(8), 10, 4), (struct.pack('<H', 0x0000), 2, 4)])
def test_a_mail_that_is_wrong_is_answered_by_an_error(master, content, length, detail):
    master.post(content, length=length)
    assert detail_of(master) == detail


def test_mails_of_the_slave_are_counted_from_1_to_7(master):
    counters = []
    for _ in range(9):
        master.post(UPLOAD)
        counters.append(raw_fetch(master)[5] >> 4)
    assert counters == [1, 2, 3, 4, 5, 6, 7, 1, 2]


def test_a_mail_sent_twice_is_answered_once(master):
    master.post(UPLOAD, counter=3)
    assert master.fetch() is not None
    assert master.post(UPLOAD, counter=3) == 1
    assert master.fetch() is None
    assert master.post(UPLOAD, counter=4) == 1
    assert master.fetch() is not None


def test_a_mail_without_a_counter_is_always_answered(master):
    for _ in range(2):
        master.post(UPLOAD, counter=0)
        assert master.fetch() is not None


def test_a_lost_answer_is_repeated_with_its_counter(master):
    master.post(UPLOAD)
    master.post(struct.pack('<HBHBI', 0x2000, 0x40, 0x1008, 0, 0))
    first = raw_fetch(master)
    master.write(0x080E, b'\x03')
    assert master.number(0x080F, 1) & 2
    assert raw_fetch(master) == first
    assert raw_fetch(master)[5] >> 4 == 2
    assert master.fetch() is None


def test_answers_wait_in_order_until_the_mailbox_is_full_of_them(master):
    sent = 0
    while master.post(UPLOAD, counter=0):
        sent += 1
    assert sent == MOST_WAITING + 2  # one answer is in the mailbox, one request in the other
    assert master.number(0x0805, 1) & 8
    for _ in range(sent):
        assert master.fetch() is not None
    assert master.fetch() is None
    assert master.number(0x0805, 1) & 8 == 0


def test_init_discards_what_waits(master):
    master.post(UPLOAD)
    master.request(1)
    master.request(PREOP)
    assert master.fetch() is None


def test_an_emergency_is_a_mail(master):
    """Service 1 of CoE: code, register, 5 bytes."""
    master.toys[0].pending = [Emergency(0x8180, 0x11, b'abcde')]
    master.tick()
    assert master.fetch() == (3, struct.pack('<HHB', 0x1000, 0x8180, 0x11) + b'abcde')


def test_emergencies_beyond_the_room_are_lost_not_kept(master):
    master.toys[0].pending = [Emergency(k, 0, b'') for k in range(100)]
    master.tick()
    found = 0
    while master.fetch() is not None:
        found += 1
    assert found == MOST_WAITING + 1


def test_there_are_no_emergencies_in_init():
    master = RawMaster()
    master.toys[0].pending = [Emergency(1, 0, b'')]
    master.tick()
    master.bring_up(PREOP)
    assert master.fetch() is None


def test_init_forgets_the_counter_of_the_last_mail(master):
    """The first mail of a new session may have it, and is no repetition."""
    master.post(UPLOAD, counter=3)
    assert master.fetch() is not None
    master.request(INIT)
    master.bring_up(PREOP)
    master.post(UPLOAD, counter=3)
    assert master.fetch() is not None
