"""
The actuators of a run as nodes of one CANopen bus: SYNC is the tick.

python-can carries the frames; NMT, SDO, PDO, EMCY and heartbeat are own code. The server classes
of `canopen` (``LocalNode``) were tried, and do not serve here: they receive and send heartbeats in
threads by the wall clock, keep a second copy of the dictionary, know no transmission types, no
SYNC, no writable COB-IDs and no error history, and end with a traceback at a short frame or at a
segment without a transfer. Here one thread handles one frame after the other, so the same frames
in the same order give the same run.

A cycle: RPDOs, then SYNC. What the RPDOs have brought takes effect with the SYNC, `serve` returns,
the tick is simulated, and `update` sends EMCY and TPDOs with its new sample, in the order of their
identifiers, as arbitration on the wire would.
"""

from collections.abc import Mapping, Sequence

from isa_ros.config.models.wires import wire
from isa_ros.errors import ConfigError
from isa_ros.fieldbus.canopen.capacity import CyclicFrame, refuse_overfull
from isa_ros.fieldbus.canopen.lss import (
    ANSWER as LSS_ANSWER, LssNode, REQUEST as LSS_REQUEST, UNCONFIGURED)
from isa_ros.fieldbus.canopen.nmt import NmtCommand, NmtState
from isa_ros.fieldbus.canopen.node import Node
from isa_ros.fieldbus.canopen.pdo_handler import Handler
from isa_ros.fieldbus.canopen.port import CanPort, Frame, monotonic
from isa_ros.fieldbus.canopen.udp_reach import reach_of
from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.device.can_identifiers import (
    FIRST_NODE, HEARTBEAT, LAST_NODE, NMT, SDO_REQUEST, SYNC)

_NMT_SIZE = 2


def canopen_line(
        devices: Sequence[BusDevice], interface: str, channel: str, step_ns: int, *,
        bitrate: int = 0, first_node: int = FIRST_NODE, allow_network: bool = False,
        unconfigured: bool = False,
        options: Mapping[str, object] | None = None) -> 'CanopenLine':
    """
    Open a CAN bus and start a node for each device, ``first_node`` and following.

    ``bitrate`` (bit/s; 0: `default_bitrate`) is that of the wire, or the modelled one of a virtual
    interface; ``options`` are further keywords of the interface of python-can;
    ``allow_network``: as of `reach_of`. ``unconfigured``: the nodes have no numbers until a
    master gives them some by LSS.

    Raises
    ------
    ConfigError
        The frames of a tick do not fit the bit rate, python-can is not installed, there is no
        such interface, or the bus cannot be opened or can be reached from other hosts.

    """
    rate = bitrate or default_bitrate()
    reach_of(interface, channel, allow_network)
    line = planned_line(devices, step_ns, rate, first_node)
    line.begin(CanPort(interface, channel, rate, options), is_configured=not unconfigured)
    return line


def refuse_unusable(
        devices: Sequence[BusDevice], interface: str, channel: str, step_ns: int, *,
        bitrate: int = 0, first_node: int = FIRST_NODE, allow_network: bool = False,
        unconfigured: bool = False) -> str:
    """
    Refuse a bus that cannot be used; parameters and errors as of `canopen_line`.

    Return a line that says who can reach it, '' for none.
    """
    rate = bitrate or default_bitrate()
    planned_line(devices, step_ns, rate, first_node)
    said = reach_of(interface, channel, allow_network)
    CanPort(interface, channel, rate).close()
    return said


def planned_line(
        devices: Sequence[BusDevice], step_ns: int, bitrate: int,
        first_node: int) -> 'CanopenLine':
    """
    Return a line that has not begun on a bus.

    Raises
    ------
    ConfigError
        The frames of a tick do not fit the bit rate, or there are no such nodes.

    """
    refuse_nodes(devices, first_node)
    line = CanopenLine(devices, step_ns, first_node, bitrate)
    line.refuse_overfull(line.nodes)
    return line


def default_bitrate() -> int:
    """Return the bit rate (bit/s) of the wire ``can``."""
    return round(wire('can')[0].bit_rate_mbit * 1e6)


def refuse_nodes(devices: Sequence[BusDevice], first_node: int) -> None:
    """
    Refuse numbers of nodes that do not exist.

    Raises
    ------
    ConfigError
        The first or the last one is not 1 to 127.

    """
    last = first_node + len(devices) - 1
    if first_node < FIRST_NODE or last > LAST_NODE:
        raise ConfigError(
            f'first_node = {first_node}: {len(devices)} actuators are nodes {first_node} to '
            f'{last}, must be {FIRST_NODE} to {LAST_NODE}')


class CanopenLine:
    """The nodes of a run on their bus, a `Line`."""

    def __init__(self, devices: Sequence[BusDevice], step_ns: int, first_node: int,
                 bitrate: int) -> None:
        self.nodes = [Node(device, number, step_ns, self._send, bitrate)
                      for number, device in enumerate(devices, first_node)]
        self.port: CanPort | None = None
        self._step_ns, self._bitrate = step_ns, bitrate
        self._handlers: dict[int, list[Handler]] | None = None
        self._waiting: list[Frame] | None = None

    def refuse_overfull(self, nodes: Sequence[Node]) -> None:
        """Refuse the PDOs of nodes if the bus does not carry them; raises `ConfigError`."""
        refuse_overfull(
            [CyclicFrame(SYNC, 0)],
            {node.device.name: node.cyclic_frames() for node in nodes},
            self._bitrate, self._step_ns)

    def begin(self, port: CanPort, *, is_configured: bool = True) -> None:
        """Begin on a bus: send the boot-up messages, or wait for LSS without numbers."""
        self.port = port
        for node in self.nodes:
            if not is_configured:
                node.lss = LssNode(node.device.identity, UNCONFIGURED, self._bitrate)
            node.begin(node.lss.pending, monotonic())

    def serve(self, timeout: float) -> bool:
        """
        Handle what arrives within ``timeout`` seconds; 0: what is there.

        Return True as soon as a SYNC has begun a cycle of at least one operational node.

        Raises
        ------
        RunError
            The bus is lost.

        """
        assert self.port is not None, 'the line has been opened'
        return self.port.serve(timeout, self._handle, self._beat)

    def update(self) -> None:
        """Send EMCY and process data: the devices have a new sample."""
        self._waiting = []
        states = self._states()
        for node in self.nodes:
            node.update()
        waiting, self._waiting = self._waiting, None
        for frame in sorted(waiting, key=lambda one: one.identifier):
            self._send(frame.identifier, frame.data)
        if self._states() != states:
            self._handlers = None

    def set_port(self, device: str, fault: str, is_on: bool) -> None:
        """Begin or end a fault of a device's connection."""
        node = next(one for one in self.nodes if one.device.name == device)
        node.set_port(fault, is_on, monotonic())
        self._handlers = None

    def miss(self) -> None:
        """Take the bus as lost: the nodes leave operation, by their object 0x1029."""
        for node in self.nodes:
            node.lose()
        self._handlers = None

    def close(self) -> None:
        """Leave the bus."""
        if self.port is not None:
            self.port.close()
            self.port = None

    def _handle(self, frame: Frame) -> bool:
        if frame.is_remote:
            self._guard(frame.identifier - HEARTBEAT)
            return False
        if frame.identifier == NMT:
            self._command(frame.data)
            return False
        if frame.identifier == LSS_REQUEST:
            self._set_layers(frame.data)
            return False
        if self._handlers is None:
            self._handlers = self._all_handlers()
        began = False
        for handler in self._handlers.get(frame.identifier, ()):
            began |= handler(frame.data)
        if SDO_REQUEST <= frame.identifier < HEARTBEAT:     # may have changed what is received
            self._handlers = None
        return began

    def _command(self, data: bytes) -> None:
        if len(data) != _NMT_SIZE:
            return
        command, number = data
        addressed = [node for node in self._present()
                     if node.is_configured and number in (0, node.number)]
        if command != NmtCommand.START or self._can_start(addressed):
            for node in addressed:
                node.command(command, monotonic())
        self._handlers = None

    def _guard(self, number: int) -> None:
        """Let the node of a remote frame answer; others are ignored, and counted."""
        asked = [
            node for node in self._present() if node.is_configured and node.number == number]
        for node in asked:
            node.guard()
        if self.port is not None and not asked:
            self.port.ignored += 1

    def _set_layers(self, data: bytes) -> None:
        """Pass a frame of LSS to all nodes; equal answers are one frame on a wire, and here."""
        answers = [node.set_layer(data, monotonic()) for node in self._present()]
        for answer in dict.fromkeys(answers):
            if answer is not None:
                self._send(LSS_ANSWER, answer)
        self._handlers = None

    def _can_start(self, addressed: Sequence[Node]) -> bool:
        """Return whether the bus carries the PDOs with those that the master has switched on."""
        try:
            self.refuse_overfull([node for node in self.nodes if node in addressed
                                  or node.state == NmtState.OPERATIONAL])
        except ConfigError as refused:
            for node in addressed:
                node.refuse_start(str(refused))
            return False
        return True

    def _present(self) -> list[Node]:
        """Return the nodes that receive frames."""
        return [node for node in self.nodes if not node.is_away]

    def _states(self) -> list[int]:
        return [node.state for node in self.nodes]

    def _all_handlers(self) -> dict[int, list[Handler]]:
        handlers: dict[int, list[Handler]] = {}
        for node in self.nodes:
            for identifier, handler in node.handlers():
                handlers.setdefault(identifier, []).append(handler)
        return handlers

    def _beat(self, now: float) -> float:
        """Send the heartbeats that are due; return the wall time (s) of the next."""
        soonest = float('inf')
        for node in self.nodes:
            wait = node.beat(now)
            if wait is not None:
                soonest = min(soonest, now + wait)
        return soonest

    def _send(self, identifier: int, data: bytes) -> None:
        if self._waiting is not None:
            self._waiting.append(Frame(identifier, data))
        elif self.port is not None:
            self.port.send(identifier, data)
