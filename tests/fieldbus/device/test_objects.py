"""The object table: types, entries and the access to them."""

import math

from hypothesis import given, strategies as st
from isa_ros.fieldbus.device.abort import NO_OBJECT, NO_SUBINDEX, SdoAbort, TOO_LONG, TOO_SHORT
from isa_ros.fieldbus.device.objects import DataType, Object, ObjectCode, ObjectEntry, ObjectTable
import pytest

INTEGERS = [one for one in DataType if one.is_integer]
RECORD = Object(0x2010, 'Impedance', ObjectCode.RECORD, (
    ObjectEntry(0x2010, 0, 'Highest subindex', DataType.UNSIGNED8, 'const', 1),
    ObjectEntry(0x2010, 1, 'Stiffness', DataType.REAL32, 'rw', unit='N/m')))
DICTIONARY = Object(0x1C12, 'Assignment', ObjectCode.VAR, (
    ObjectEntry(0x1C12, 0, 'Assignment', DataType.UNSIGNED16),), bus='ethercat')
TABLE = ObjectTable([RECORD, DICTIONARY])


@given(st.sampled_from(INTEGERS), st.data())
def test_integers_keep_their_value_little_endian(data_type, data):
    low, high = data_type.limits
    value = data.draw(st.integers(low, high))
    raw = data_type.pack(value)
    assert 8 * len(raw) == max(8, data_type.bits)
    assert data_type.unpack(raw) == value
    assert int.from_bytes(raw, 'little', signed=low < 0) == value


@pytest.mark.parametrize('data_type', INTEGERS, ids=lambda one: one.name)
def test_an_integer_beyond_the_type_saturates(data_type):
    low, high = data_type.limits
    assert data_type.unpack(data_type.pack(high + 1)) == high
    assert data_type.unpack(data_type.pack(low - 1)) == low


def test_a_real_number_beyond_single_precision_saturates():
    largest = 3.4028234663852886e38  # (2 - 2^-23) 2^127
    assert DataType.REAL32.unpack(DataType.REAL32.pack(1e300)) == largest
    assert DataType.REAL32.unpack(DataType.REAL32.pack(-1e300)) == -largest
    assert math.isnan(DataType.REAL32.unpack(DataType.REAL32.pack(math.nan)))


def test_a_text_has_no_final_zero():
    assert DataType.VISIBLE_STRING.pack('knee') == b'knee'
    assert DataType.VISIBLE_STRING.unpack(b'knee') == 'knee'


@pytest.mark.parametrize(('data', 'code'), [(b'\0', TOO_SHORT), (b'\0\0\0', TOO_LONG)])
def test_a_wrong_length_is_refused_by_what_is_wrong(data, code):
    with pytest.raises(SdoAbort) as refused:
        DataType.INTEGER16.unpack(data)
    assert refused.value.code == code


def test_entries_are_found_by_index_and_subindex():
    assert TABLE.entry(0x2010, 1).name == 'Stiffness'
    assert [one.index for one in TABLE] == [0x1C12, 0x2010]
    assert 0x2010 in TABLE and (0x2010, 1) in TABLE and (0x2010, 2) not in TABLE


@pytest.mark.parametrize(('index', 'subindex', 'code'), [
    (0x2011, 0, NO_OBJECT), (0x2010, 2, NO_SUBINDEX)])
def test_what_does_not_exist_is_refused_by_its_code(index, subindex, code):
    with pytest.raises(SdoAbort) as refused:
        TABLE.entry(index, subindex)
    assert refused.value.code == code


def test_a_bus_has_its_own_objects_and_those_of_both():
    assert [one.index for one in TABLE.on('ethercat')] == [0x1C12, 0x2010]
    assert [one.index for one in TABLE.on('canopen')] == [0x2010]
