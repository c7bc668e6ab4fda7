"""The files for ethercat_driver_ros2, used as the driver uses them on a real actuator."""

from dataclasses import replace
import math
import struct
from xml.etree import ElementTree

import isa_ros
from isa_ros.cli.main import main
from isa_ros.errors import ConfigError
from isa_ros.fieldbus.description.drive_402 import drive_of, number
from isa_ros.fieldbus.device.devices import devices_of
from isa_ros.fieldbus.device.objects import ObjectTable
import pytest
from tests.fieldbus.description.ec_driver import EcDriver
from tests.fieldbus.rig import Rig
import yaml

LEG = isa_ros.load('leg').configuration


@pytest.fixture(scope='module')
def files(tmp_path_factory):
    """Return the directory with the files of a leg and of a ram, each by the command."""
    directory = tmp_path_factory.mktemp('made')
    for name in ('leg', 'rig_linear'):
        assert main(['bus', 'describe', name, '--ros2-control', str(directory / name)]) == 0
    return directory


def mapped_by_the_master(device, driver):
    """Write the mapping of a driver as its master does while preoperational."""
    def write(index, subindex, value, size):
        device.write(index, subindex, value.to_bytes(size, 'little'), is_preoperational=True)
    for side, assignment in (('rpdo', 0x1C12), ('tpdo', 0x1C13)):
        pdo, = (one['index'] for one in driver.config[side])
        write(assignment, 0, 0, 1)
        write(pdo, 0, 0, 1)
        for k, word in enumerate(driver.mapping(side)):
            write(pdo, k + 1, word, 4)
        write(pdo, 0, len(driver.mapping(side)), 1)
        write(assignment, 1, pdo, 2)
        write(assignment, 0, 1, 1)


def test_the_driver_enables_a_drive_and_moves_it_in_si(files):
    """From rest it holds the present position; then 5 mm more are commanded, in metres."""
    rig = Rig('rig_linear')
    driver = EcDriver(files / 'rig_linear' / 'ros2_control.urdf.xacro', rig.device.name)
    mapped_by_the_master(rig.device, driver)
    rig.device.begin_operation()

    def cycle():
        rig.device.receive(0x1611, driver.outputs())
        rig.tick()
        driver.take(rig.device.transmit(0x1A11))
    for _ in range(100):
        cycle()
    assert driver.is_enabled
    start = driver.states['position']
    assert abs(start - float(rig.sample['position'])) < 1e-6
    target = start + 0.005
    driver.commands['position'] = target
    before = abs(target - start)
    for _ in range(400):
        cycle()
    assert abs(driver.states['position'] - target) < 0.2 * before
    entry = rig.device.table.entry(0x6077)
    assert driver.states['effort'] == pytest.approx(
        float(rig.sample['force']), abs=entry.scale)
    assert driver.frequency == 1000.0 and driver.mode == 8


def test_gains_are_commanded_in_mode_8(files):
    """Without a command the stiffness in force stays, which 0x2010 says by NaN."""
    rig = Rig('rig_linear')
    driver = EcDriver(files / 'rig_linear' / 'ros2_control.urdf.xacro', rig.device.name)
    mapped_by_the_master(rig.device, driver)
    for one in driver.config['sdo']:
        rig.device.write(one['index'], one['sub_index'], bytes([one['value']]),
                         is_preoperational=True)
    driver.commands |= {'stiffness': 40_000.0, 'damping': 500.0}
    rig.device.receive(0x1611, driver.outputs())
    gains = [struct.unpack('<f', rig.device.read(0x2010, k))[0] for k in (1, 2)]
    assert gains == [40_000.0, 500.0] and rig.device.read(0x2012, 0) == b'\1'
    driver.commands |= {'stiffness': math.nan}
    rig.device.receive(0x1611, driver.outputs())
    assert math.isnan(struct.unpack('<f', rig.device.read(0x2010, 1))[0])


def test_the_range_of_a_joint_is_the_stroke(files):
    """Of the leg: 0.1 m of a cylinder, 1.745 rad of the rotary one, as 0x2001:1."""
    root = ElementTree.parse(files / 'leg' / 'ros2_control.urdf.xacro').getroot()
    for device in devices_of(LEG):
        own, = (one for one in root.iterfind('ros2_control/joint')
                if one.get('name') == device.name)
        ends = [float(one.text) for one in own.iterfind('command_interface/param')]
        stroke, = struct.unpack('<f', device.read(0x2001, 1))
        assert ends == [0.0, pytest.approx(stroke, rel=2.0 ** -23, abs=0.0)]


def test_every_slave_of_a_leg_is_at_its_place_and_takes_its_mapping(files):
    for k, device in enumerate(devices_of(LEG)):
        driver = EcDriver(files / 'leg' / 'ros2_control.urdf.xacro', device.name)
        assert driver.place == k
        assert driver.config['vendor_id'] == device.identity.vendor
        assert driver.config['product_id'] == device.identity.product
        mapped_by_the_master(device, driver)
        for side, pdo in (('rpdo', 0x1611), ('tpdo', 0x1A11)):
            assert device.size(pdo) == sum(word & 0xFF for word in driver.mapping(side)) // 8


def test_factors_are_those_of_the_objects(files):
    for device in devices_of(LEG):
        config = yaml.safe_load((files / 'leg' / f'{device.name}.yaml').read_text())
        for side, power in (('rpdo', -1), ('tpdo', 1)):
            for one in config[side][0]['channels']:
                entry = device.table.entry(one['index'], one['sub_index'])
                assert one.get('factor', 1.0) == pytest.approx(
                    entry.scale ** power, rel=1e-11, abs=0.0)
    force = [one for one in config['rpdo'][0]['channels'] if one['index'] == 0x6071]
    assert force[0]['command_interface'] == 'effort' and force[0]['factor'] != 1.0


def test_a_target_without_a_command_is_no_target(files):
    """0 would be a jump to the end stop; the driver sends the present position for NaN."""
    config = yaml.safe_load((files / 'leg' / 'kfe.yaml').read_text())
    defaults = {one['index']: one['default'] for one in config['rpdo'][0]['channels']}
    assert math.isnan(defaults.pop(0x607A))
    assert defaults.pop(0x6060) == 8 and defaults.pop(0x2011) == 0xFFFFFFFF
    assert set(defaults.values()) == {0}


def test_another_profile_is_refused_in_one_line(tmp_path, capsys):
    for option in ('--ros2-control', '--ros2-canopen'):
        made = tmp_path / option
        assert main(['bus', 'describe', 'leg', '--profile', 'cia408', option, str(made)]) == 2
        assert capsys.readouterr().err == (
            'isa: haa: profile must be cia402, which the ROS 2 drivers speak\n')
        assert not made.exists()


def supporting(bits):
    """Return the knee with other supported drive modes."""
    device = devices_of(LEG)[-1]
    device.table = ObjectTable([
        replace(one, entries=(replace(one.entries[0], default=bits),))
        if one.index == 0x6502 else one for one in device.table])
    return device


def test_a_drive_without_a_position_mode_is_driven_by_torque():
    assert drive_of(supporting(1 << 9)).mode == 10
    assert drive_of(supporting(1 << 7)).mode == drive_of(supporting(0x380)).mode == 8
    with pytest.raises(ConfigError, match='0x6502 = 0x00010100, must have mode 8 or 10'):
        drive_of(supporting(0x10100))


@pytest.mark.parametrize(('value', 'text'), [
    (1e6, '1000000.0'), (1e-6, '1.0e-06'), (7.5, '7.5'), (1 / 7.5, '0.133333333333'),
    (1.25e-7, '1.25e-07'), (1e20, '1.0e+20')])
def test_numbers_are_real_for_every_reader_of_yaml(value, text):
    assert number(value) == text
    assert isinstance(yaml.safe_load(text), float)
