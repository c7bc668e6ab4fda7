"""
Files for `ethercat_driver_ros2`: a YAML file of each slave, and the tag of the robot description.

Its plugin ``EcCiA402Drive`` maps whole numbers only, so that the PDOs without real numbers are
used, and it counts channels without gaps, so that these are left out; the master writes the
mapping to the slave. The plugin has no negative modes: 0x2012 gives mode 8 the gains of the
process data. A command interface that is NaN, or not there, leaves the ``default``.
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from isa_ros.core.timebase import NS_PER_SECOND
from isa_ros.fieldbus.description.drive_402 import DescribedDrive, drive_of, number
from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.device.cia402_objects import (
    MODE, POSITION, TARGET_POSITION, TARGET_TORQUE, TARGET_VELOCITY, TORQUE, VELOCITY)
from isa_ros.fieldbus.device.dictionary import Key
from isa_ros.fieldbus.device.integer_twins import DAMPING_TWIN, KEEPS, STIFFNESS_TWIN
from isa_ros.fieldbus.device.manufacturer_area import GAINS_OF_CSP
from isa_ros.fieldbus.device.objects import DataType, ObjectEntry
from isa_ros.fieldbus.device.process_data import INTEGER_PDO, mapped_keys, RECEIVE, TRANSMIT

PLUGIN, SYSTEM = 'ethercat_generic_plugins/EcCiA402Drive', 'ethercat_driver/EthercatDriver'
_TYPES: Mapping[DataType, str] = {
    DataType.INTEGER8: 'int8', DataType.INTEGER16: 'int16', DataType.INTEGER32: 'int32',
    DataType.UNSIGNED8: 'uint8', DataType.UNSIGNED16: 'uint16', DataType.UNSIGNED32: 'uint32'}
COMMANDS: Mapping[Key, str] = {
    TARGET_POSITION: 'position', TARGET_VELOCITY: 'velocity', TARGET_TORQUE: 'effort',
    STIFFNESS_TWIN: 'stiffness', DAMPING_TWIN: 'damping'}
STATES: Mapping[Key, str] = {POSITION: 'position', VELOCITY: 'velocity', TORQUE: 'effort'}
"""Interfaces of the tag; the others of a file are named after their objects."""
_DEFAULTS: Mapping[Key, str] = {
    TARGET_POSITION: '.nan', STIFFNESS_TWIN: str(KEEPS), DAMPING_TWIN: str(KEEPS)}
"""What a master sends without a command: of a position the plugin takes the measured one."""


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
    found = {directory / f'{one.name}.yaml': '\n'.join(_slave(one)) + '\n'
             for one in drives}
    tag = '\n'.join(_tag(drives, step_ns, directory)) + '\n'
    return {**found, directory / 'ros2_control.urdf.xacro': tag}


def _slave(drive: DescribedDrive) -> Iterator[str]:
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
    if GAINS_OF_CSP in device.table:
        index, subindex = GAINS_OF_CSP
        yield 'sdo:'
        yield f'  - {{index: 0x{index:04X}, sub_index: {subindex}, type: uint8, value: 1}}'
    for name, first in (('rpdo', RECEIVE), ('tpdo', TRANSMIT)):
        yield f'{name}:'
        yield f'  - index: 0x{first + INTEGER_PDO:04X}'
        yield '    channels:'
        for key in mapped_keys(device, first + INTEGER_PDO):
            entry = device.table.entry(*key)
            keys = _received(entry, drive) if first == RECEIVE else _transmitted(entry)
            yield f'      - {{{", ".join(keys)}}}  # {_comment(entry)}'


def _place(entry: ObjectEntry) -> list[str]:
    return [f'index: 0x{entry.index:04X}', f'sub_index: {entry.subindex}',
            f'type: {_TYPES[entry.data_type]}']


def _received(entry: ObjectEntry, drive: DescribedDrive) -> list[str]:
    key = entry.index, entry.subindex
    keys = _place(entry)
    if entry.unit:
        keys.append(f'command_interface: {COMMANDS.get(key) or _words(entry)}')
    if entry.scale != 1.0:
        keys.append(f'factor: {number(1.0 / entry.scale)}')
    default = str(drive.mode) if key == MODE else _DEFAULTS.get(key, '0')
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

def _tag(drives: Sequence[DescribedDrive], step_ns: int, directory: Path) -> Iterator[str]:
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
        name = drive.name
        low, high = map(number, drive.positions)
        yield f'    <joint name="{name}">'
        for state in STATES.values():
            yield f'      <state_interface name="{state}"/>'
        yield '      <command_interface name="position">'
        yield f'        <param name="min">{low}</param>'
        yield f'        <param name="max">{high}</param>'
        yield '      </command_interface>'
        commands = [words for key, words in COMMANDS.items()
                    if key in drive.device.table and key != TARGET_POSITION]
        for command in (*commands, 'reset_fault'):
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
