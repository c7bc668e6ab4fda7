"""
Files for `ethercat_driver_ros2`: a YAML file of each slave, and the tag of the robot description.

Its plugin ``EcCiA402Drive`` maps whole numbers only and counts channels without gaps, so that
real numbers of a mapping become their whole-number twins, and gaps are left out; the master writes
this mapping to the slave. A command interface that is NaN, or not there, leaves the ``default``.
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.fieldbus.description.drive_402 import Drive, drive_of, number
from isa_ros.fieldbus.device.bus_device import (
    BusDevice, RECEIVE_ASSIGNMENT, TRANSMIT_ASSIGNMENT)
from isa_ros.fieldbus.device.cia402_objects import (
    CONTROL, MODE, POSITION, TARGET_POSITION, TARGET_TORQUE, TARGET_VELOCITY, TORQUE, VELOCITY)
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.objects import DataType, ObjectEntry
from isa_ros.fieldbus.device.process_data import mapped_keys

PLUGIN, SYSTEM = 'ethercat_generic_plugins/EcCiA402Drive', 'ethercat_driver/EthercatDriver'
_TYPES: Mapping[DataType, str] = {
    DataType.INTEGER8: 'int8', DataType.INTEGER16: 'int16', DataType.INTEGER32: 'int32',
    DataType.UNSIGNED8: 'uint8', DataType.UNSIGNED16: 'uint16', DataType.UNSIGNED32: 'uint32'}
COMMANDS: Mapping[Key, str] = {
    TARGET_POSITION: 'position', TARGET_VELOCITY: 'velocity', TARGET_TORQUE: 'effort'}
STATES: Mapping[Key, str] = {POSITION: 'position', VELOCITY: 'velocity', TORQUE: 'effort'}
"""Names of interfaces that ROS 2 controllers know."""
_NOT_A_NUMBER = '.nan'


def ros2_control_files(
        devices: Sequence[BusDevice], step_ns: int, directory: Path) -> dict[Path, str]:
    """
    Return the files by path: NAME.yaml of each slave, and the tag.

    Raises
    ------
    ConfigError
        A device is no drive of CiA 402.

    """
    drives = [drive_of(device) for device in devices]
    found = {directory / f'{one.device.name}.yaml': '\n'.join(_slave(one)) + '\n'
             for one in drives}
    tag = '\n'.join(_tag(drives, step_ns, directory)) + '\n'
    return {**found, directory / 'ros2_control.urdf.xacro': tag}


def _slave(drive: Drive) -> Iterator[str]:
    device = drive.device
    identity, model = device.identity, device.read(0x1009, 0).decode('ascii')
    yield f'# {device.name}: {model}, simulated by isa_ros; units of the interfaces are SI.'
    yield '# In real-time pace, assign_activate: 0x0300 turns distributed clocks on.'
    yield f'vendor_id: 0x{identity.vendor:08X}'
    yield f'product_id: 0x{identity.product:08X}'
    yield 'auto_fault_reset: false'
    yield 'sm:'
    yield '  - {index: 0, type: output, watchdog: disable}'
    yield '  - {index: 1, type: input, watchdog: disable}'
    yield '  - {index: 2, type: output, pdo: rpdo, watchdog: enable}'
    yield '  - {index: 3, type: input, pdo: tpdo, watchdog: disable}'
    for name, assignment in (('rpdo', RECEIVE_ASSIGNMENT), ('tpdo', TRANSMIT_ASSIGNMENT)):
        yield f'{name}:'
        for pdo in device.assigned(assignment):
            yield f'  - index: 0x{pdo:04X}'
            yield '    channels:'
            for entry in _channels(device, pdo):
                is_received = assignment == RECEIVE_ASSIGNMENT
                keys = _received(entry, drive) if is_received else _transmitted(entry)
                yield f'      - {{{", ".join(keys)}}}  # {_comment(entry)}'


def _channels(device: BusDevice, pdo: int) -> Iterator[ObjectEntry]:
    """Yield the entries of a PDO that are whole numbers, or have a twin that is one."""
    known = [entry for entry in device.table.entries if entry.data_type in _TYPES and entry.pdo]
    for key in mapped_keys(device, pdo):
        entry = device.table.entry(*key)
        if entry.data_type in _TYPES:
            yield entry
        else:
            yield from (one for one in known if one.twin == key)


def _place(entry: ObjectEntry) -> list[str]:
    return [f'index: 0x{entry.index:04X}', f'sub_index: {entry.subindex}',
            f'type: {_TYPES[entry.data_type]}']


def _received(entry: ObjectEntry, drive: Drive) -> list[str]:
    key = entry.index, entry.subindex
    keys, default = _place(entry), str(entry.default)
    name = COMMANDS.get(key) or (_words(entry) if entry.unit else '')
    if name:
        keys.append(f'command_interface: {name}')
    if entry.scale != 1.0:
        keys.append(f'factor: {number(1.0 / entry.scale)}')
    if key == TARGET_POSITION:
        default = _NOT_A_NUMBER     # the plugin takes the measured position for it
    elif key in (CONTROL, MODE):
        default = str(drive.mode) if key == MODE else '0'
    return [*keys, f'default: {default}']


def _transmitted(entry: ObjectEntry) -> list[str]:
    keys, name = _place(entry), STATES.get((entry.index, entry.subindex)) or _words(entry)
    keys.append(f'state_interface: {name}')
    if entry.scale != 1.0:
        keys.append(f'factor: {number(entry.scale)}')
    return keys


def _words(entry: ObjectEntry) -> str:
    """Return the name of an interface made from that of an entry."""
    return ''.join(c if c.isalnum() else '_' for c in entry.name.lower())


def _comment(entry: ObjectEntry) -> str:
    return f'{entry.name}, {entry.unit}' if entry.unit else entry.name


# The tag.

def _tag(drives: Sequence[Drive], step_ns: int, directory: Path) -> Iterator[str]:
    yield '<?xml version="1.0"?>'
    yield '<!-- A joint is the own coordinate of an actuator: m and N of a cylinder. -->'
    yield '<robot xmlns:xacro="http://www.ros.org/wiki/xacro">'
    yield '  <ros2_control name="isa_ros" type="system">'
    yield '    <hardware>'
    yield f'      <plugin>{SYSTEM}</plugin>'
    yield '      <param name="master_id">0</param>'
    yield f'      <param name="control_frequency">{NS_PER_SECOND / step_ns:.12g}</param>'
    yield '    </hardware>'
    for place, drive in enumerate(drives):
        name = drive.device.name
        low, high = map(number, drive.positions)
        yield f'    <joint name="{name}">'
        for state in STATES.values():
            yield f'      <state_interface name="{state}"/>'
        yield '      <command_interface name="position">'
        yield f'        <param name="min">{low}</param>'
        yield f'        <param name="max">{high}</param>'
        yield '      </command_interface>'
        for command in ('velocity', 'effort', 'reset_fault'):
            yield f'      <command_interface name="{command}"/>'
        yield f'      <ec_module name="{name}">'
        yield f'        <plugin>{PLUGIN}</plugin>'
        yield '        <param name="alias">0</param>'
        yield f'        <param name="position">{place}</param>'
        yield f'        <param name="mode_of_operation">{drive.mode}</param>'
        yield f'        <param name="slave_config">{directory.resolve()}/{name}.yaml</param>'
        yield '      </ec_module>'
        yield '    </joint>'
    yield '  </ros2_control>'
    yield '</robot>'
