"""
The buses of `isa bus`, a row each, and its options besides those of a run.

This module imports neither ROS nor numba: `isa --help` imports it.
"""

from collections.abc import Mapping
from dataclasses import field
from pathlib import Path
from typing import Any, NamedTuple

from isa_ros.config.models.bus_port import BUS_OFF, POWERLESS, PULLED
from isa_ros.core.frozen import frozen
from isa_ros.run.options import Request

FRAME, REAL_TIME = 'frame', 'real_time'
PACES = (FRAME, REAL_TIME)

PROFILES = ('cia402', 'cia408')

OF_THE_WIRE = 0
"""A rate that stands for that of `isa_ros/config/data/wires`."""
WATCHDOG_MS = 100.0


class BusArgument(NamedTuple):
    """An argument of a bus: of the command line, and of its functions under this name."""

    name: str
    meaning: str
    metavar: str | None = None
    kind: type[str] | type[int] | type[Path] | type[bool] = str
    """Whole numbers are > 0; a bool is a flag."""
    default: int | str | None = None
    """None: it must be given."""


class Bus(NamedTuple):
    """
    A kind of bus.

    Its module has two functions, of the devices, ``step_ns`` and its arguments by name: one named
    after the bus, ``serial_line``, which opens a `Line`, and ``refuse_unusable``, which refuses a
    line that cannot be opened or is too slow, and sends nothing; it may return a line for the
    user.
    """

    module: str
    """Below `isa_ros.fieldbus`; a run imports that of its own bus only."""
    serves: str
    arguments: tuple[BusArgument, ...]
    medium: str = ''
    """What it shares with buses at the same place, of which one is served; '': nothing."""
    port_faults: tuple[str, ...] = ()
    """Values of `BusPort` that its line, a `PortLine`, has."""


_CAN = (
    BusArgument('interface', 'interface of python-can: udp_multicast, socketcan, slcan, ...',
                'NAME'),
    BusArgument('channel', 'of that interface'),
    BusArgument('bitrate', 'of the bus (default: 1000000)', 'BIT/S', int, OF_THE_WIRE),
    BusArgument('first_node', 'number of the first actuator (default: %(default)s)', 'N', int, 1),
    BusArgument('allow_network', 'with udp_multicast: also where other hosts can send frames',
                kind=bool, default=False))

ETHERCAT, CANOPEN, MIT, SERIAL = 'ethercat', 'canopen', 'mit', 'serial'
BUSES: Mapping[str, Bus] = {
    ETHERCAT: Bus('ethercat.line', 'an EtherCAT master on a network interface', (
        BusArgument(
            'interface', 'network interface of the ring, for example one end of a veth pair',
            'IF'),
        BusArgument('order', 'actuators in the order of the cables, from the master on (default: '
                    'that of the run file)', 'NAME,NAME', default='')),
        'ethernet', (PULLED, POWERLESS)),
    CANOPEN: Bus('canopen.line', 'a CANopen master on a CAN interface', (
        *_CAN,
        BusArgument('unconfigured', 'the nodes have no numbers: a master gives them by LSS',
                    kind=bool, default=False)), 'can', (PULLED, POWERLESS, BUS_OFF)),
    MIT: Bus('canopen.mit_line', 'a master of MIT-mode motors on a CAN interface', _CAN, 'can'),
    SERIAL: Bus('serial.line', 'a master on a serial line', (
        BusArgument('path', 'serial device, or a link to make to a pseudo terminal', 'FILE', Path),
        BusArgument('baud', 'of the line (default: that of docs/link.md)', 'BIT/S', int,
                    OF_THE_WIRE)))}
"""Every bus by its name."""


@frozen(kw_only=True)
class BusRequest:
    """A run whose commands come from the master of a bus."""

    run: Request
    bus: str
    """One of `BUSES`."""
    arguments: Mapping[str, Any] = field(default_factory=dict)
    """Those of the bus, by name."""
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
        """Return where a master finds the devices: the arguments that must be given."""
        return ' '.join(str(self.arguments[one.name]) for one in BUSES[self.bus].arguments
                        if one.default is None and one.name in self.arguments)
