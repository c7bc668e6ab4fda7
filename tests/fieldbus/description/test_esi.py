"""The ESI of a run's devices, read with the XML parser of the standard library."""

from xml.etree import ElementTree

import isa_ros
from isa_ros.fieldbus.description.esi import esi_text
from isa_ros.fieldbus.device.devices import devices_of, PROFILES
from isa_ros.fieldbus.device.objects import ObjectCode
from isa_ros.fieldbus.ethercat.sii import build_sii
import pytest

LEG = isa_ros.load('leg').configuration


@pytest.fixture(params=PROFILES)
def devices(request):
    return devices_of(LEG, request.param)


@pytest.fixture
def root(devices):
    return ElementTree.fromstring(esi_text(devices))


def number(text):
    """Return a number as ESI writes it."""
    return int(text.removeprefix('#x'), 16 if text.startswith('#x') else 10)


def described(root):
    """Return the descriptions by product."""
    return {number(one.find('Type').get('ProductCode')): one for one in root.iter('Device')}


def test_each_kind_of_actuator_is_described_once(devices, root):
    assert list(described(root)) == [devices[0].identity.product, devices[1].identity.product]
    assert number(root.findtext('Vendor/Id')) == 0xBAD
    assert 'placeholder' in root.findtext('Vendor/Name')


def test_the_dictionary_has_every_object_of_the_table(devices, root):
    for device in (devices[0], devices[1]):
        found = described(root)[device.identity.product]
        types = {one.findtext('Name'): one for one in found.iter('DataType')}
        objects = {number(one.findtext('Index')): one for one in found.iter('Object')}
        table = device.table.on('ethercat')
        assert set(objects) == {one.index for one in table}
        for one in table:
            read = objects[one.index]
            own = types[read.findtext('Type')]
            assert read.findtext('Name') == one.name
            assert read.findtext('BitSize') == own.findtext('BitSize')
            if one.kind is ObjectCode.VAR:
                assert read.findtext('Flags/Access')[:2] in ('ro', 'rw')
                continue
            items = own.findall('SubItem')
            assert [item.findtext('Name') for item in items] == [
                entry.name for entry in one.entries]
            assert len(read.findall('Info/SubItem')) == len(items)
            for item in items:
                assert item.findtext('Type') in types
            last = items[-1]
            assert int(own.findtext('BitSize')) == int(last.findtext('BitOffs')) + int(
                last.findtext('BitSize'))


def test_defaults_are_the_bytes_of_the_device(devices, root):
    device = devices[-1]
    found = described(root)[device.identity.product]
    for one in found.iter('Object'):
        if one.find('Info/DefaultData') is not None and number(one.findtext('Index')) >= 0x2000:
            entry = device.table.entry(number(one.findtext('Index')))
            assert bytes.fromhex(one.findtext('Info/DefaultData')) == entry.data_type.pack(
                entry.default)


def test_process_data_are_as_long_as_their_sync_managers(devices, root):
    for device in devices:
        found = described(root)[device.identity.product]
        managers = found.findall('Sm')
        assert [one.text for one in managers] == ['MBoxOut', 'MBoxIn', 'Outputs', 'Inputs']
        for tag, place in (('RxPdo', 2), ('TxPdo', 3)):
            bits = sum(int(one.text) for pdo in found.findall(f"{tag}[@Sm='{place}']")
                       for one in pdo.iter('BitLen'))
            assert bits == 8 * int(managers[place].get('DefaultSize'))
            all_pdos = [one.index for one in device.table if one.index >> 9 == (
                0x1600 if place == 2 else 0x1A00) >> 9]
            assert sorted(int(pdo.findtext('Index')[2:], 16)
                          for pdo in found.findall(tag)) == all_pdos


def test_the_eeprom_is_that_of_the_slave(devices, root):
    for device in devices[:2]:
        eeprom, image = described(root)[device.identity.product].find('Eeprom'), build_sii(device)
        assert int(eeprom.findtext('ByteSize')) == len(image)
        assert bytes.fromhex(eeprom.findtext('ConfigData')) == image[:14]


def test_flags_come_in_the_order_of_the_schema(root):
    for flags in root.iter('Flags'):
        tags = [one.tag for one in flags]
        assert tags == [one for one in ('Access', 'Category', 'PdoMapping') if one in tags]
