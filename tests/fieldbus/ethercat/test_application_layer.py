"""The state machine: every change, every refusal with its code, and recovery."""

import struct

import pytest
from tests.fieldbus.ethercat.raw_master import in_state, INIT, OP, PREOP, RawMaster, SAFEOP

BOOT, ERROR, ACKNOWLEDGE = 3, 0x10, 0x10


@pytest.mark.parametrize('path', [
    (PREOP, SAFEOP, OP, SAFEOP, PREOP, INIT), (PREOP, SAFEOP, OP, INIT),
    (PREOP, SAFEOP, OP, PREOP), (PREOP, SAFEOP, INIT), (PREOP, PREOP, SAFEOP, SAFEOP, OP, OP)])
def test_states_are_reached(path):
    master = RawMaster()
    master.configure_mailboxes()
    master.configure_process_data()
    for state in path:
        assert master.request(state) == (state, 0)


@pytest.mark.parametrize(('state', 'wanted', 'code'), [
    (INIT, SAFEOP, 0x0011), (INIT, OP, 0x0011), (PREOP, OP, 0x0011), (PREOP, BOOT, 0x0011),
    (INIT, BOOT, 0x0013), (INIT, 5, 0x0012), (OP, 15, 0x0012), (PREOP, 0, 0x0012)])
def test_a_wrong_request_is_refused_by_its_code(state, wanted, code):
    master = in_state(state)
    assert master.request(wanted) == (state | ERROR, code)


def test_preop_needs_the_mailboxes_of_the_sii():
    for at, setup in ((0x0800, (0x1000, 255, 0x26)), (0x0800, (0x1002, 256, 0x26)),
                      (0x0800, (0x1000, 256, 0x22)), (0x0808, (0x1100, 512, 0x22)),
                      (0x0808, (0x1100, 256, 0x20))):
        master = RawMaster()
        master.configure_mailboxes()
        master.write(at, bytes(8))
        master.write(at, struct.pack('<HHBBBB', *setup, 0, 1, 0))
        assert master.request(PREOP) == (INIT | ERROR, 0x0016), setup


@pytest.mark.parametrize(('sizes', 'code'), [((5, 6), 0x001D), ((6, 7), 0x001E), ((0, 6), 0x001D)])
def test_safeop_needs_process_data_of_the_right_length(sizes, code):
    master = in_state(PREOP)
    master.configure_process_data(sizes=sizes)
    assert master.request(SAFEOP) == (PREOP | ERROR, code)


def test_safeop_refuses_a_watchdog_shorter_than_a_tick():
    master = in_state(PREOP)
    master.configure_process_data()
    master.write(0x0420, struct.pack('<H', 9))
    assert master.request(SAFEOP) == (PREOP | ERROR, 0x001F)
    master.write(0x0420, struct.pack('<H', 10))
    assert master.request(SAFEOP | ACKNOWLEDGE) == (SAFEOP, 0)


def test_safeop_refuses_a_sync0_that_is_not_the_tick():
    master = in_state(PREOP)
    master.configure_process_data()
    master.write(0x09A0, struct.pack('<I', 2_000_000))
    master.write(0x0981, b'\x03')
    assert master.request(SAFEOP) == (PREOP | ERROR, 0x0036)
    master.write(0x09A0, struct.pack('<I', 1_000_000))
    assert master.request(SAFEOP | ACKNOWLEDGE) == (SAFEOP, 0)


def test_an_error_stays_until_it_is_acknowledged():
    master = in_state(PREOP)
    master.configure_process_data()
    assert master.request(OP) == (PREOP | ERROR, 0x0011)
    assert master.request(SAFEOP) == (PREOP | ERROR, 0x0011)
    assert master.request(PREOP | ACKNOWLEDGE) == (PREOP, 0)
    assert master.request(SAFEOP) == (SAFEOP, 0)


def test_init_is_accepted_without_acknowledgement():
    master = in_state(PREOP)
    master.request(OP)
    assert master.request(INIT) == (INIT, 0)


def test_the_device_knows_when_operation_begins_and_ends():
    master = in_state(OP)
    toy = master.toys[0]
    assert toy.is_operational
    master.request(SAFEOP)
    assert not toy.is_operational and not toy.was_lost


def test_a_watchdog_ends_operation_as_lost():
    master = in_state(OP)
    master.line.miss()
    assert (master.number(0x0130), master.number(0x0134)) == (SAFEOP | ERROR, 0x001B)
    assert master.toys[0].was_lost
    assert master.request(SAFEOP | ACKNOWLEDGE) == (SAFEOP, 0)
    assert master.request(OP) == (OP, 0)


def test_a_buffer_switched_off_in_operation_ends_it():
    master = in_state(OP)
    master.write(0x0816, b'\0')
    assert (master.number(0x0130), master.number(0x0134)) == (PREOP | ERROR, 0x001D)
    assert master.toys[0].was_lost


def test_a_mailbox_switched_off_leads_to_init():
    master = in_state(OP)
    master.write(0x0806, b'\0')
    assert (master.number(0x0130), master.number(0x0134)) == (INIT | ERROR, 0x0016)


def test_the_identification_asked_for_is_the_alias():
    master = in_state(PREOP)
    master.ring.slaves[0].controller.memory[0x0012] = 9
    assert master.request(PREOP | 0x20) == (PREOP | 0x20, 9)
    assert master.request(PREOP) == (PREOP, 0)
