"""Reading and writing every object of a device, one by one and as a whole."""

import math
import struct

import isa_ros
from isa_ros.fieldbus.device import abort
from isa_ros.fieldbus.device.abort import SdoAbort
from isa_ros.fieldbus.device.devices import devices_of, PROFILES
from isa_ros.fieldbus.device.process_data import is_changed_in_preop
import pytest

from ..rig import FORMATS

RUNS = {name: isa_ros.load(name).configuration for name in ('leg', 'rig_rotary_position')}


@pytest.fixture(params=[(run, profile) for run in RUNS for profile in PROFILES], ids='-'.join)
def device(request):
    run, profile = request.param
    return devices_of(RUNS[run], profile)[-1]


def refused(action, *args, **options):
    """Return the abort code of an access that is refused."""
    with pytest.raises(SdoAbort) as error:
        action(*args, **options)
    return error.value.code


def packed(entry, value):
    return struct.pack(f'<{FORMATS[entry.data_type.name]}', value)


def beyond(entry, bound, side):
    """Return a value beyond a bound: for a real number far enough for single precision."""
    return bound + side * (1 if entry.data_type.is_integer else 1 + abs(bound))


def plain(device):
    """Yield the entries that are not written by the rules of mappings."""
    return (one for one in device.table.entries if not is_changed_in_preop(one.index))


def test_every_readable_entry_has_the_bytes_of_its_type(device):
    for entry in device.table.entries:
        data = device.read(entry.index, entry.subindex)
        if entry.data_type.bits:
            assert len(data) == -(-entry.data_type.bits // 8), entry
        else:
            assert data.decode().isprintable()


def test_what_is_read_only_refuses_to_be_written(device):
    for entry in device.table.entries:
        if entry.access in ('ro', 'const'):
            data = device.read(entry.index, entry.subindex)
            assert refused(device.write, entry.index, entry.subindex, data,
                           is_preoperational=True) == abort.READ_ONLY, entry


def test_what_may_be_written_is_read_back(device):
    for entry in plain(device):
        if entry.access != 'rw' or entry.index in (0x1003, 0x1010, 0x1011, 0x6060):
            continue    # deleted, stored and restored; refused in some wirings
        value = entry.choices[-1] if entry.choices else entry.default
        data = packed(entry, value)
        device.write(entry.index, entry.subindex, data, is_preoperational=False)
        assert device.read(entry.index, entry.subindex) == data, entry


def test_a_wrong_length_is_refused_and_changes_nothing(device):
    for entry in device.table.entries:
        if entry.is_writable:
            before = device.read(entry.index, entry.subindex)
            for data, code in ((before[:-1], abort.TOO_SHORT), (before + b'\0', abort.TOO_LONG)):
                assert refused(device.write, entry.index, entry.subindex, data,
                               is_preoperational=True) == code, entry
            assert device.read(entry.index, entry.subindex) == before


def test_values_beyond_the_range_are_refused_by_side(device):
    checked = 0
    for entry in plain(device):
        if not entry.is_writable or entry.choices:
            continue
        if math.isfinite(entry.high):
            data = packed(entry, beyond(entry, entry.high, 1))
            assert refused(device.write, entry.index, entry.subindex, data,
                           is_preoperational=False) == abort.TOO_HIGH
            checked += 1
        if math.isfinite(entry.low):
            data = packed(entry, beyond(entry, entry.low, -1))
            assert refused(device.write, entry.index, entry.subindex, data,
                           is_preoperational=False) == abort.TOO_LOW
            checked += 1
    assert checked > 10


def test_values_that_are_no_choice_are_refused(device):
    for entry in plain(device):
        if entry.choices:
            other = packed(entry, max(entry.choices) + 1)
            assert refused(device.write, entry.index, entry.subindex, other,
                           is_preoperational=False) == abort.OUT_OF_RANGE, entry


def test_no_number_is_refused(device):
    for entry in plain(device):
        if entry.is_writable and not entry.data_type.is_integer:
            assert refused(device.write, entry.index, entry.subindex, packed(entry, math.nan),
                           is_preoperational=False) == abort.OUT_OF_RANGE


def test_what_does_not_exist_is_refused(device):
    assert refused(device.read, 0x5FFF, 0) == abort.NO_OBJECT
    assert refused(device.read, 0x6040, 1) == abort.NO_SUBINDEX
    assert refused(device.write, 0x5FFF, 0, b'\0', is_preoperational=True) == abort.NO_OBJECT
    assert refused(device.read_all, 0x5FFF) == abort.NO_OBJECT
    assert refused(device.write_all, 0x1604, b'\0\0', is_preoperational=True) == abort.NO_OBJECT
    assert refused(device.read_all, 0x1604) == abort.NO_OBJECT
    assert refused(device.size, 0x1604) == abort.NO_OBJECT


def test_complete_access_is_all_entries_behind_16_bits(device):
    for one in device.table:
        if len(one.entries) == 1:
            assert refused(device.read_all, one.index) == abort.NO_COMPLETE_ACCESS
            continue
        data = device.read_all(one.index)
        count = data[0] if is_changed_in_preop(one.index) else len(one.entries) - 1
        assert data == device.read(one.index, 0) + b'\0' + b''.join(
            device.read(one.index, entry.subindex) for entry in one.entries[1:1 + count])


def test_complete_access_writes_all_entries_or_none(device):
    gains = device.table.at(0x2030)
    before = device.read_all(0x2030)
    values = list(struct.unpack(f'<{len(gains.entries) - 1}f', before[2:]))
    values[0] *= 0.5
    data = before[:2] + struct.pack(f'<{len(values)}f', *values)
    device.write_all(0x2030, data, is_preoperational=False)
    assert device.read_all(0x2030) == data
    name = gains.entries[1].name
    assert device.changes()[name] == values[0]
    values[0], values[-1] = 1.0, -1e30
    assert refused(device.write_all, 0x2030, before[:2] + struct.pack(
        f'<{len(values)}f', *values), is_preoperational=False) == abort.TOO_LOW
    assert device.read_all(0x2030) == data
    assert refused(device.write_all, 0x2030, data[:-1],
                   is_preoperational=False) == abort.WRONG_LENGTH
    assert refused(device.write_all, 0x2030, b'\1\0' + data[2:],
                   is_preoperational=False) == abort.OUT_OF_RANGE
    assert refused(device.write_all, 0x1018, device.read_all(0x1018),
                   is_preoperational=False) == abort.READ_ONLY


def test_the_bus_itself_sets_what_is_constant_for_masters(device):
    device.store(0x1014, 0, 0x85)
    assert device.read(0x1014, 0) == b'\x85\0\0\0'
