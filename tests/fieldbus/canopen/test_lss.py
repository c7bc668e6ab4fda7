"""LSS: nodes are found by address, range or fast scan, and given their numbers."""

from collections.abc import Iterator

import canopen
from isa_ros.fieldbus.device.bus_device import Identity
import pytest
from tests.fieldbus.canopen.toy import ToyDrive
from tests.fieldbus.canopen.virtual_bus import (
    Master, OPERATIONAL, PREOPERATIONAL, RESET_COMMUNICATION, RESET_NODE, START, STOP,
    virtual_master)

ADDRESSES = (Identity(0xBAD, 0x01920D9F, 0x10001, 1), Identity(0xBAD, 0x81926CF8, 0x10001, 7))
WAITING, CONFIGURATION = 0, 1
NOT_CONFIGURED = 255


def toys() -> list[ToyDrive]:
    found = [ToyDrive('hfe'), ToyDrive('kfe')]
    for toy, address in zip(found, ADDRESSES):
        toy.identity = address
    return found


@pytest.fixture
def master() -> Iterator[Master]:
    with virtual_master(toys(), unconfigured=True) as one:
        yield one


class Wire:
    """Carries frames of the master of `canopen` to a line, and its answers back."""

    def __init__(self, master: Master, lss: canopen.lss.LssMaster) -> None:
        self._master, self._lss = master, lss

    def send_message(self, identifier: int, data: bytes, remote: bool = False) -> None:
        self._master.send(identifier, bytes(data))
        for answered, content in self._master.received():
            if answered == 0x7E4:
                self._lss.on_message_received(answered, bytearray(content), 0.0)


@pytest.fixture
def lss(master: Master, monkeypatch) -> canopen.lss.LssMaster:
    found = canopen.lss.LssMaster()
    found.network = Wire(master, found)
    found.RESPONSE_TIMEOUT = 0.001
    monkeypatch.setattr(canopen.lss.time, 'sleep', lambda _: None)
    return found


def numbers(master: Master) -> list[int]:
    return [node.number for node in master.line.nodes]


def test_a_node_without_a_number_has_nothing_but_lss(master):
    """No boot-up message, no SDO, no NMT; not even by the identifiers of number 255."""
    assert master.received() == []
    master.command(START)
    master.send(0x6FF, b'\x40\0\x10\0\0\0\0\0')
    master.send(0x601, b'\x40\0\x10\0\0\0\0\0')
    assert not master.send(0x80) and master.received() == []
    assert numbers(master) == [NOT_CONFIGURED] * 2
    assert {node.state for node in master.line.nodes} == {0}


def test_fast_scan_finds_one_after_the_other(master, lss):
    """A search by bits takes the branch of 0 first, so that the least address is the first."""
    for number, address in ((5, ADDRESSES[0]), (9, ADDRESSES[1])):
        assert lss.fast_scan() == (True, list(address))
        lss.configure_node_id(number)
        lss.send_switch_state_global(WAITING)
    assert lss.fast_scan() == (False, None)
    assert numbers(master) == [5, 9]
    assert [node.state for node in master.line.nodes] == [PREOPERATIONAL] * 2
    assert master.read(0x1018, 4, node=5) == b'\1\0\0\0'
    assert master.read(0x1800, 1, node=9) == b'\x89\1\0\0'
    master.command(START)
    assert [identifier for identifier, _ in master.cycle()] == [0x185, 0x189, 0x285, 0x289]


def test_a_node_begins_with_its_boot_up_message(master, lss):
    assert lss.send_switch_state_selective(*ADDRESSES[1])
    lss.configure_node_id(3)
    assert numbers(master) == [NOT_CONFIGURED] * 2
    master.send(0x7E5, bytes([4, 0]).ljust(8, b'\0'))
    assert master.received() == [(0x703, b'\0')]
    assert numbers(master) == [NOT_CONFIGURED, 3]


@pytest.mark.parametrize('part', range(4))
def test_another_address_selects_no_node(master, lss, part):
    other = list(ADDRESSES[1])
    other[part] += 1
    with pytest.raises(canopen.lss.LssError):
        lss.send_switch_state_selective(*other)
    assert all(node.lss.is_waiting for node in master.line.nodes)
    assert lss.send_switch_state_selective(*ADDRESSES[1])
    assert [node.lss.is_waiting for node in master.line.nodes] == [True, False]
    assert [lss.inquire_lss_address(command) for command in (0x5A, 0x5B, 0x5C, 0x5D)] == list(
        ADDRESSES[1])
    assert lss.inquire_node_id() == NOT_CONFIGURED


def asked(master: Master, *content: int) -> list[bytes]:
    """Return the answers to a frame of LSS."""
    master.received()
    master.send(0x7E5, bytes(content).ljust(8, b'\0'))
    return [data for identifier, data in master.received() if identifier == 0x7E4]


def test_nodes_without_a_number_are_one_frame(master, lss):
    """Equal frames of several nodes are one on a wire."""
    assert asked(master, 0x4C) == [b'\x50' + bytes(7)]
    for address, number in zip(ADDRESSES, (1, 2)):
        assert lss.send_switch_state_selective(*address)
        lss.configure_node_id(number)
        lss.send_switch_state_global(WAITING)
    assert asked(master, 0x4C) == []


@pytest.mark.parametrize(('low', 'high', 'is_there'), [
    (1, 7, True), (7, 7, True), (7, 100, True), (8, 100, False), (2, 6, False)])
def test_a_range_of_serial_numbers_finds_those_within(master, low, high, is_there):
    address = ADDRESSES[1]
    found = [asked(master, command, *value.to_bytes(4, 'little')) for command, value in (
        (0x46, address.vendor), (0x47, address.product), (0x48, address.revision),
        (0x49, address.revision), (0x4A, low), (0x4B, high))]
    assert found[:5] == [[]] * 5
    assert found[5] == ([b'\x4f' + bytes(7)] if is_there else [])


def test_numbers_and_rates_that_cannot_be_are_refused(master, lss):
    lss.send_switch_state_global(CONFIGURATION)
    for number, error in ((0, 1), (128, 1), (254, 1), (255, 0), (127, 0), (1, 0)):
        assert asked(master, 0x11, number) == [bytes([0x11, error]).ljust(8, b'\0')]
    for table, rate, error in ((0, 0, 0), (0, 1, 1), (0, 5, 1), (0, 9, 1), (1, 0, 1)):
        assert asked(master, 0x13, table, rate) == [bytes([0x13, error]).ljust(8, b'\0')]
    assert asked(master, 0x15, 10, 0) == asked(master, 0x60) == []
    lss.send_switch_state_global(WAITING)
    assert asked(master, 0x11, 4) == asked(master, 0x5E) == asked(master, 0x17) == []


def test_a_number_counts_from_the_next_reset_and_what_is_stored_returns():
    with virtual_master(toys()) as master:
        master.received()
        master.send(0x7E5, bytes([4, 1]).ljust(8, b'\0'))
        assert asked(master, 0x11, 20)[0][:2] == b'\x11\0'      # both nodes, of which one is ours
        master.line.nodes[0].lss.pending = 1
        asked(master, 4, 0)
        assert numbers(master) == [1, 2]
        master.command(RESET_COMMUNICATION, 2)
        assert numbers(master) == [1, 20] and (0x714, b'\0') in master.received()
        assert master.read(0x1400, 1, node=20) == b'\x14\2\0\0'
        master.command(RESET_NODE, 20)
        assert numbers(master) == [1, 2]
        asked(master, 4, 1)
        master.line.nodes[1].lss.pending = 30
        assert asked(master, 0x17) == [b'\x17' + bytes(7)]
        asked(master, 4, 0)
        for number in (2, 30):
            master.command(RESET_NODE, number)
            assert numbers(master) == [1, 30]


def test_a_number_is_taken_away_by_255():
    with virtual_master(toys()) as master:
        asked(master, 4, 1)
        asked(master, 0x11, NOT_CONFIGURED)
        asked(master, 4, 0)
        master.command(RESET_COMMUNICATION)
        assert numbers(master) == [NOT_CONFIGURED] * 2
        assert all(node.state == 0 for node in master.line.nodes)


def test_lss_is_ignored_while_operational():
    with virtual_master(toys()) as master:
        master.command(START)
        assert asked(master, 4, 1) == asked(master, 0x5E) == []
        assert all(node.lss.is_waiting for node in master.line.nodes)
        master.command(STOP, 1)
        asked(master, 4, 1)
        assert asked(master, 0x5E) == [b'\x5e\1' + bytes(6)]
        assert master.line.nodes[1].state == OPERATIONAL


@pytest.mark.parametrize('data', [b'', b'\x4c', bytes([0x4C]) + bytes(6), bytes(9)])
def test_frames_of_another_length_are_ignored(master, data):
    master.send(0x7E5, data)
    assert master.received() == []


def scanned(master: Master, value: int, bit: int, part: int, following: int) -> int:
    """Return how many frames answer a step of the fast scan."""
    return len(asked(master, 0x51, *value.to_bytes(4, 'little'), bit, part, following))


def test_a_node_in_configuration_does_not_take_part_in_a_scan(master, lss):
    for address in ADDRESSES:
        assert lss.send_switch_state_selective(*address)
        assert scanned(master, 0, 0x80, 0, 0) == (1 if address == ADDRESSES[0] else 0)
    lss.send_switch_state_global(WAITING)
    assert scanned(master, 0, 0x80, 0, 0) == 1


def test_the_parts_of_a_scan_come_in_their_order(master):
    assert scanned(master, 0, 0x80, 0, 0) == 1
    assert scanned(master, 0, 31, 1, 1) == scanned(master, 0xBAC, 0, 0, 1) == 0
    assert scanned(master, 0xBAD, 0, 0, 1) == 1
    assert scanned(master, 0xBAD, 0, 0, 1) == 0     # the next part is awaited
    assert scanned(master, ADDRESSES[0].product, 0, 1, 2) == 1
    assert scanned(master, 0, 0x80, 0, 0) == 1      # anew
    assert scanned(master, ADDRESSES[0].product, 0, 1, 2) == 0
    assert scanned(master, 0xBAD, 32, 0, 1) == scanned(master, 0, 0, 4, 5) == 0


def test_an_address_with_a_wrong_part_within_selects_no_node(master):
    vendor, product, revision, serial = ADDRESSES[1]
    for command, value in ((0x40, vendor), (0x41, product + 1), (0x41, product),
                           (0x42, revision), (0x43, serial), (0x41, product), (0x42, revision)):
        assert asked(master, command, *value.to_bytes(4, 'little')) == []
    assert all(node.lss.is_waiting for node in master.line.nodes)


@pytest.mark.parametrize('wrong', range(6))
def test_a_range_that_leaves_one_part_out_finds_no_node(master, wrong):
    """Also if that part comes again, behind the others."""
    vendor, product, revision, serial = ADDRESSES[1]
    frames = list(zip(range(0x46, 0x4C), (
        vendor, product, revision, revision, serial, serial)))
    command, value = frames[wrong]
    beyond = value - 1 if command in (0x49, 0x4B) else value + 1
    for command, value in (*frames[:wrong], (command, beyond), *frames[wrong + 1:],
                           frames[wrong]):
        assert asked(master, command, *value.to_bytes(4, 'little')) == []
