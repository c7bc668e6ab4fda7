"""Cables and power of single slaves, as a master sees them; rows of the table in docs."""

import struct

from isa_ros.fieldbus.ethercat.sii import checksum
import pytest
from tests.fieldbus.ethercat.raw_master import (
    APRD, at, BRD, BWR, FPRD, frame_of, INIT, LRW, OP, RawMaster, SAFEOP, Sent)
from tests.fieldbus.ethercat.seen import row
from tests.fieldbus.toys import Toy

PULLED, POWERLESS = 'pulled', 'powerless'
DL_STATUS, LOST_LINKS, WATCHDOG = 0x0110, 0x0310, 0x0420
BOTH, FIRST_ONLY, SECOND_ONLY = 0x5A31, 0x5611, 0x5921
"""DL status: links at both ports, at port 0, at port 1; the others closed."""


@pytest.fixture
def master() -> RawMaster:
    """Return three slaves in operation, whose watchdogs expire after 5 ms."""
    found = RawMaster(*(Toy(name, 1 + k) for k, name in enumerate(('hip', 'knee', 'toe'))))
    for slave in range(3):
        found.write(0x0010, struct.pack('<H', 1001 + slave), slave)
        found.write(WATCHDOG, struct.pack('<H', 50), slave)
    found.bring_up()
    found.exchange()
    return found


def counters(master: RawMaster) -> list[int]:
    """Exchange process data; return the working counters of the three slaves."""
    return [one.counter for one in master.exchange()]


def links(master: RawMaster, slave: int) -> tuple[int, bytes]:
    return master.number(DL_STATUS, 2, slave), master.read(LOST_LINKS, 2, slave)


@row('the cable between two slaves is pulled', 'the line ends there: working counters and '
     'positions without the slaves behind it; bit 5 of 0x0110 of the slave before is 0, 0x0311 '
     'counts',
     'goes on with the others')
def test_the_line_ends_before_a_pulled_cable(master):
    assert [master.number(DL_STATUS, 2, k) for k in range(3)] == [BOTH, BOTH, FIRST_ONLY]
    master.line.set_port('knee', PULLED, True)
    assert counters(master) == [3, 0, 0]
    (counted,) = master.send(Sent(BRD, at(0, 0x0130), bytes(2)))
    assert (counted.counter, counted.slave) == (1, 1)
    assert master.send(Sent(APRD, at(-1, 0x0130), bytes(2)))[0].counter == 0
    assert master.send(Sent(FPRD, at(1003, 0x0130), bytes(2)))[0].counter == 0
    assert links(master, 0) == (FIRST_ONLY, b'\0\1')
    master.line.set_port('knee', PULLED, False)
    assert counters(master) == [3, 3, 3]
    assert links(master, 0) == (BOTH, b'\0\1')
    assert links(master, 1) == (BOTH, b'\1\0')
    assert links(master, 2) == (FIRST_ONLY, b'\0\0')


def test_a_lost_link_is_an_event_of_the_slaves_beside_it(master):
    """Bit 2 of 0x0210, until DL status is read; a link that comes back is one too."""
    def event(slave: int) -> int:
        found = master.number(0x0210, 2, slave) & 4
        master.number(DL_STATUS, 2, slave)
        return found
    for is_on in (True, False):
        assert [event(0), master.number(0x0210, 2, 0) & 4] == ([0, 0] if is_on else [4, 0])
        master.line.set_port('knee', PULLED, is_on)
    assert [event(0), event(1), event(2)] == [4, 4, 0]


@row('the cable is back after the watchdogs of the slaves behind it', 'those: AL status 0x14, '
     'code 0x001B, at their station addresses; 0x0310 of the first of them counts',
     'SAFEOP with acknowledgement, then OP; then the reset of the drives')
def test_slaves_behind_a_pulled_cable_lose_their_outputs_to_their_own_watchdogs(master):
    """5 ms are 5 ticks; each cycle is a tick although two slaves are missing."""
    before = master.ticks
    master.line.set_port('knee', PULLED, True)
    for cycle in range(6):
        assert [toy.is_operational for toy in master.toys] == [True] + [cycle < 5] * 2
        counters(master)
    assert master.ticks - before == 6
    assert [toy.was_lost for toy in master.toys] == [False, True, True]
    master.line.set_port('knee', PULLED, False)
    assert master.number(0x0130, 2, 1) == SAFEOP | 0x10
    assert master.number(0x0134, 2, 1) == 0x1B
    assert master.number(0x0010, 2, 2) == 1003


def test_short_of_its_watchdog_a_pulled_cable_leaves_the_state(master):
    master.line.set_port('toe', PULLED, True)
    for _ in range(4):
        assert counters(master) == [3, 3, 0]
    master.line.set_port('toe', PULLED, False)
    assert counters(master) == [3, 3, 3]
    assert master.number(0x0130, 2, 2) == OP


@row('the cable to the first slave is pulled', 'no frame within its timeout; its cycles are ticks '
     'all the same', 'goes on sending: in frame pace time passes with its cycles')
def test_without_the_cable_to_the_first_slave_no_frame_comes_back_but_time_goes_on(master):
    """Else its fault would have no end."""
    master.line.set_port('hip', PULLED, True)
    sent, before = len(master.wire.outgoing), master.ticks
    size = sum(master.sizes(0))
    for cycle in range(7):
        master.wire.incoming.append(frame(size))
        assert master.line.serve(0.0)
        master.tick()
    assert (len(master.wire.outgoing), master.ticks) == (sent, before + 7)
    assert [toy.was_lost for toy in master.toys] == [True] * 3
    master.line.set_port('hip', PULLED, False)
    assert [master.number(0x0130, 2, k) for k in range(3)] == [SAFEOP | 0x10] * 3


def frame(size: int) -> bytes:
    """Return a frame with the outputs of the first slave."""
    return frame_of([Sent(LRW, 0, bytes(size))])


@row('a slave has no supply voltage', 'it and the slaves behind it are missing; with voltage '
     'again it is in INIT without station address, its drive as at power-on',
     'gives it its station address, as `slave.recover` of pysoem does, then configures it anew: '
     '`slave.reconfig`')
def test_a_slave_without_power_begins_anew_and_hides_those_behind_it(master):
    knee = master.toys[1]
    master.line.set_port('knee', POWERLESS, True)
    assert (knee.is_operational, knee.was_lost, knee.restarts) == (False, False, [True])
    assert counters(master) == [3, 0, 0]
    assert links(master, 0) == (FIRST_ONLY, b'\0\1')
    master.line.set_port('knee', POWERLESS, False)
    assert master.number(0x0130, 2, 1) == INIT
    assert master.number(0x0010, 2, 1) == 0
    assert [master.number(DL_STATUS, 2, k) for k in range(3)] == [BOTH, BOTH, FIRST_ONLY]
    assert [master.read(LOST_LINKS, 2, k) for k in range(3)] == [b'\0\1', b'\0\0', b'\1\0']
    assert counters(master) == [3, 0, 3]
    assert knee.restarts == [True]


def test_a_slave_keeps_its_sii_without_power(master):
    """Word 4 of the SII is the alias, which is loaded at power-on; the checksum is word 7."""
    image = master.ring.slaves[1].controller.eeprom.image
    image[8:10] = b'\x2a\0'
    image[14] = checksum(image[:14])
    master.line.set_port('knee', POWERLESS, True)
    master.line.set_port('knee', POWERLESS, False)
    assert master.number(0x0012, 2, 1) == 42


def test_two_faults_of_one_slave_end_one_after_the_other(master):
    master.line.set_port('toe', POWERLESS, True)
    master.line.set_port('toe', PULLED, True)
    master.line.set_port('knee', PULLED, True)
    master.line.set_port('toe', POWERLESS, False)
    assert counters(master) == [3, 0, 0]
    master.line.set_port('knee', PULLED, False)
    assert counters(master) == [3, 3, 0]
    master.line.set_port('toe', PULLED, False)
    assert links(master, 2) == (FIRST_ONLY, b'\0\0')
    assert links(master, 1) == (BOTH, b'\1\1')


def test_delays_are_measured_along_the_cables_that_are_in(master):
    """A slave is 500 ns from the next: the frame is back at the first after 2000, or 1000, ns."""
    def back(slave: int) -> int:
        master.send(Sent(BWR, at(0, 0x0900), bytes(4)))
        ports = struct.unpack('<II', master.read(0x0900, 8, slave))
        return ports[1] - ports[0]
    assert [back(k) for k in range(3)] == [2000, 1000, 0]
    master.line.set_port('toe', PULLED, True)
    assert [back(k) for k in range(2)] == [1000, 0]


def test_time_goes_on_while_the_only_slave_in_operation_has_no_power():
    """And ends with its fault if no slave is in operation then, as in INIT."""
    master = RawMaster(Toy())
    master.bring_up()
    master.exchange()
    master.line.set_port('toy', POWERLESS, True)
    outgoing = len(master.wire.outgoing)
    for _ in range(3):
        master.wire.incoming.append(frame(sum(master.sizes(0))))
        assert master.line.serve(0.0)
        master.tick()
    assert len(master.wire.outgoing) == outgoing
    master.line.set_port('toy', POWERLESS, False)
    before = master.ticks
    assert counters(master)[0] == 0
    assert master.ticks == before


def test_before_operation_a_missing_slave_makes_no_tick():
    master = RawMaster(Toy('hip'), Toy('knee', 2))
    master.line.set_port('knee', POWERLESS, True)
    assert [one.counter for one in master.exchange()] == [0, 0]
    assert master.ticks == 0
