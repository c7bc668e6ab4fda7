"""What a master wants to know of the devices of a run, as files or for a terminal."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from isa_ros.config.text.names import flat
from isa_ros.fieldbus.description.eds import eds_text
from isa_ros.fieldbus.description.esi import esi_text
from isa_ros.fieldbus.description.object_page import table_lines
from isa_ros.fieldbus.description.ros2_canopen import ros2_canopen_files
from isa_ros.fieldbus.description.ros2_control import ros2_control_files
from isa_ros.fieldbus.device.bus_device import BusDevice


Described = Callable[[Sequence[BusDevice], int, Path], dict[Path, str]]
FOLDERS: Mapping[str, Described] = {
    'ros2_control': ros2_control_files, 'ros2_canopen': ros2_canopen_files}
"""Files for a driver, by its option, of devices with this tick in ns and in this directory."""


def described(
        devices: Sequence[BusDevice], esi: Path | None, eds: Path | None) -> dict[Path, str]:
    """Return the texts of the files asked for; each of several devices has its own EDS."""
    found: dict[Path, str] = {}
    if esi is not None:
        found[esi] = esi_text(devices)
    if eds is not None:
        for device in devices:
            own = eds if len(devices) == 1 else eds.with_stem(f'{eds.stem}_{flat(device.name)}')
            found[own] = eds_text(device)
    return found


def tables_of(devices: Sequence[BusDevice]) -> str:
    """Return the objects of every kind of device; actuators of a kind have the same product."""
    parts = []
    for product in dict.fromkeys(device.identity.product for device in devices):
        kin = [device for device in devices if device.identity.product == product]
        names = ', '.join(device.name for device in kin)
        parts.append('\n'.join([f'{names}: product 0x{product:08X}', *table_lines(kin[0])]))
    return '\n\n'.join(parts)
