"""One tick a cycle, however many frames the process image needs, and whichever are lost."""

import struct

from isa_ros.fieldbus.ethercat.cycle import Cycle
import pytest
from tests.fieldbus.ethercat.raw_master import (
    FPRD, LRD, LRW, LWR, OP, PREOP, RawMaster, SAFEOP, Sent)
from tests.fieldbus.toys import Toy

N, IMAGE = 12, 166
"""Twelve slaves with 166 bytes either way: 3984 bytes, so three frames."""


@pytest.fixture(scope='module')
def twelve() -> RawMaster:
    """Return a ring of twelve slaves in operation."""
    master = RawMaster(*(Toy(f'toy {k}', 1 + k, filler=40) for k in range(N)))
    master.bring_up(OP)
    return master


def part(slaves: range, tick: int) -> list[Sent]:
    """Return the datagrams of some slaves."""
    outputs = struct.pack('<Hi', 15, tick).ljust(IMAGE, b'\0')
    return [Sent(LRW, 0x1000 * k, outputs + bytes(IMAGE)) for k in slaves]


PARTS = range(0, 4), range(4, 8), range(8, 12)


def send_cycle(master: RawMaster, tick: int, lost: tuple[int, ...] = ()) -> list[int]:
    """Send the frames of a cycle but those lost; return the ticks seen in the inputs."""
    seen = []
    for number, slaves in enumerate(PARTS):
        if number not in lost:
            answers = master.send(*part(slaves, tick))
            assert all(one.counter == 3 for one in answers)
            seen += [struct.unpack_from('<H', one.data, IMAGE)[0] for one in answers]
    return seen


def test_a_cycle_of_three_frames_is_one_tick(twelve):
    before = twelve.ticks
    for k in range(5):
        seen = send_cycle(twelve, k)
        assert set(seen) == {before + k}
        assert [toy.target for toy in twelve.toys] == [k] * N
    assert twelve.ticks == before + 5


@pytest.mark.parametrize('lost', [(0,), (1,), (2,), (0, 1), (1, 2), (0, 2)])
def test_a_cycle_with_lost_frames_is_one_tick(twelve, lost):
    """The tick is noticed with the next cycle, whose frames stay together."""
    before = twelve.ticks
    send_cycle(twelve, 1)
    send_cycle(twelve, 2, lost)
    seen = send_cycle(twelve, 3)
    assert twelve.ticks == before + 3
    assert set(seen) == {before + 2}
    assert {toy.target for toy in twelve.toys} == {3}


def test_a_cycle_whose_frames_are_all_lost_is_none(twelve):
    before = twelve.ticks
    send_cycle(twelve, 1)
    send_cycle(twelve, 2, (0, 1, 2))
    send_cycle(twelve, 3)
    assert twelve.ticks == before + 2


def test_reading_alone_is_no_tick(twelve):
    before = twelve.ticks
    for _ in range(3):
        twelve.send(Sent(LRD, IMAGE, bytes(IMAGE)), Sent(FPRD, 0x01300000, bytes(2)))
        twelve.number(0x0130)
    assert twelve.ticks == before


def test_outputs_and_inputs_by_datagrams_of_their_own_are_one_tick():
    for order in ((LRD, LWR), (LWR, LRD)):
        master = RawMaster()
        master.bring_up(OP)
        for k in range(4):
            for command in order:
                master.send(Sent(command, 0, struct.pack('<Hi', 15, k).ljust(12, b'\0')))
            assert master.ticks == k + 1


def test_a_master_that_never_reads_has_its_tick_with_the_next_cycle():
    master = RawMaster()
    master.bring_up(OP)
    for k in range(4):
        master.send(Sent(LWR, 0, struct.pack('<Hi', 15, k)))
        assert master.ticks == k


def test_a_slave_written_every_second_cycle_does_not_hold_up_the_others():
    master = RawMaster(Toy('a'), Toy('b', 2))
    master.bring_up(OP)
    for k in range(6):
        master.send(Sent(LRW, 0, struct.pack('<Hi', 15, k).ljust(12, b'\0')))
        if k % 2:
            master.send(Sent(LRW, 0x1000, struct.pack('<Hi', 15, k).ljust(12, b'\0')))
    assert master.ticks == 6


def test_cycles_before_operation_are_no_ticks():
    master = RawMaster()
    master.bring_up(SAFEOP)
    for _ in range(3):
        assert master.exchange()[0].counter == 3
    assert master.ticks == 0
    master.request(OP)
    master.exchange()
    assert master.ticks == 1


def test_a_slave_that_has_fallen_to_safeop_still_has_ticks():
    """The drive's reaction to a lost bus takes time."""
    master = RawMaster()
    master.bring_up(OP)
    master.exchange()
    master.line.miss()
    assert master.number(0x0130) == 0x14
    for _ in range(3):
        master.exchange()
    assert master.ticks == 4
    master.request(PREOP | 0x10)
    master.exchange()
    assert master.ticks == 4


def test_a_cycle_begins_anew_where_it_began_before():
    cycle = Cycle()
    cycle.add([(0, 10)])
    cycle.add([(10, 20)])
    assert not cycle.is_over([(20, 30)])
    assert cycle.is_over([(0, 10)]) and cycle.is_over([(15, 25)])
    cycle.end()
    cycle.add([(10, 20)])
    assert cycle.is_over([(0, 10)])
    cycle.forget()
    cycle.add([(10, 20)])
    assert not cycle.is_over([(0, 10)])
