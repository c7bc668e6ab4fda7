"""PDOs: when they take effect and when they are sent; mappings and COB-IDs; EMCY."""

from collections.abc import Iterator
import struct

import pytest
from tests.fieldbus.canopen.toy import FAULT_CODE, STATUS, ToyDrive
from tests.fieldbus.canopen.virtual_bus import (
    Master, Refused, START, STOP, TO_PREOPERATIONAL, virtual_master)

ENABLE = (6, 7, 15)


@pytest.fixture
def toy() -> ToyDrive:
    return ToyDrive()


@pytest.fixture
def master(toy: ToyDrive) -> Iterator[Master]:
    with virtual_master([toy]) as one:
        yield one


def command(word: int, torque: int = 0) -> tuple[int, bytes]:
    return 0x201, struct.pack('<Hbh', word, 10, torque)


def code(refused: pytest.ExceptionInfo[Refused]) -> int:
    return refused.value.code


def test_what_arrives_before_a_sync_takes_effect_with_it(master, toy):
    master.command(START)
    assert not master.send(*command(6))
    assert not toy.is_wanted
    assert master.send(0x80)
    assert toy.is_wanted and toy.values[0x6040, 0] == 6


def test_process_data_after_a_sync_have_the_sample_of_its_tick(master, toy):
    master.command(START)
    for word in ENABLE:
        frames = master.cycle(command(word, 100))
    assert [identifier for identifier, _ in frames] == [0x181, 0x281]
    assert struct.unpack('<Hbh', frames[0][1]) == (STATUS['enabled'], 10, 100)
    assert struct.unpack('<ii', frames[1][1]) == (toy.position, toy.velocity)


def test_an_update_without_a_sync_sends_no_process_data(master):
    master.command(START)
    master.received()
    master.line.update()
    assert master.received() == []


def test_of_two_rpdos_the_last_before_the_sync_counts(master, toy):
    master.command(START)
    master.cycle(command(6), command(7))
    assert toy.values[0x6040, 0] == 7


def test_an_event_driven_rpdo_is_taken_at_once(master, toy):
    master.write(0x1400, 2, 255, 1)
    master.command(START)
    master.send(*command(6))
    assert toy.values[0x6040, 0] == 6


def test_process_data_are_not_taken_before_operation(master, toy):
    master.send(*command(6))
    master.command(START)
    master.cycle()
    assert toy.values[0x6040, 0] == 0


@pytest.mark.parametrize(('kind', 'sent'), [
    (1, [1, 1, 1, 1, 1, 1]), (2, [1, 0, 1, 0, 1, 0]), (3, [1, 0, 0, 1, 0, 0]),
    (0, [1, 0, 0, 0, 0, 0]), (255, [1, 0, 0, 0, 0, 0])])
def test_the_transmission_type_says_after_which_syncs(master, kind, sent):
    master.write(0x1800, 2, kind, 1)
    master.command(START)
    assert [0x181 in dict(master.cycle()) for _ in sent] == [bool(one) for one in sent]


def test_an_event_driven_tpdo_has_a_timer_and_an_inhibit_time(master):
    master.write(0x1800, 1, 0x80000181, 4)
    master.write(0x1800, 2, 255, 1)
    master.write(0x1800, 3, 30, 2)     # 3 ms
    master.write(0x1800, 5, 5, 2)      # ms
    master.write(0x1800, 1, 0x181, 4)
    master.command(START)
    sent = [0x181 in dict(master.cycle(command(6, torque))) for torque in range(12)]
    assert sent == [bool(one) for one in (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0)]
    words = iter((6, 7, 6, 7, 6, 7, 6, 7))
    sent = [0x181 in dict(master.cycle(command(next(words)))) for _ in range(8)]
    assert sent == [bool(one) for one in (0, 1, 0, 0, 1, 0, 0, 1)]


def test_a_sync_counter_is_required_where_it_is_configured(master):
    master.write(0x1019, 0, 10, 1)
    master.write(0x1801, 1, 0x80000281, 4)
    master.write(0x1801, 6, 3, 1)
    master.write(0x1801, 1, 0x281, 4)
    master.command(START)
    assert [0x281 in dict(master.cycle(sync=bytes([k]))) for k in (1, 2, 3, 4)] == [
        False, False, True, True]
    assert dict(master.cycle()) == {0x81: b'\x40\x82\x11\0\0\0\0\0'}    # and no tick
    frames = master.cycle(sync=b'\x05')
    assert frames[0] == (0x81, bytes(8))
    assert 0x281 in dict(frames)


def test_wrong_lengths_are_reported_once(master, toy):
    master.command(START)
    assert master.cycle((0x201, b'\x06\0'))[0] == (0x81, b'\x10\x82\x11\x01\0\0\0\0')
    assert 0x81 not in dict(master.cycle((0x201, b'\x06\0')))
    assert toy.values[0x6040, 0] == 0
    assert master.cycle(command(6))[0] == (0x81, bytes(8))
    long = (0x201, command(7)[1] + b'\xff')
    assert master.cycle(long)[0] == (0x81, b'\x20\x82\x11\x01\0\0\0\0')
    assert toy.values[0x6040, 0] == 7


def test_each_wrong_length_is_reported_and_ends_with_the_right_one(master):
    """Too long at once after too short, and the right one only after a new start."""
    master.command(START)
    short, long = (0x201, b'\x06\0'), (0x201, command(7)[1] + b'\xff')
    assert master.cycle(short)[0] == (0x81, b'\x10\x82\x11\x01\0\0\0\0')
    frames = master.cycle(long)
    assert [data for identifier, data in frames if identifier == 0x81] == [
        b'\x20\x82\x11\x01\0\0\0\0']
    assert 0x81 not in dict(master.cycle(long))
    assert master.cycle(short)[0] == (0x81, b'\x10\x82\x11\x01\0\0\0\0')
    master.command(TO_PREOPERATIONAL)
    master.command(START)
    assert master.cycle(command(6))[0] == (0x81, bytes(8))
    assert master.read(0x1001) == b'\0'


def test_the_error_field_has_as_many_entries_as_errors(master):
    master.command(START)
    master.cycle((0x201, b'\x06\0'))
    assert master.read(0x1003) == b'\x01'
    assert master.read(0x1003, 1) == b'\x10\x82\x01\0'
    for subindex in (2, 8):
        with pytest.raises(Refused) as refused:
            master.read(0x1003, subindex)
        assert code(refused) == 0x08000024


def test_an_rpdo_that_stays_away_is_a_lost_bus(master, toy):
    master.write(0x1400, 5, 3, 2)
    master.command(START)
    for word in ENABLE:
        master.cycle(command(word))
    for _ in range(2):      # with that of the last one, 3 ms without it
        assert 0x81 not in dict(master.cycle())
    frames = master.cycle()
    assert frames[0] == (0x81, b'\x50\x82\x11\x01\0\0\0\0')
    assert frames[1][1][:2] == b'\x80\x81'      # the drive's own reaction
    assert toy.ended_lost == [True]


def test_a_fault_is_an_emergency_with_its_register_and_kept(master, toy):
    toy.fault_at = 3
    master.command(START)
    for word in ENABLE:
        master.cycle(command(word))
    frames = master.cycle(command(15))
    assert frames[0] == (0x81, b'\x10\x32\x05\0\0\0\0\0')
    assert frames[1][1][0] == STATUS['fault']
    assert master.read(0x1001) == b'\x05'
    assert master.read(0x1003) == b'\x01'
    assert master.read(0x1003, 1) == FAULT_CODE.to_bytes(4, 'little')
    master.cycle(command(0))
    assert master.cycle(command(0x80))[0] == (0x81, bytes(8))
    assert master.read(0x1003) == b'\x01'
    master.write(0x1003, 0, 0, 1)
    with pytest.raises(Refused) as refused:
        master.read(0x1003, 1)
    assert code(refused) == 0x08000024
    with pytest.raises(Refused) as refused:
        master.write(0x1003, 0, 1, 1)
    assert code(refused) == 0x06090030


def test_a_stopped_node_sends_no_emergency(master, toy):
    toy.fault_at = 0
    master.command(START)
    master.command(STOP)
    master.received()
    toy.tick()
    master.line.update()
    assert master.received() == []


def test_a_mapping_is_changed_while_its_pdo_is_off(master):
    with pytest.raises(Refused) as refused:
        master.write(0x1A01, 0, 0, 1)
    assert code(refused) == 0x06010000
    master.write(0x1801, 1, 0x80000281, 4)
    with pytest.raises(Refused) as refused:
        master.write(0x1A01, 1, 0x60770010, 4)
    assert code(refused) == 0x06010003
    master.write(0x1A01, 0, 0, 1)
    master.write(0x1A01, 1, 0x60770010, 4)
    master.write(0x1A01, 0, 1, 1)
    master.write(0x1801, 1, 0x3A1, 4)
    master.command(START)
    assert master.cycle()[1] == (0x3A1, b'\0\0')


def test_a_mapping_longer_than_a_frame_is_refused(master):
    master.write(0x1801, 1, 0x80000281, 4)
    master.write(0x1A01, 0, 0, 1)
    master.write(0x1A01, 3, 0x60770010, 4)
    with pytest.raises(Refused) as refused:
        master.write(0x1A01, 0, 3, 1)
    assert code(refused) == 0x06040042
    assert master.read(0x1A01) == b'\0'


@pytest.mark.parametrize(('index', 'subindex', 'value', 'size', 'expected'), [
    (0x1800, 1, 0x182, 4, 0x08000022),          # while it is on
    (0x1800, 1, 0x80000182, 4, None),
    (0x1800, 1, 0x601, 4, 0x06090030),          # restricted
    (0x1402, 1, 0x403, 4, None),
    (0x1402, 1, 0x201, 4, None),                # RPDOs may share one
    (0x1402, 1, 0x80000181, 4, None),           # off
    (0x1402, 1, 0x182, 4, None),                # of another node
    (0x1402, 1, 0x482, 4, None),
    (0x1402, 1, 0x80, 4, 0x06040043),           # SYNC
    (0x1402, 1, 0x40000080, 4, 0x06040043),
    (0x1402, 1, 0x81, 4, 0x06040043),           # its EMCY
    (0x1402, 1, 0x181, 4, 0x06040043),          # its TPDO 1
    (0x1802, 1, 0x181, 4, 0x06040043),          # its TPDO 1
    (0x1802, 1, 0x201, 4, 0x06040043),          # its RPDO 1
    (0x1802, 1, 0x401, 4, None),                # its RPDO 3 is off
    (0x1005, 0, 0x181, 4, 0x06040043),
    (0x1005, 0, 0x82, 4, None),
    (0x1014, 0, 0x80, 4, 0x06040043),
    (0x1014, 0, 0x80000080, 4, None),
    (0x1014, 0, 0x301, 4, 0x06040043),
    (0x1800, 1, 0x20000181, 4, 0x06090030),     # 29 bits
    (0x1800, 2, 252, 1, 0x06090030),            # on request
    (0x1800, 2, 241, 1, 0x06090030),
    (0x1800, 4, 0, 1, 0x06090011),
    (0x1005, 0, 0x40000080, 4, 0x06090030),     # it would send SYNC
    (0x1006, 0, 2000, 4, 0x06090030),           # not the tick
    (0x1006, 0, 0, 4, None),
    (0x1019, 0, 1, 1, 0x06090030),
    (0x1019, 0, 241, 1, 0x06090030),
    (0x1014, 0, 0x80000081, 4, None),
    (0x1200, 1, 0x601, 4, 0x06010002),
    (0x1017, 0, 1, 4, 0x06070012),
    (0x1016, 1, 1, 2, 0x06070013),
    (0x6041, 0, 1, 2, 0x06010002),
])
def test_communication_objects_refuse_by_code(master, index, subindex, value, size, expected):
    if expected is None:
        master.write(index, subindex, value, size)
        assert master.read(index, subindex) == value.to_bytes(size, 'little')
        return
    with pytest.raises(Refused) as refused:
        master.write(index, subindex, value, size)
    assert code(refused) == expected


@pytest.mark.parametrize(('index', 'subindex', 'size'), [
    (0x1800, 1, 4), (0x1400, 2, 1), (0x1005, 0, 4), (0x1019, 0, 1), (0x1A02, 0, 1)])
def test_what_configures_the_bus_is_refused_while_operational(master, index, subindex, size):
    value = int.from_bytes(master.read(index, subindex), 'little')
    master.command(START)
    with pytest.raises(Refused) as refused:
        master.write(index, subindex, value, size)
    assert code(refused) == 0x08000022
    master.command(TO_PREOPERATIONAL)
    master.write(index, subindex, value, size)


@pytest.mark.parametrize('mapping', [0x1600, 0x1602, 0x1A00, 0x1A02])
def test_a_mapping_is_refused_while_operational_whether_its_pdo_is_on_or_off(master, mapping):
    master.command(START)
    with pytest.raises(Refused) as refused:
        master.write(mapping, 0, 0, 1)
    assert code(refused) == 0x08000022


def test_another_sync_identifier_is_the_tick(master):
    master.write(0x1005, 0, 0x90, 4)
    master.command(START)
    assert not master.send(0x80)
    assert master.send(0x90)
