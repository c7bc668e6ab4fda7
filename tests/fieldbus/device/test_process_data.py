"""Mappings and assignments: what a master may change, when, and what it gets then."""

import struct

from isa_ros.fieldbus.device import abort
from isa_ros.fieldbus.device.abort import SdoAbort
import pytest

from ..rig import Master, Rig

CONTROL, POSITION, TEMPERATURE = 0x60400010, 0x60640020, 0x20230120


@pytest.fixture
def master():
    return Master(Rig())


def refused(master, index, subindex, value, *, is_preoperational=True):
    with pytest.raises(SdoAbort) as error:
        master.download(index, subindex, value, is_preoperational=is_preoperational)
    return error.value.code


def remap(master, pdo, *words):
    """Write a mapping as CiA 301 wants it."""
    master.download(pdo, 0, 0, is_preoperational=True)
    for k, word in enumerate(words):
        master.download(pdo, k + 1, word, is_preoperational=True)
    master.download(pdo, 0, len(words), is_preoperational=True)


def test_the_process_data_of_ethercat_are_28_bytes_in_each_direction(master):
    device = master.device
    assert device.assigned(0x1C12) == [0x1610] and device.assigned(0x1C13) == [0x1A10]
    assert device.size(0x1610) == device.size(0x1A10) == 28


@pytest.mark.parametrize('pdo', [*range(0x1600, 0x1604), *range(0x1A00, 0x1A04)])
def test_a_pdo_of_canopen_fits_a_frame(master, pdo):
    assert 0 < master.device.size(pdo) <= 8


def test_a_changed_mapping_is_used(master):
    remap(master, 0x1A00, TEMPERATURE, POSITION)
    temperature, position = struct.unpack('<fi', master.device.transmit(0x1A00))
    sample = master.rig.sample
    assert temperature == pytest.approx(sample['temperature'], rel=2 ** -24)
    assert position == round(sample['position'] * 1e6)


def test_a_changed_mapping_of_the_master_is_used(master):
    remap(master, 0x1600, CONTROL, 0x60710010)
    master.device.receive(0x1600, struct.pack('<Hh', 0x06, -7))
    assert (master.upload(0x6040), master.upload(0x6071)) == (0x06, -7)


def test_mappings_and_assignments_change_in_preop_only(master):
    for index, value in ((0x1600, 0), (0x1A10, 0), (0x1C12, 0), (0x1C13, 0)):
        assert refused(master, index, 0, value, is_preoperational=False) == abort.WRONG_STATE
    with pytest.raises(SdoAbort) as error:
        master.device.write_all(0x1C12, b'\0\0', is_preoperational=False)
    assert error.value.code == abort.WRONG_STATE


def test_entries_are_written_while_their_number_is_0(master):
    assert refused(master, 0x1600, 1, CONTROL) == abort.NOT_EMPTIED_FIRST
    assert refused(master, 0x1C12, 1, 0x1600) == abort.NOT_EMPTIED_FIRST


@pytest.mark.parametrize(('pdo', 'word', 'code'), [
    (0x1A00, CONTROL, abort.NOT_MAPPABLE),       # of the other direction
    (0x1600, POSITION, abort.NOT_MAPPABLE),
    (0x1600, 0x60760020, abort.NOT_MAPPABLE),    # cannot be mapped
    (0x1600, 0x60400008, abort.NOT_MAPPABLE),    # of another length
    (0x1600, 0x00000008, abort.NOT_MAPPABLE),    # a gap, which CANopen does not have
    (0x1610, 0x00000007, abort.NOT_MAPPABLE),    # a gap within a byte
    (0x1600, 0x5FFF0010, abort.NO_OBJECT), (0x1600, 0x60400110, abort.NO_SUBINDEX)])
def test_objects_that_cannot_be_mapped_are_refused(master, pdo, word, code):
    master.download(pdo, 0, 0, is_preoperational=True)
    assert refused(master, pdo, 1, word) == code


def test_a_pdo_of_canopen_is_not_longer_than_a_frame(master):
    master.download(0x1A00, 0, 0, is_preoperational=True)
    for k in range(3):
        master.download(0x1A00, k + 1, POSITION, is_preoperational=True)
    assert refused(master, 0x1A00, 0, 3) == abort.PDO_TOO_LONG
    master.download(0x1A00, 0, 2, is_preoperational=True)
    assert master.device.size(0x1A00) == 8
    remap(master, 0x1A10, *[POSITION] * 32)
    assert master.device.size(0x1A10) == 128


def test_an_assignment_changes_what_is_exchanged(master):
    master.download(0x1C12, 0, 0, is_preoperational=True)
    master.download(0x1C12, 1, 0x1600, is_preoperational=True)
    master.download(0x1C12, 2, 0x1601, is_preoperational=True)
    master.download(0x1C12, 0, 2, is_preoperational=True)
    assert master.device.assigned(0x1C12) == [0x1600, 0x1601]
    assert master.device.read_all(0x1C12) == struct.pack('<3H', 2, 0x1600, 0x1601)
    master.download(0x1C12, 0, 0, is_preoperational=True)
    assert refused(master, 0x1C12, 1, 0x1A10) == abort.OUT_OF_RANGE
    assert refused(master, 0x1C12, 0, 5) == abort.TOO_HIGH


def test_complete_access_writes_mappings_and_assignments(master):
    device = master.device
    device.write_all(0x1C13, struct.pack('<2H', 1, 0x1A01), is_preoperational=True)
    assert device.assigned(0x1C13) == [0x1A01]
    device.write_all(0x1A10, struct.pack('<HII', 2, POSITION, 0x08), is_preoperational=True)
    assert device.size(0x1A10) == 5
    for data, code in (
            (b'\1', abort.WRONG_LENGTH), (struct.pack('<2H', 2, 0x1A01), abort.WRONG_LENGTH),
            (struct.pack('<H', 9) + b'\0' * 18, abort.TOO_HIGH),
            (struct.pack('<2H', 1, 0x1610), abort.OUT_OF_RANGE)):
        with pytest.raises(SdoAbort) as error:
            device.write_all(0x1C13, data, is_preoperational=True)
        assert error.value.code == code
        assert device.assigned(0x1C13) == [0x1A01]


def test_an_empty_mapping_has_no_bytes(master):
    master.download(0x1A00, 0, 0, is_preoperational=True)
    assert master.device.size(0x1A00) == 0
    assert master.device.transmit(0x1A00) == b''


def test_the_default_mappings_are_aligned_to_4_bytes():
    """Masters in C cast process data to a struct."""
    master = Master(Rig())
    for pdo in (0x1610, 0x1A10):
        offset = 0
        for k in range(master.upload(pdo)):
            bits = master.upload(pdo, k + 1) & 0xFF
            assert offset % bits == 0
            offset += bits


@pytest.mark.parametrize('is_complete', [False, True])
def test_a_mapping_changed_after_its_size_was_asked_for_is_used(master, is_complete):
    """As on a CAN, whose line asks for the size when it opens."""
    device = master.device
    assert device.size(0x1A00) == 5
    if is_complete:
        device.write_all(0x1A00, struct.pack('<HII', 2, TEMPERATURE, POSITION),
                         is_preoperational=True)
    else:
        remap(master, 0x1A00, TEMPERATURE, POSITION)
    assert device.size(0x1A00) == len(device.transmit(0x1A00)) == 8
