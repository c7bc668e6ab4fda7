"""Node guarding: answers to remote frames, and a master that no longer asks."""

import can
import pytest
from tests.fieldbus.canopen.virtual_bus import (
    Master, OPERATIONAL, PREOPERATIONAL, RESET_COMMUNICATION, START, STOP, STOPPED)

LOST, ENDED = b'\x30\x81\x11\x01\0\0\0\0', bytes(8)


def asked(master: Master, identifier: int = 0x701) -> list[tuple[int, bytes]]:
    """Ask for the state of a node; return what the line sends."""
    master.received()
    assert not master.send_message(can.Message(
        arbitration_id=identifier, is_remote_frame=True, is_extended_id=False))
    return master.received()


def test_a_node_answers_its_state_with_a_bit_that_alternates(master):
    assert asked(master) == [(0x701, bytes([PREOPERATIONAL]))]
    assert asked(master) == [(0x701, bytes([PREOPERATIONAL | 0x80]))]
    master.command(START, 1)
    assert asked(master) == [(0x701, bytes([OPERATIONAL]))]
    assert asked(master, 0x702) == [(0x702, bytes([PREOPERATIONAL]))]
    master.command(STOP, 1)
    assert asked(master) == [(0x701, bytes([STOPPED | 0x80]))]
    asked(master)
    master.command(RESET_COMMUNICATION, 1)
    assert asked(master) == [(0x701, bytes([PREOPERATIONAL]))]


@pytest.mark.parametrize('identifier', [0x700, 0x703, 0x77F, 0x181, 0x80, 0])
def test_other_remote_frames_are_ignored_and_counted(master, identifier):
    master.command(START)
    assert asked(master, identifier) == []
    assert master.line.port.ignored == 1


def test_a_node_with_heartbeats_does_not_answer(master):
    master.write(0x1017, 0, 60000, 2)
    master.line.serve(0.0)
    assert asked(master) == []
    master.write(0x1017, 0, 0, 2)
    assert asked(master) == [(0x701, bytes([PREOPERATIONAL]))]


def test_a_master_that_no_longer_asks_is_a_lost_bus_by_simulated_time(master, toys):
    """2 ms times 3: the seventh tick after the last request."""
    master.write(0x100C, 0, 2, 2)
    master.write(0x100D, 0, 3, 1)
    master.command(START)
    for _ in range(10):     # not watched before the first request
        assert 0x81 not in dict(master.cycle())
    for _ in range(2):      # each request begins anew
        asked(master)
        for _ in range(6):
            assert 0x81 not in dict(master.cycle())
    frames = dict(master.cycle())
    assert frames[0x81] == LOST and 0x82 not in frames
    assert [node.state for node in master.line.nodes] == [PREOPERATIONAL, OPERATIONAL]
    assert toys[0].ended_lost == [True] and toys[1].ended_lost == []
    assert master.read(0x1001) == b'\x11'
    assert (0x81, ENDED) in asked(master)
    assert master.read(0x1001) == b'\0'


@pytest.mark.parametrize(('index', 'size'), [(0x100C, 2), (0x100D, 1)])
def test_a_loss_ends_when_it_is_no_longer_watched(master, index, size):
    master.write(0x100C, 0, 1, 2)
    master.write(0x100D, 0, 1, 1)
    master.command(START)
    asked(master)
    master.cycle()
    assert dict(master.cycle())[0x81] == LOST
    master.write(index, 0, 2, size)     # it still is
    assert master.read(0x1001) == b'\x11'
    master.write(index, 0, 0, size)
    assert master.read(0x1001) == b'\0'


@pytest.mark.parametrize(('guard', 'factor'), [(0, 3), (2, 0)])
def test_without_a_time_or_a_factor_nothing_is_watched(master, guard, factor):
    master.write(0x100C, 0, guard, 2)
    master.write(0x100D, 0, factor, 1)
    master.command(START)
    asked(master)
    for _ in range(20):
        assert 0x81 not in dict(master.cycle())


def test_a_reset_ends_the_watch(master):
    master.write(0x100C, 0, 1, 2)
    master.write(0x100D, 0, 1, 1)
    asked(master)
    master.command(RESET_COMMUNICATION, 1)
    master.command(START)
    asked(master)
    for _ in range(5):
        assert 0x81 not in dict(master.cycle())


def test_a_lost_master_is_reported_once_where_the_node_stays_operational(master, toys):
    master.write(0x100C, 0, 1, 2)
    master.write(0x100D, 0, 2, 1)
    master.write(0x1029, 1, 1, 1)
    master.command(START)
    for _ in range(2):      # and again after the next request
        asked(master)
        emergencies = [data for _ in range(8) for identifier, data in master.cycle()
                       if identifier == 0x81]
        assert emergencies == [LOST]
    assert master.line.nodes[0].state == OPERATIONAL
    assert toys[0].ended_lost == [True, True]
