"""What the ROS 2 drivers of CiA 402 want to know of a device, in SI."""

from typing import NamedTuple

from isa_ros.config.text.names import flat
from isa_ros.errors import ConfigError
from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.device.cia402_objects import (
    CSP, CST, LARGEST_POSITION, LEAST_POSITION, TARGET_POSITION, TARGET_TORQUE, TARGET_VELOCITY)
from isa_ros.fieldbus.device.objects import ObjectEntry

_SUPPORTED = (0x6502, 0)
_BITS = {CSP: 7, CST: 9}


class DescribedDrive(NamedTuple):
    """A device of the profile CiA 402."""

    device: BusDevice
    mode: int
    """Of operation: cyclic synchronous position, torque where there is none."""
    position: ObjectEntry
    velocity: ObjectEntry
    torque: ObjectEntry

    @property
    def name(self) -> str:
        """Return the name of its driver, its joint and its file, which have no slash."""
        return flat(self.device.name)

    @property
    def positions(self) -> tuple[float, float]:
        """Return the least and the largest position, m or rad."""
        table = self.device.table
        low, high = (table.entry(*key) for key in (LEAST_POSITION, LARGEST_POSITION))
        return float(low.default) * low.scale, float(high.default) * high.scale


def drive_of(device: BusDevice) -> DescribedDrive:
    """
    Return a device as a drive.

    Raises
    ------
    ConfigError
        It is of another profile, or has neither mode.

    """
    if _SUPPORTED not in device.table:
        raise ConfigError(f'{device.name}: profile must be cia402, which the ROS 2 drivers speak')
    supported = int(device.table.entry(*_SUPPORTED).default)
    modes = [mode for mode, bit in _BITS.items() if supported >> bit & 1]
    if not modes:
        raise ConfigError(
            f'{device.name}: 0x6502 = 0x{supported:08X}, must have mode {CSP} or {CST}: an '
            'actuator with a position or force block has one')
    return DescribedDrive(device, modes[0], *(device.table.entry(*key) for key in (
        TARGET_POSITION, TARGET_VELOCITY, TARGET_TORQUE)))


def number(value: float) -> str:
    """Return a real number as every reader of YAML takes it for one: with a point."""
    text = f'{value:.12g}'
    if '.' not in text:
        text = text.replace('e', '.0e') if 'e' in text else f'{text}.0'
    return text
