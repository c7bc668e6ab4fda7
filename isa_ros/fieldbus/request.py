"""
The options of `isa bus` besides those of a run.

This module imports neither ROS nor numba: `isa --help` imports it.
"""

from dataclasses import dataclass
from pathlib import Path

from isa_ros.run.options import Request

ETHERCAT, CANOPEN, MIT, SERIAL = 'ethercat', 'canopen', 'mit', 'serial'

FRAME, REAL_TIME = 'frame', 'real_time'
PACES = (FRAME, REAL_TIME)

PROFILES = ('cia402', 'cia408')

OF_THE_WIRE = 0
"""A rate that stands for that of `isa_ros/config/data/wires`."""
WATCHDOG_MS = 100.0


@dataclass(frozen=True, kw_only=True)
class BusRequest:
    """A run whose commands come from the master of a bus."""

    run: Request
    bus: str
    """`ETHERCAT`, `CANOPEN`, `MIT` or `SERIAL`."""
    interface: str = ''
    """Network interface of EtherCAT; interface of python-can."""
    channel: str = ''
    """Of python-can."""
    bitrate: int = OF_THE_WIRE
    """Of the CAN bus, bit/s."""
    first_node: int = 1
    """Number of the first actuator on the CAN bus."""
    path: Path = Path()
    """Of the serial device."""
    baud: int = OF_THE_WIRE
    """Of the serial line, bit/s."""
    pace: str = FRAME
    """One of `PACES`."""
    profile: str = PROFILES[0]
    """One of `PROFILES`."""
    watchdog_ms: float = WATCHDOG_MS
    """Silence after which the bus counts as lost, in real-time pace."""
    has_ros: bool = True
    """Whether there are ROS nodes beside the bus."""

    @property
    def place(self) -> str:
        """Return where a master finds the devices."""
        return str(self.path) if self.bus == SERIAL else f'{self.interface} {self.channel}'.strip()
