"""NMT: states, boot-up messages, heartbeats, and what a node does in each state."""

import isa_ros
from isa_ros.fieldbus.canopen.heartbeat import HeartbeatProducer
from isa_ros.fieldbus.device.devices import devices_of
from isa_ros.fieldbus.device.manufacturer_area import tunable_keys
import pytest
from tests.fieldbus.canopen.virtual_bus import (
    Master, OPERATIONAL, PREOPERATIONAL, Refused, RESET_COMMUNICATION, RESET_NODE, START, STOP,
    STOPPED, TO_PREOPERATIONAL, virtual_master)


def states(master: Master) -> list[int]:
    return [node.state for node in master.line.nodes]


def test_every_node_boots_into_preoperational(master):
    assert master.received() == [(0x701, b'\0'), (0x702, b'\0')]
    assert states(master) == [PREOPERATIONAL] * 2


def test_a_command_is_for_one_node_or_for_all(master, toys):
    master.command(START, 2)
    assert states(master) == [PREOPERATIONAL, OPERATIONAL]
    assert [toy.is_operational for toy in toys] == [False, True]
    master.command(START)
    assert states(master) == [OPERATIONAL] * 2
    master.command(STOP, 1)
    assert states(master) == [STOPPED, OPERATIONAL]
    master.command(TO_PREOPERATIONAL)
    assert states(master) == [PREOPERATIONAL] * 2
    assert toys[0].ended_lost == [False]


@pytest.mark.parametrize('data', [b'', b'\x01', b'\x01\x00\x00', b'\x07\x00', b'\x01\x09'])
def test_other_commands_are_ignored(master, data):
    master.send(0, data)
    assert states(master) == [PREOPERATIONAL] * 2


def test_a_sync_is_a_tick_once_any_node_is_operational(master):
    assert not master.send(0x80)
    master.command(START, 2)
    assert master.send(0x80)
    master.command(STOP, 2)
    assert not master.send(0x80)


def test_a_stopped_node_answers_no_sdo_and_sends_no_process_data(master):
    master.command(START)
    master.command(STOP, 1)
    master.received()
    master.send(0x601, b'\x40\x00\x10\x00\0\0\0\0')
    assert master.received() == []
    assert [identifier for identifier, _ in master.cycle()] == [0x182, 0x282]


@pytest.mark.parametrize('command', [RESET_NODE, RESET_COMMUNICATION])
def test_a_reset_boots_with_the_communication_of_power_on(master, toys, command):
    master.write(0x1017, 0, 5000, 2)
    master.write(0x1801, 1, 0x80000281, 4)
    master.write(0x1A01, 0, 0, 1)
    master.write(0x2010, 1, 0x3F800000, 4)
    master.command(START)
    master.received()
    master.command(command, 1)
    assert (0x701, b'\0') in master.received()
    assert states(master) == [PREOPERATIONAL, OPERATIONAL]
    assert toys[0].ended_lost == [False]
    assert master.read(0x1017) == b'\0\0'
    assert master.read(0x1801, 1) == b'\x81\x02\0\0'
    assert master.read(0x1A01) == b'\x02'
    is_kept = command == RESET_COMMUNICATION
    assert toys[0].values[0x2010, 1] == (1.0 if is_kept else 0.0)


def test_heartbeats_have_the_state_and_follow_the_wall_clock(master, monkeypatch):
    now = [100.0]
    for module in ('line', 'port'):
        monkeypatch.setattr(f'isa_ros.fieldbus.canopen.{module}.monotonic', lambda: now[0])
    master.send(0x601, b'\x2B\x17\x10\0\x14\0\0\0')
    assert master.received()[2:] == [
        (0x581, b'\x60\x17\x10\0\0\0\0\0'), (0x701, bytes([PREOPERATIONAL]))]
    now[0] += 0.019
    master.line.serve(0.0)
    assert master.received() == []
    now[0] += 0.001
    master.line.serve(0.0)
    assert master.received() == [(0x701, bytes([PREOPERATIONAL]))]
    now[0] += 1.0       # a long tick: what was missed is left out
    master.line.serve(0.0)
    assert master.received() == [(0x701, bytes([PREOPERATIONAL]))]
    master.write(0x1017, 0, 0, 2)
    now[0] += 1.0
    master.line.serve(0.0)
    assert master.received() == []


def test_a_watched_heartbeat_is_lost_by_simulated_time(master, toys):
    master.write(0x1016, 1, 0x7F << 16 | 3, 4)
    master.command(START)
    for _ in range(10):     # not watched before its first
        assert 0x81 not in dict(master.cycle())
    master.send(0x77F, b'\x05')
    for _ in range(3):
        assert 0x81 not in dict(master.cycle())
    frames = dict(master.cycle())
    assert frames[0x81] == b'\x30\x81\x11\x7f\0\0\0\0'
    assert states(master) == [PREOPERATIONAL, OPERATIONAL]
    assert toys[0].ended_lost == [True]
    assert master.read(0x1001) == b'\x11'
    master.received()
    master.send(0x77F, b'\x05')
    assert (0x81, bytes(8)) in master.received()
    assert master.read(0x1001) == b'\0'


def test_of_two_lost_heartbeats_one_that_is_back_leaves_the_error(master):
    for k, node in enumerate((0x7E, 0x7F), 1):
        master.write(0x1016, k, node << 16 | 1, 4)
    master.command(START)
    for identifier in (0x77E, 0x77F):
        master.send(identifier, b'\x05')
    for _ in range(2):
        master.cycle()
    assert master.read(0x1003) == b'\x02'
    master.send(0x77E, b'\x05')
    assert master.read(0x1001) == b'\x11'
    master.send(0x77F, b'\x05')
    assert master.read(0x1001) == b'\0'


def test_a_reset_returns_gains_of_the_reu_and_reports_them_to_the_run():
    device, = devices_of(isa_ros.load('rig_linear').configuration)
    key, = (key for key, one in tunable_keys(device._axis).items() if one.name == 'force.kp')
    entry = device.table.entry(*key)
    with virtual_master([device]) as master:
        value = int.from_bytes(entry.data_type.pack(float(entry.default) / 2), 'little')
        master.write(*key, value, 4)
        assert list(device.changes()) == ['force.kp']
        master.command(RESET_NODE)
        assert master.read(*key) == entry.data_type.pack(entry.default)
        assert device.changes() == {'force.kp': pytest.approx(
            entry.default, rel=2.0 ** -24, abs=0.0)}    # rounded to REAL32


@pytest.mark.parametrize(('behaviour', 'state'), [
    (0, PREOPERATIONAL), (1, OPERATIONAL), (2, STOPPED)])
def test_a_missed_bus_is_lost_by_the_error_behaviour(master, toys, behaviour, state):
    master.write(0x1029, 1, behaviour, 1)
    master.command(START)
    master.line.miss()
    assert states(master)[0] == state
    assert toys[0].ended_lost == [True]


def test_an_unknown_error_behaviour_is_refused(master):
    with pytest.raises(Refused) as refused:
        master.write(0x1029, 1, 3, 1)
    assert refused.value.code == 0x06090030


def test_a_late_poll_sends_one_heartbeat():
    """Written over SDO, at once; the next one a period after it, however late that is asked."""
    produced = HeartbeatProducer()
    produced.set_period(100, now=0.0)
    sent = [now for now in (7.0, 7.001, 7.099, 7.101, 7.102, 7.2, 7.4, 7.401, 7.499, 7.51)
            if produced.is_due(now)]
    assert sent == [7.0, 7.101, 7.2, 7.4, 7.51]     # on its grid, but after a long wait
    produced.set_period(500, now=0.0)
    assert [produced.is_due(0.5), produced.is_due(0.5)] == [True, False]
