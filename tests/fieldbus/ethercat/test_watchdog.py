"""The watchdog counts simulated cycles without the outputs of its slave."""

import struct

import pytest
from tests.fieldbus.ethercat.raw_master import LRW, OP, RawMaster, SAFEOP, Sent
from tests.fieldbus.toys import Toy

LOST = (SAFEOP | 0x10, 0x001B)


@pytest.fixture
def two() -> RawMaster:
    """Return two slaves in operation."""
    master = RawMaster(Toy('a'), Toy('b', 2))
    master.bring_up(OP)
    master.exchange()
    return master


def only_first(master: RawMaster, cycles: int) -> None:
    """Exchange process data of the first slave alone; a further frame ends the last cycle."""
    for _ in range(cycles + 1):
        master.send(Sent(LRW, 0, bytes(12)))


def status(master: RawMaster, slave: int) -> tuple[int, int]:
    """Return AL status and its code."""
    return master.number(0x0130, 2, slave), master.number(0x0134, 2, slave)


def test_a_hundred_cycles_without_outputs_are_its_time(two):
    """At power-on 100 ms: 1000 steps of 2500 * 40 ns."""
    only_first(two, 99)
    assert status(two, 1) == (OP, 0)
    assert two.number(0x0440, 2, 1) == 1
    only_first(two, 1)
    assert status(two, 1) == LOST
    assert two.toys[1].was_lost
    assert (two.number(0x0440, 2, 1), two.number(0x0442, 1, 1)) == (0, 1)
    assert status(two, 0) == (OP, 0)


@pytest.mark.parametrize(('divider', 'time', 'cycles'), [
    (0x09C2, 50, 5), (0x09C2, 51, 6), (0x61A6, 10, 10), (0, 0xFFFF, 6)])
def test_its_time_is_steps_of_its_divider(two, divider, time, cycles):
    two.write(0x0400, struct.pack('<H', divider), 1)
    two.write(0x0420, struct.pack('<H', time), 1)
    only_first(two, cycles - 1)
    assert status(two, 1) == (OP, 0)
    only_first(two, 1)
    assert status(two, 1) == LOST


def test_outputs_begin_its_time_anew(two):
    for _ in range(3):
        only_first(two, 60)
        two.exchange()
    assert status(two, 1) == (OP, 0)


def test_a_time_of_0_switches_it_off(two):
    two.write(0x0420, bytes(2), 1)
    only_first(two, 300)
    two.line.miss()
    assert status(two, 1) == (OP, 0)
    assert status(two, 0) == LOST


def test_without_its_bit_in_the_sync_manager_it_does_not_watch():
    master = RawMaster()
    master.bring_up(2)
    master.configure_process_data()
    master.write(0x0816, b'\0')
    master.write(0x0810, struct.pack('<HHBBBB', 0x1200, 6, 0x24, 0, 1, 0))
    master.request(SAFEOP)
    master.request(OP)
    master.line.miss()
    assert status(master, 0) == (OP, 0)


def test_a_silent_master_never_trips_it(two):
    assert not any(two.line.serve(0.0) for _ in range(1000))
    assert status(two, 0) == status(two, 1) == (OP, 0)


def test_a_lost_bus_is_counted_once_until_operation(two):
    for _ in range(3):
        two.line.miss()
    assert two.number(0x0442, 1) == 1
    two.request(SAFEOP | 0x10)
    two.request(OP)
    two.line.miss()
    assert two.number(0x0442, 1) == 2
    two.write(0x0442, b'\0')
    assert two.number(0x0442, 1) == 0


def test_it_expires_with_the_cycle_that_completes_its_time(two):
    """A frame ends the cycle of the one before it: the 101st completes 100 cycles of 1 ms."""
    for _ in range(100):
        two.send(Sent(LRW, 0, bytes(12)))
    assert status(two, 1) == (OP, 0)
    two.send(Sent(LRW, 0, bytes(12)))
    assert status(two, 1) == LOST
