"""The EDS of a device, read by the packages that masters in Python and Lely's C++ use."""

from configparser import ConfigParser
import io

import isa_ros
from isa_ros.fieldbus.description.eds import eds_text
from isa_ros.fieldbus.device.devices import devices_of, PROFILES
from isa_ros.fieldbus.device.objects import DataType, ObjectCode
import pytest
from tests.fieldbus.description.dcfgen import dcfgen, needs_dcfgen

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
            if entry.data_type is DataType.REAL32:
                found = DataType.REAL32.unpack(
                    int(variable.default_raw, 16).to_bytes(4, 'little'))
                assert found == pytest.approx(expected, rel=2.0 ** -24, abs=0.0), entry
            else:
                assert variable.default == expected, entry


def test_there_are_defaults_of_real_numbers_that_are_not_zero(device):
    """What the test above compares: the increments and the gains of the REU."""
    assert sum(entry.data_type is DataType.REAL32 and entry.default not in (0, 1)
               for entry in device.table.on('canopen').entries) >= 8


def test_unit_scale_and_meaning_are_a_comment_above_the_section(device):
    """0x6064 of CiA 402 and 0x6601 of CiA 408 count micrometres; 0x1017 is a time in ms."""
    position = '[6064]' if 0x6064 in device.table else '[6601sub1]'
    lines = eds_text(device).splitlines()
    assert lines[lines.index(position) - 1].startswith('; 1e-06 m a count')
    assert lines[lines.index('[1017]') - 1] == '; 0.001 s a count: wall time; 0: off'


def test_a_value_has_no_second_equals_sign_and_no_comment(device):
    """eds-utils splits at each '='; ';' and '#' begin a comment within a value too."""
    for line in eds_text(device).splitlines():
        if not line.startswith((';', '[')) and line:
            assert line.count('=') == 1, line
            assert not {';', '#'} & set(line), line


@needs_dcfgen
def test_dcfgen_takes_the_files_of_a_leg_in_strict_mode(tmp_path):
    """It writes what a master expects of each node: product codes in 0x1F86."""
    names, bus = [], ['master: {node_id: 127, sync_period: 1000}']
    for profile in PROFILES:
        for one in devices_of(LEG, profile):
            name = f'{profile}_{one.name}'
            names.append(name)
            (tmp_path / f'{name}.eds').write_text(eds_text(one))
            bus.append(f'{name}: {{node_id: {len(names)}, dcf: {tmp_path}/{name}.eds, '
                       'heartbeat_producer: 100}')
    (tmp_path / 'bus.yml').write_text('\n'.join(bus))
    assert dcfgen(tmp_path / 'bus.yml') == [
        f'{name}: writing 2 bytes to 0x1017/0: 64 00' for name in names]
    master = ConfigParser()
    master.read(tmp_path / 'master.dcf')
    products = [int(master['1F86Value'][str(k + 1)], 16) for k in range(len(names))]
    assert products == [
        one.identity.product for profile in PROFILES for one in devices_of(LEG, profile)]


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
