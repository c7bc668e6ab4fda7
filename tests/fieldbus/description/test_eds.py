"""The EDS of a device, read by the package that CANopen masters in Python use."""

import io

import isa_ros
from isa_ros.fieldbus.description.eds import eds_text
from isa_ros.fieldbus.device.devices import devices_of, PROFILES
from isa_ros.fieldbus.device.objects import ObjectCode
import pytest

canopen = pytest.importorskip('canopen')
NODE = 5
LEG = isa_ros.load('leg').configuration


def imported(device):
    source = io.StringIO(eds_text(device))
    source.name = 'actuator.eds'
    return canopen.import_od(source, NODE)


@pytest.fixture(params=PROFILES)
def device(request):
    return devices_of(LEG, request.param)[-1]


def test_every_object_of_canopen_is_read_with_type_access_and_default(device):
    dictionary = imported(device)
    table = device.table.on('canopen')
    assert set(dictionary) == {one.index for one in table}
    for one in table:
        read = dictionary[one.index]
        assert read.name == one.name
        for entry in one.entries:
            variable = read if one.kind is ObjectCode.VAR else read[entry.subindex]
            assert (variable.name, variable.data_type) == (entry.name, entry.data_type.number)
            assert variable.readable == entry.is_readable
            assert variable.writable == entry.is_writable
            assert variable.pdo_mappable == bool(entry.pdo)
            expected = entry.default + NODE if entry.adds_node else entry.default
            assert variable.default == expected, entry


def test_scales_and_units_give_si(device):
    """0x6064 of CiA 402 and 0x6601 of CiA 408 count micrometres."""
    dictionary = imported(device)
    position = dictionary[0x6064] if 0x6064 in dictionary else dictionary[0x6601][1]
    assert (position.unit, position.decode_phys(50000)) == ('m', 50000 * 1e-6)


def test_limits_are_those_of_the_table(device):
    dictionary = imported(device)
    for entry in device.table.on('canopen').entries:
        if entry.data_type.is_integer and entry.is_writable and entry.high < 2 ** 31:
            read = dictionary.get_variable(entry.index, entry.subindex)
            if entry.high < entry.data_type.limits[1]:
                assert read.max == entry.high


def test_identity_and_pdos_are_stated(device):
    information = imported(device).device_information
    assert information.vendor_number == 0xBAD and 'placeholder' in information.vendor_name
    assert information.product_number == device.identity.product
    assert (information.nr_of_RXPDO, information.nr_of_TXPDO) == (4, 4)
    assert 1_000_000 in information.allowed_baudrates


def test_objects_of_ethercat_are_left_out(device):
    assert '[1C12]' not in eds_text(device) and '[1610]' not in eds_text(device)
    assert '[1600]' in eds_text(device)
