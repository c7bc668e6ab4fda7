"""A node without its cable, its power or its CAN controller."""

import can
import pytest
from tests.fieldbus.canopen.virtual_bus import (
    OPERATIONAL, PREOPERATIONAL, RESET_NODE, START, STOPPED, TO_PREOPERATIONAL)

PULLED, POWERLESS, BUS_OFF = 'pulled', 'powerless', 'bus_off'
ANY = (PULLED, POWERLESS, BUS_OFF)
OF_1 = (0x081, 0x181, 0x281, 0x581, 0x701)
ALL_OFF, BACK, NO_ERROR = b'\x40\x81\x11', (0x701, b'\0'), bytes(8)


def of_1(frames: list[tuple[int, bytes]]) -> list[tuple[int, bytes]]:
    return [frame for frame in frames if frame[0] in OF_1]


@pytest.mark.parametrize('fault', ANY)
def test_a_node_that_is_away_neither_sends_nor_receives(master, toys, fault):
    master.write(0x1017, 0, 1, 2)
    master.command(START)
    master.line.set_port('hfe', fault, True)
    master.received()
    state = master.line.nodes[0].state
    control = toys[0].values[0x6040, 0]
    frames = master.cycle((0x201, b'\6\0\0\0\0'), (0x202, b'\6\0\0\0\0'))
    assert of_1(frames) == [] and {0x182, 0x282} <= {identifier for identifier, _ in frames}
    assert (toys[0].values[0x6040, 0], toys[1].values[0x6040, 0]) == (control, 6)
    master.command(RESET_NODE, 1)
    master.send(0x601, b'\x40\x00\x10\x00\0\0\0\0')
    master.send(0x7E5, b'\x04\1\0\0\0\0\0\0')
    assert not master.send_message(can.Message(
        arbitration_id=0x701, is_remote_frame=True, is_extended_id=False))
    master.line.serve(0.002)    # a heartbeat is due each ms
    assert of_1(master.received()) == []
    assert master.line.nodes[0].state == state


def test_a_pulled_cable_leaves_the_state_until_the_node_misses_its_master(master, toys):
    """Heartbeats of node 100, 5 ms: the sixth tick without one, counted while it is away."""
    master.write(0x1016, 1, 100 << 16 | 5, 4)
    master.command(START)
    master.send(0x700 + 100, b'\5')
    master.line.set_port('hfe', PULLED, True)
    for _ in range(5):
        master.send(0x700 + 100, b'\5')
        assert of_1(master.cycle()) == []
    assert toys[0].ended_lost == []
    master.cycle()
    assert toys[0].ended_lost == [True]
    assert [node.state for node in master.line.nodes] == [PREOPERATIONAL, OPERATIONAL]
    master.line.set_port('hfe', PULLED, False)
    assert of_1(master.received()) == []
    assert master.read(0x1003, 1) == b'\x30\x81\x64\0'


def test_a_lost_heartbeat_ends_when_it_is_no_longer_watched(master):
    """Of two that are lost, only the one whose entry is written."""
    for subindex, node in ((1, 100), (2, 101)):
        master.write(0x1016, subindex, node << 16 | 1, 4)
    master.command(START)
    for node in (100, 101):
        master.send(0x700 + node, b'\5')
    for _ in range(2):
        master.cycle()
    assert master.read(0x1003) == b'\2'
    for subindex, register in ((1, b'\x11'), (2, b'\0')):
        master.write(0x1016, subindex, 0, 4)
        assert master.read(0x1001) == register


def test_a_short_absence_changes_nothing(master, toys):
    master.command(START)
    master.cycle()
    master.line.set_port('hfe', PULLED, True)
    master.cycle()
    master.line.set_port('hfe', PULLED, False)
    assert [identifier for identifier, _ in of_1(master.cycle())] == [0x181, 0x281]
    assert toys[0].ended_lost == []


def test_a_node_without_power_boots_when_it_has_it_again(master, toys):
    master.write(0x2010, 1, 0x3F800000, 4)
    master.command(START)
    master.line.set_port('hfe', POWERLESS, True)
    assert toys[0].ended_lost == [False] and toys[0].values[0x2010, 1] == 0.0
    master.received()
    master.line.set_port('hfe', POWERLESS, False)
    assert master.received() == [BACK]
    assert master.line.nodes[0].state == PREOPERATIONAL
    master.command(START, 1)
    assert [identifier for identifier, _ in of_1(master.cycle())] == [0x181, 0x281]


@pytest.mark.parametrize(('behaviour', 'state'), [
    (0, PREOPERATIONAL), (1, OPERATIONAL), (2, STOPPED)])
def test_bus_off_is_a_lost_bus_by_the_error_behaviour(master, toys, behaviour, state):
    """The controller knows it at once; when it is back it says so, unless it is stopped."""
    master.write(0x1029, 1, behaviour, 1)
    master.command(START)
    master.line.set_port('hfe', BUS_OFF, True)
    assert (toys[0].ended_lost, master.line.nodes[0].state) == ([True], state)
    assert of_1(master.cycle()) == []
    master.line.set_port('hfe', BUS_OFF, False)
    sent = of_1(master.received())
    assert [(one, data[:3]) for one, data in sent] == ([] if state == STOPPED else [
        (0x081, ALL_OFF), (0x081, NO_ERROR[:3])])
    assert toys[0].ended_lost == [True]


def test_a_node_is_back_when_all_its_faults_have_ended(master):
    master.command(START)
    for fault in (PULLED, POWERLESS):
        master.line.set_port('hfe', fault, True)
    master.received()
    master.line.set_port('hfe', POWERLESS, False)
    assert master.received() == []
    master.line.set_port('hfe', PULLED, False)
    assert master.received() == []
    assert master.read(0x1000) == b'\x92\x01\x02\0'


def test_a_sync_is_a_tick_while_a_node_is_away(master):
    """Else a fault of the only node in operation would have no end."""
    master.command(START)
    master.line.set_port('hfe', POWERLESS, True)
    master.command(TO_PREOPERATIONAL)
    assert master.send(0x80)
    master.line.set_port('hfe', POWERLESS, False)
    assert not master.send(0x80)


def test_a_node_that_is_missing_at_the_start_boots_later(master):
    master.line.set_port('hfe', POWERLESS, True)
    master.received()
    master.command(START)
    assert {identifier for identifier, _ in master.cycle()} == {0x182, 0x282}
    master.line.set_port('hfe', POWERLESS, False)
    assert master.received() == [BACK]
