"""Sync managers: mailboxes that are full or empty, buffers of process data, protection."""

import struct

import pytest
from tests.fieldbus.ethercat.raw_master import APRD, at, OP, PREOP, RawMaster, SAFEOP, Sent

UPLOAD = struct.pack('<HBHBI', 0x2000, 0x40, 0x1000, 0, 0)


def read_counter(master: RawMaster, offset: int, size: int) -> int:
    """Return the working counter of a read."""
    return master.send(Sent(APRD, at(0, offset), bytes(size)))[0].counter


@pytest.fixture
def preoperational() -> RawMaster:
    """Return a slave in PREOP."""
    master = RawMaster()
    master.bring_up(PREOP)
    return master


def test_an_empty_mailbox_is_not_read(preoperational):
    assert preoperational.number(0x080D, 1) & 8 == 0
    assert read_counter(preoperational, 0x1100, 256) == 0


def test_a_mailbox_is_full_until_its_last_byte_is_read(preoperational):
    preoperational.post(UPLOAD)
    assert preoperational.number(0x080D, 1) & 8
    assert read_counter(preoperational, 0x1100, 255) == 1
    assert preoperational.number(0x080D, 1) & 8
    assert read_counter(preoperational, 0x11FF, 1) == 1
    assert preoperational.number(0x080D, 1) & 8 == 0


def test_a_mailbox_is_opened_at_its_first_byte(preoperational):
    preoperational.post(UPLOAD)
    assert read_counter(preoperational, 0x1101, 255) == 0
    assert preoperational.write(0x1001, bytes(255)) == 0


def test_a_mailbox_is_not_used_in_the_wrong_direction(preoperational):
    preoperational.post(UPLOAD)
    assert read_counter(preoperational, 0x1000, 256) == 0
    assert preoperational.write(0x1100, bytes(256)) == 0


def test_a_mailbox_is_locked_in_init():
    master = RawMaster()
    master.configure_mailboxes()
    assert master.number(0x0807, 1) & 1
    assert master.post(UPLOAD) == 0


def test_process_data_are_locked_below_safeop(preoperational):
    preoperational.configure_process_data()
    assert read_counter(preoperational, 0x1E00, 6) == 0
    assert preoperational.write(0x1200, bytes(6)) == 0
    preoperational.request(SAFEOP)
    assert read_counter(preoperational, 0x1E00, 6) == 1
    assert preoperational.write(0x1200, bytes(6)) == 1


def test_memory_without_a_sync_manager_is_plain(preoperational):
    assert preoperational.write(0x2F00, b'abc') == 1
    assert preoperational.read(0x2F01, 2) == b'bc'


def test_inputs_read_in_two_parts_are_of_one_tick():
    """A tick between both parts does not change what is being read."""
    master = RawMaster()
    master.bring_up(OP)
    master.toys[0].target = 0x01020304
    master.tick()
    first = master.read(0x1E00, 4)
    master.toys[0].target = 0x05060708
    master.tick()
    assert struct.unpack('<Hi', first + master.read(0x1E04, 2)) == (1, 0x01020304)
    assert struct.unpack('<Hi', master.read(0x1E00, 6)) == (2, 0x05060708)


def test_an_active_sync_manager_keeps_its_setup(preoperational):
    """As the ET1100: address, length and control are writable only while it is off."""
    preoperational.write(0x0800, struct.pack('<HHBBBB', 0x1080, 64, 0x22, 0, 1, 0))
    assert preoperational.read(0x0800, 5) == struct.pack('<HHB', 0x1000, 256, 0x26)
    assert preoperational.number(0x0130) == PREOP


def test_status_tells_who_used_the_buffer_last(preoperational):
    preoperational.post(UPLOAD)
    assert preoperational.number(0x0805, 1) == 0x02  # the application has read the request
    assert preoperational.number(0x080D, 1) == 0x09  # and written the answer
    preoperational.fetch()
    assert preoperational.number(0x080D, 1) == 0x02


def test_inputs_that_waited_for_a_read_are_put_once():
    """Those of the tick between both parts do not come back after newer ones were read."""
    master = RawMaster()
    master.bring_up(OP)
    master.read(0x1E00, 4)
    master.tick()
    master.read(0x1E04, 2)
    master.tick()
    assert [struct.unpack('<Hi', master.read(0x1E00, 6))[0] for _ in range(3)] == [2, 2, 2]
