"""The files for ros2_canopen: taken by dcfgen, and as its drivers of CiA 402 use them."""

import struct
from xml.etree import ElementTree

import isa_ros
from isa_ros.cli.main import main
from isa_ros.errors import ConfigError
from isa_ros.fieldbus.description.ros2_canopen import ros2_canopen_files
from isa_ros.fieldbus.device.devices import devices_of
import pytest
from tests.fieldbus.canopen.virtual_bus import OPERATIONAL, START, virtual_master
from tests.fieldbus.description.dcfgen import dcfgen, needs_dcfgen
import yaml

NAMES, STEP_NS = ('haa', 'hfe', 'kfe'), 2_000_000
LEG = isa_ros.load('leg').replace({'step_ms': 2}).configuration
KEYS = {'node_id', 'dcf', 'driver', 'package', 'period', 'heartbeat_producer',
        'scale_pos_to_dev', 'scale_pos_from_dev', 'scale_vel_to_dev', 'scale_vel_from_dev',
        'scale_eff_from_dev'}
READ = {0x6041: 'UNSIGNED16', 0x6061: 'INTEGER8', 0x6064: 'INTEGER32', 0x606C: 'INTEGER32',
        0x6077: 'INTEGER16'}
WRITTEN = {0x6040: 'UNSIGNED16', 0x6060: 'INTEGER8', 0x607A: 'INTEGER32', 0x60FF: 'INTEGER32',
           0x6071: 'INTEGER16'}
"""What the driver of CiA 402 reads and writes at every period, with its types (6ada196)."""


@pytest.fixture(scope='module')
def made(tmp_path_factory):
    directory = tmp_path_factory.mktemp('made') / 'new'
    assert main(['bus', 'describe', 'leg', '--set', 'step_ms=2', '--ros2-canopen',
                 str(directory)]) == 0
    return directory


@pytest.fixture(scope='module')
def bus(made):
    return yaml.safe_load((made / 'bus.yml').read_text())


def test_the_master_has_a_node_of_its_own_and_the_tick_as_period(bus):
    assert bus['master']['sync_period'] == STEP_NS // 1000
    nodes = [one['node_id'] for name, one in bus.items() if name != 'options']
    assert len(set(nodes)) == len(nodes) == 1 + len(NAMES)
    assert [bus[name]['node_id'] for name in NAMES] == [1, 2, 3]


def test_counts_and_si_are_those_of_the_objects(bus):
    for device in devices_of(LEG):
        own = bus[device.name]
        assert set(own) == KEYS
        for kind, index in (('pos', 0x6064), ('vel', 0x606C), ('eff', 0x6077)):
            scale = device.table.entry(index).scale
            assert own[f'scale_{kind}_from_dev'] == pytest.approx(scale, rel=1e-11, abs=0.0)
        for kind, index in (('pos', 0x607A), ('vel', 0x60FF)):
            scale = device.table.entry(index).scale
            assert own[f'scale_{kind}_to_dev'] * scale == pytest.approx(1.0, rel=1e-11)
        assert own['scale_eff_from_dev'] != 1.0


def test_what_the_driver_uses_is_there_and_exchanged_in_every_cycle():
    """What is not mapped it would read by SDO, a round trip for each value and period."""
    for device in devices_of(LEG):
        for pdos, used in (((0x1A00, 0x1A01), READ), ((0x1600, 0x1601), WRITTEN)):
            mapped = {int.from_bytes(device.read(pdo, k + 1), 'little') >> 16
                      for pdo in pdos for k in range(device.read(pdo, 0)[0])}
            for index, name in used.items():
                assert device.table.entry(index).data_type.name == name
                assert index in mapped
        assert device.table.entry(0x6502).data_type.name == 'UNSIGNED32'


def test_the_tag_names_the_files_and_the_nodes(made, bus):
    root = ElementTree.parse(made / 'ros2_control.urdf.xacro').getroot()
    own = root.find('ros2_control')
    parameters = {one.get('name'): one.text for one in own.iterfind('hardware/param')}
    assert parameters == {
        'bus_config': f'{made}/bus.yml', 'master_config': f'{made}/master.dcf',
        'can_interface_name': 'can0', 'master_bin': f'{made}/master.bin'}
    joints = {one.get('name'): int(one.findtext('param')) for one in own.iterfind('joint')}
    assert joints == {name: bus[name]['node_id'] for name in NAMES}


@needs_dcfgen
def test_a_node_takes_what_dcfgen_configures(made):
    """The master reads NAME.bin: a count, then index, subindex, size and data of each write."""
    dcfgen(made / 'bus.yml')
    assert (made / 'master.dcf').exists() and (made / 'master.bin').exists()
    for k, name in enumerate(NAMES):
        concise = (made / f'{name}.bin').read_bytes()
        count, place = struct.unpack_from('<I', concise)[0], 4
        assert count >= 1
        with virtual_master([devices_of(LEG)[k]], STEP_NS) as master:
            for _ in range(count):
                index, subindex, size = struct.unpack_from('<HBI', concise, place)
                place += 7 + size
                value = int.from_bytes(concise[place - size:place], 'little')
                master.write(index, subindex, value, size)
                assert master.read(index, subindex) == value.to_bytes(size, 'little')
            master.command(START)
            assert master.line.nodes[0].state == OPERATIONAL
        assert place == len(concise)


def test_a_bus_that_is_too_slow_and_a_name_of_the_driver_are_refused(tmp_path, capsys):
    assert main(['bus', 'describe', 'leg', '--ros2-canopen', str(tmp_path / 'none')]) == 2
    assert 'CAN at 1 Mbit/s carries 1000 bit' in capsys.readouterr().err
    assert not (tmp_path / 'none').exists()
    device = devices_of(LEG)[0]
    device.name = 'my_master_arm'
    with pytest.raises(ConfigError, match="my_master_arm: must not contain 'master'"):
        ros2_canopen_files([device], STEP_NS, tmp_path)
