"""Datagrams of every command, by bytes written by hand: who is addressed, what counts."""

import struct

from isa_ros.fieldbus.ethercat.sii import checksum
import pytest
from tests.fieldbus.ethercat.raw_master import (
    APRD, APRW, APWR, ARMW, at, BRD, BRW, BWR, FPRD, FPRW, FPWR, frame_of, FRMW, LRD, LRW, LWR, OP,
    RawMaster, SAFEOP, Sent)
from tests.fieldbus.toys import Toy

STATION, WATCHDOG_TIME = 0x0010, 0x0420


@pytest.fixture
def three() -> RawMaster:
    """Return three slaves with the station addresses 1001 to 1003."""
    master = RawMaster(Toy('a'), Toy('b', 2), Toy('c', 3))
    for slave in range(3):
        master.write(STATION, struct.pack('<H', 1001 + slave), slave)
        master.write(WATCHDOG_TIME, struct.pack('<H', 100 + slave), slave)
    return master


def times(master: RawMaster) -> list[int]:
    """Return what is in a register of each slave."""
    return [master.number(WATCHDOG_TIME, 2, slave) for slave in range(3)]


def test_a_position_is_counted_up_by_every_slave(three):
    answer = three.send(Sent(APRD, at(-1, WATCHDOG_TIME), bytes(2)))[0]
    assert (answer.data, answer.counter) == (struct.pack('<H', 101), 1)
    assert answer.slave == 0xFFFF + 3 & 0xFFFF


@pytest.mark.parametrize(('command', 'slave'), [(APWR, -2), (FPWR, 1003)])
def test_a_write_reaches_the_slave_addressed(three, command, slave):
    answer = three.send(Sent(command, at(slave, WATCHDOG_TIME), b'\x07\0'))[0]
    assert answer.counter == 1
    assert times(three) == [100, 101, 7]


@pytest.mark.parametrize(('command', 'slave'), [(APRW, -1), (FPRW, 1002)])
def test_a_read_and_write_exchanges_and_counts_three(three, command, slave):
    answer = three.send(Sent(command, at(slave, WATCHDOG_TIME), b'\x07\0'))[0]
    assert (answer.data, answer.counter) == (struct.pack('<H', 101), 3)
    assert times(three) == [100, 7, 102]


def test_a_station_that_is_absent_counts_nothing(three):
    answer = three.send(Sent(FPRD, at(1004, WATCHDOG_TIME), b'ab'))[0]
    assert (answer.data, answer.counter) == (b'ab', 0)


def test_a_broadcast_read_merges_bits(three):
    answer = three.send(Sent(BRD, at(0, WATCHDOG_TIME), b'\0\x80'))[0]
    assert (answer.data, answer.counter) == (struct.pack('<H', 100 | 101 | 102 | 0x8000), 3)
    assert answer.slave == 3


def test_a_broadcast_write_reaches_all(three):
    assert three.send(Sent(BWR, at(0, WATCHDOG_TIME), b'\x05\0'))[0].counter == 3
    assert times(three) == [5, 5, 5]


def test_a_broadcast_of_both_counts_three_a_slave(three):
    assert three.send(Sent(BRW, at(0, WATCHDOG_TIME), b'\x05\0'))[0].counter == 9


@pytest.mark.parametrize(('command', 'slave'), [(ARMW, -1), (FRMW, 1002)])
def test_one_is_read_and_the_others_are_written(three, command, slave):
    """The slave before the one read takes what the master sent, the one behind what was read."""
    answer = three.send(Sent(command, at(slave, WATCHDOG_TIME), b'\x05\0'))[0]
    assert (answer.data, answer.counter) == (struct.pack('<H', 101), 3)
    assert times(three) == [5, 101, 101]


def test_a_datagram_that_does_nothing_passes_unchanged(three):
    answer = three.send(Sent(0, at(0, WATCHDOG_TIME), b'abcd', 77))[0]
    assert (answer.data, answer.counter) == (b'abcd', 77)


def test_a_counter_of_16_bit_wraps(three):
    assert three.send(Sent(BRD, at(0, 0), bytes(1), 0xFFFE))[0].counter == 1


def test_the_datagrams_of_a_frame_are_executed_in_their_order(three):
    answers = three.send(
        Sent(APWR, at(0, WATCHDOG_TIME), b'\x09\0'), Sent(APRD, at(0, WATCHDOG_TIME), bytes(2)))
    assert answers[1].data == b'\x09\0'


def test_the_source_address_of_an_answer_is_local(three):
    three.send(Sent(BRD, 0, bytes(1)))
    assert three.wire.outgoing[-1][6:12] == bytes.fromhex('030101010101')


def test_the_ports_show_the_place_in_the_line(three):
    """Links at bits 4 and 5; two bits a port from bit 8 on: 2 communicates, 1 is closed."""
    statuses = [three.number(0x0110, 2, slave) for slave in range(3)]
    assert [one >> 4 & 0xF for one in statuses] == [3, 3, 1]
    assert [[one >> 8 + 2 * port & 3 for port in range(4)] for one in statuses] == [
        [2, 2, 1, 1], [2, 2, 1, 1], [2, 1, 1, 1]]


def test_a_write_of_what_is_read_only_does_not_count(three):
    assert three.write(0x0000, b'\xff') == 0
    assert three.number(0x0000, 1) == 0x11


def test_an_access_beyond_the_memory_does_not_count(three):
    assert three.send(Sent(APRD, at(0, 0x2FFF), bytes(2)))[0].counter == 0
    assert three.send(Sent(APRD, at(0, 0x0FFF), bytes(2)))[0].counter == 0


def test_an_alias_is_an_address_when_the_master_allows_it(three):
    write_alias(three, 77)
    assert three.number(0x0012) == 77
    assert three.send(Sent(FPRD, at(77, 0), bytes(1)))[0].counter == 0
    three.write(0x0100, struct.pack('<I', 0x0100_0001))
    assert three.send(Sent(FPRD, at(77, 0), bytes(1)))[0].counter == 1


def write_alias(master: RawMaster, alias: int) -> None:
    """Write the alias and its checksum into the SII, and load it."""
    head = struct.pack('<HHHHHHH', 0x80, 0, 0, 0, alias, 0, 0)
    for word, content in ((4, struct.pack('<H', alias)), (7, bytes([checksum(head), 0]))):
        master.write(0x0508, content)
        master.write(0x0504, struct.pack('<I', word))
        master.write(0x0502, struct.pack('<H', 0x0201))
    master.write(0x0502, struct.pack('<H', 0x0400))


@pytest.mark.parametrize(('command', 'counter'), [(LRD, 1), (LWR, 1), (LRW, 3)])
def test_logical_memory_counts_by_what_was_exchanged(command, counter):
    master = RawMaster()
    master.bring_up(SAFEOP)
    answer = master.send(Sent(command, 0, bytes(12)))[0]
    assert answer.counter == counter


def test_logical_memory_is_not_reached_below_safeop():
    master = RawMaster()
    master.bring_up(SAFEOP)
    master.request(2)
    assert master.send(Sent(LRW, 0, bytes(12)))[0].counter == 0


def test_process_data_are_exchanged_in_operation():
    toys = Toy('a'), Toy('b', 2)
    master = RawMaster(*toys)
    master.bring_up(OP)
    first = master.exchange(struct.pack('<Hi', 15, 100), struct.pack('<Hi', 15, -7))
    assert [one.counter for one in first] == [3, 3]
    assert [toy.target for toy in toys] == [100, -7]
    second = master.exchange()
    assert [struct.unpack('<Hi', one.data[6:]) for one in second] == [(1, 100), (1, -7)]


def test_a_frame_that_is_too_short_for_its_datagram_is_counted():
    master = RawMaster()
    frame = bytearray(frame_of([Sent(BRD, 0, bytes(4))]))
    frame[22:24] = struct.pack('<H', 400)
    master.wire.incoming.append(bytes(frame))
    assert not master.line.serve(0.0)
    assert master.wire.outgoing[-1][16:] == bytes(frame[16:])
    assert master.number(0x030C, 1) == 1
    master.write(0x0300, bytes(16))
    assert master.number(0x030C, 1) == 0


def test_frames_of_other_protocols_are_not_answered():
    master = RawMaster()
    for frame in (b'', bytes(60), bytes(12) + b'\x88\xa4\x0c\x40' + bytes(44)):
        master.wire.incoming.append(frame)
    assert not master.line.serve(0.0)
    assert not master.wire.outgoing and not master.wire.incoming


def test_events_come_back_with_every_datagram_that_the_mask_allows():
    master = RawMaster()
    master.bring_up(OP)
    master.line.miss()
    assert master.send(Sent(BRD, 0, bytes(1)))[0].irq == 0
    master.write(0x0200, struct.pack('<H', 0x0008))
    assert master.send(Sent(BRD, 0, bytes(1)))[0].irq == 0x0008
    assert master.number(0x0130) == 0x14
    assert master.send(Sent(BRD, 0, bytes(1)))[0].irq == 0
