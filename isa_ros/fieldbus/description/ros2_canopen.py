"""
Files for `ros2_canopen`: the EDS of each node, ``bus.yml``, and the tag of the robot description.

``bus.yml`` has the nodes at its top level, the form that both ``dcfgen`` and the driver read; the
defaults of the devices are the mapping that the driver needs. ``dcfgen -d DIR DIR/bus.yml`` makes
``master.dcf`` and the ``.bin`` files.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path

from isa_ros.errors import ConfigError
from isa_ros.fieldbus.canopen.line import default_bitrate, planned_line
from isa_ros.fieldbus.description.drive_402 import DescribedDrive, drive_of, number
from isa_ros.fieldbus.description.eds import eds_text
from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.device.can_identifiers import FIRST_NODE, LAST_NODE

_HEARTBEAT_MS = 200
_NS_PER_US, _NS_PER_MS = 1000, 1_000_000
_MASTER_WORDS = ('master', 'options')
"""The driver takes whatever has these in its name for its own sections."""


def ros2_canopen_files(
        devices: Sequence[BusDevice], step_ns: int, directory: Path) -> dict[Path, str]:
    """
    Return the files by path.

    Raises
    ------
    ConfigError
        A device is no drive of CiA 402, a name is one of the driver's own, or the frames of a
        tick do not fit the bus.

    """
    drives = [drive_of(device) for device in devices]
    for drive in drives:
        for word in _MASTER_WORDS:
            if word in drive.device.name:
                raise ConfigError(
                    f'{drive.device.name}: must not contain {word!r}, which ros2_canopen takes '
                    'for its own section of bus.yml')
    planned_line(devices, step_ns, default_bitrate(), FIRST_NODE)
    place = directory.resolve()
    return {
        **{directory / f'{drive.name}.eds': eds_text(drive.device) for drive in drives},
        directory / 'bus.yml': '\n'.join(_bus(drives, step_ns, place)) + '\n',
        directory / 'ros2_control.urdf.xacro': '\n'.join(_tag(drives, place)) + '\n'}


def _bus(drives: Sequence[DescribedDrive], step_ns: int, place: Path) -> Iterator[str]:
    yield '# Simulated by isa_ros; SYNC is the tick. dcfgen -d DIR DIR/bus.yml makes master.dcf.'
    yield 'options:'
    yield f'  dcf_path: "{place}"'
    yield ''
    yield 'master:'
    yield f'  node_id: {LAST_NODE}'
    yield '  driver: "ros2_canopen::MasterDriver"'
    yield '  package: "canopen_master_driver"'
    yield f'  sync_period: {step_ns // _NS_PER_US}  # us'
    for node, drive in enumerate(drives, FIRST_NODE):
        name = drive.name
        position, velocity, torque = drive.position, drive.velocity, drive.torque
        yield ''
        yield f'{name}:'
        yield f'  node_id: {node}'
        yield f'  dcf: "{place}/{name}.eds"'
        yield '  driver: "ros2_canopen::Cia402Driver"'
        yield '  package: "canopen_402_driver"'
        yield f'  period: {max(1, step_ns // _NS_PER_MS)}  # ms'
        yield f'  heartbeat_producer: {_HEARTBEAT_MS}'
        yield f'  scale_pos_to_dev: {number(1.0 / position.scale)}  # counts per {position.unit}'
        yield f'  scale_pos_from_dev: {number(position.scale)}'
        yield f'  scale_vel_to_dev: {number(1.0 / velocity.scale)}  # counts per {velocity.unit}'
        yield f'  scale_vel_from_dev: {number(velocity.scale)}'
        yield f'  scale_eff_from_dev: {number(torque.scale)}  # {torque.unit} per count'


def _tag(drives: Sequence[DescribedDrive], place: Path) -> Iterator[str]:
    yield '<?xml version="1.0"?>'
    yield '<!-- A joint is the own coordinate of an actuator: m and N of a cylinder. -->'
    yield '<robot xmlns:xacro="http://www.ros.org/wiki/xacro">'
    yield '  <ros2_control name="isa_ros" type="system">'
    yield '    <hardware>'
    yield '      <plugin>canopen_ros2_control/Cia402System</plugin>'
    yield f'      <param name="bus_config">{place}/bus.yml</param>'
    yield f'      <param name="master_config">{place}/master.dcf</param>'
    yield '      <param name="can_interface_name">can0</param>'
    yield f'      <param name="master_bin">{place}/master.bin</param>'
    yield '    </hardware>'
    for node, drive in enumerate(drives, FIRST_NODE):
        yield f'    <joint name="{drive.name}">'
        yield f'      <param name="node_id">{node}</param>'
        yield '    </joint>'
    yield '  </ros2_control>'
    yield '</robot>'
