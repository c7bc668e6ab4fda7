"""The diagnosis history 0x10F3 of ETG.1020: messages with code, flags, text and time."""

import struct

from isa_ros.core.conditions import BITS, CONDITIONS
from isa_ros.fieldbus.device.abort import OUT_OF_RANGE, SdoAbort, TOO_HIGH, TOO_LOW
from isa_ros.fieldbus.device.diagnosis import (
    ACKNOWLEDGED, delete_messages, diagnosis_object, MESSAGES, note_message,
    refuse_acknowledgement, take_acknowledgement, TEXTS)
from isa_ros.fieldbus.device.faults import BUS_LOST, PDO_LENGTH
import pytest
from tests.fieldbus.rig import Master, Rig

INDEX, FIRST = 0x10F3, 6
LAST = FIRST + MESSAGES - 1


@pytest.fixture
def values():
    """Return the values of a new object."""
    return {(one.index, one.subindex): one.default for one in diagnosis_object().entries}


def shown(values) -> tuple[int, int, int]:
    """Return newest, newest acknowledged, and whether there are new ones."""
    return tuple(values[INDEX, k] for k in (2, 3, 4))


def message(values, subindex: int) -> tuple[int, ...]:
    return struct.unpack('<HHHHQ', values[INDEX, subindex].encode('latin-1'))


def acknowledge(values, subindex: int) -> None:
    refuse_acknowledgement(values, subindex)
    values[ACKNOWLEDGED] = subindex
    take_acknowledgement(values)


def test_there_is_nothing_at_power_on(values):
    assert shown(values) == (0, 0, 0)
    assert values[INDEX, 0] == LAST and values[INDEX, 1] == MESSAGES


def test_a_message_is_an_emergency_code_an_error_its_text_and_local_time(values):
    note_message(values, BUS_LOST, 1_234_567_890_123)
    assert message(values, FIRST) == (
        0xE800, 0x8180, 0x0012, TEXTS.index(BUS_LOST) + 1, 1_234_567_890_123)
    assert shown(values) == (FIRST, 0, 1)


def test_the_oldest_message_is_overwritten_and_acknowledged_no_more(values):
    for k in range(MESSAGES):
        note_message(values, BUS_LOST, k)
    acknowledge(values, FIRST)
    assert shown(values) == (LAST, FIRST, 1)
    note_message(values, PDO_LENGTH, 99)
    assert message(values, FIRST)[4] == 99 and message(values, FIRST + 1)[4] == 1
    assert shown(values) == (FIRST, 0, 1)


def test_a_message_that_is_acknowledged_is_not_new_until_the_next(values):
    note_message(values, BUS_LOST, 1)
    note_message(values, BUS_LOST, 2)
    acknowledge(values, FIRST)
    assert shown(values) == (FIRST + 1, FIRST, 1)
    acknowledge(values, FIRST + 1)
    assert shown(values) == (FIRST + 1, FIRST + 1, 0)
    note_message(values, BUS_LOST, 3)
    assert shown(values) == (FIRST + 2, FIRST + 1, 1)


def test_0_deletes_all_messages(values):
    note_message(values, BUS_LOST, 1)
    acknowledge(values, 0)
    assert shown(values) == (0, 0, 0) and message(values, FIRST) == (0,) * 5
    note_message(values, BUS_LOST, 2)
    assert shown(values) == (FIRST, 0, 1)
    delete_messages(values)
    assert shown(values) == (0, 0, 0)


@pytest.mark.parametrize(('subindex', 'code'), [
    (1, TOO_LOW), (FIRST - 1, TOO_LOW), (FIRST + 1, OUT_OF_RANGE), (LAST + 1, TOO_HIGH),
    (255, TOO_HIGH)])
def test_what_is_no_message_is_not_acknowledged(values, subindex, code):
    note_message(values, BUS_LOST, 1)
    with pytest.raises(SdoAbort) as refused:
        refuse_acknowledgement(values, subindex)
    assert refused.value.code == code


def test_every_error_of_the_device_has_a_text_of_its_own():
    words = [one.words for one in TEXTS]
    assert len(set(words)) == len(words)
    assert {one.error for one in CONDITIONS} <= set(TEXTS)


def test_a_trip_of_the_device_and_a_lost_bus_are_messages():
    """The reading is lost at tick 3; a master reads and acknowledges by SDO."""
    rig = Rig()
    master = Master(rig)
    device = rig.device
    for _ in range(2):
        master.cycle(0)
    assert device.read(INDEX, 4) == b'\0'
    device.end_operation(is_lost=True)
    rig.simulation.tune('ram', {'plant.sensors.pressure_a.lost': 1.0})
    for _ in range(300):
        rig.tick()
    newest = device.read(INDEX, 2)[0]
    found = [struct.unpack('<HHHHQ', device.read(INDEX, k)) for k in range(FIRST, newest + 1)]
    assert [one[1] for one in found] == [
        int.from_bytes(device.read(0x1003, k)[:2], 'little') for k in range(len(found), 0, -1)]
    assert found[0][1] == 0x8180 and found[0][4] == 2_000_000
    assert found[1][1] == CONDITIONS[BITS['sensor_range']].error.code
    assert all(one[4] % 1_000_000 == 0 and 2_000_000 < one[4] < 300_000_000 for one in found[1:])
    assert device.read(INDEX, 4) == b'\1'
    with pytest.raises(SdoAbort):
        device.write(INDEX, 3, bytes([newest + 1]), is_preoperational=False)
    device.write(INDEX, 3, bytes([newest]), is_preoperational=False)
    assert device.read(INDEX, 4) == b'\0'
    device.end_operation(is_lost=False)
    device.restart(is_whole=False)
    assert device.read(INDEX, 2)[0] == newest
    device.restart(is_whole=True)
    assert (device.read(INDEX, 2), device.read(INDEX, FIRST)) == (b'\0', bytes(16))
