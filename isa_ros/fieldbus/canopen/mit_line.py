"""
The actuators of a run as MIT-mode motors on one CAN bus, numbers as those of CANopen nodes.

A command frame has the identifier of its motor; each frame to a motor is answered at once, with
the state at the end of the last tick, by the identifier ``answer_id`` (0, as the published
firmware does; there is no NMT here). A tick begins when all motors have a new command. Where a
motor gets a second one before, it begins without the others, and the second belongs to the next
tick. SDO is served too, with the ranges of the frames in object 0x2002.
"""

from collections.abc import Mapping, Sequence

from isa_ros.errors import ConfigError
from isa_ros.fieldbus.canopen.capacity import CyclicFrame, refuse_overfull
from isa_ros.fieldbus.canopen.line import default_bitrate, refuse_nodes
from isa_ros.fieldbus.canopen.mit_frames import ANSWER_BYTES, COMMAND_BYTES, special_of
from isa_ros.fieldbus.canopen.mit_motor import has_impedance, MitMotor
from isa_ros.fieldbus.canopen.port import CanPort, Frame
from isa_ros.fieldbus.canopen.sdo import SdoServer
from isa_ros.fieldbus.canopen.udp_reach import reach_of
from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.device.can_identifiers import FIRST_NODE, LARGEST, SDO_ANSWER, SDO_REQUEST


def mit_line(
        devices: Sequence[BusDevice], interface: str, channel: str, step_ns: int, *,
        bitrate: int = 0, first_node: int = FIRST_NODE, answer_id: int = 0,
        allow_network: bool = False,
        options: Mapping[str, object] | None = None) -> 'MitLine':
    """
    Open a CAN bus with a motor for each device; parameters as of `canopen_line`.

    Raises
    ------
    ConfigError
        As `canopen_line`.

    """
    rate = bitrate or default_bitrate()
    reach_of(interface, channel, allow_network)
    refuse_motors(devices, step_ns, rate, first_node, answer_id)
    return MitLine(devices, CanPort(interface, channel, rate, options), first_node, answer_id)


def refuse_unusable(
        devices: Sequence[BusDevice], interface: str, channel: str, step_ns: int, *,
        bitrate: int = 0, first_node: int = FIRST_NODE, allow_network: bool = False) -> str:
    """Refuse a bus that cannot be used; all as of `isa_ros.fieldbus.canopen.line`."""
    rate = bitrate or default_bitrate()
    refuse_motors(devices, step_ns, rate, first_node)
    said = reach_of(interface, channel, allow_network)
    CanPort(interface, channel, rate).close()
    return said


def refuse_motors(
        devices: Sequence[BusDevice], step_ns: int, bitrate: int, first_node: int,
        answer_id: int = 0) -> None:
    """
    Refuse what cannot be motors on a bus.

    Raises
    ------
    ConfigError
        The frames of a tick do not fit the bit rate, there are no such numbers, an actuator has
        no impedance mode, or answers would be commands.

    """
    refuse_nodes(devices, first_node)
    _refuse_kinds(devices, first_node, answer_id)
    refuse_overfull([], {
        device.name: [CyclicFrame(number, COMMAND_BYTES), CyclicFrame(answer_id, ANSWER_BYTES)]
        for number, device in enumerate(devices, first_node)}, bitrate, step_ns)


def _refuse_kinds(devices: Sequence[BusDevice], first_node: int, answer_id: int) -> None:
    """Refuse actuators without an impedance mode, and answers that would be commands."""
    for device in devices:
        if not has_impedance(device):
            raise ConfigError(
                f'{device.name}: has no impedance mode, which MIT-mode frames command; an '
                'actuator of profile cia402 with a position block of kind impedance has it')
    last = first_node + len(devices) - 1
    if first_node <= answer_id <= last or not 0 <= answer_id <= LARGEST:
        raise ConfigError(
            f'answer_id = {answer_id}: must be 0 to {LARGEST} and no motor, which are '
            f'{first_node} to {last}')


class MitLine:
    """The motors of a run on their bus, a `Line`."""

    def __init__(self, devices: Sequence[BusDevice], port: CanPort, first_node: int,
                 answer_id: int) -> None:
        self.motors = {number: MitMotor(device, number)
                       for number, device in enumerate(devices, first_node)}
        self.port = port
        self._answer_id = answer_id
        self._sdo = {SDO_REQUEST + number: SdoServer(_Objects(motor))
                     for number, motor in self.motors.items()}
        self._held: Frame | None = None

    def serve(self, timeout: float) -> bool:
        """
        Handle what arrives within ``timeout`` seconds; 0: what is there.

        Return True as soon as a tick begins.

        Raises
        ------
        RunError
            The bus is lost.

        """
        held, self._held = self._held, None
        if held is not None and self._handle(held):
            return True
        return self.port.serve(timeout, self._handle)

    def update(self) -> None:
        """Do nothing: the next frames are answered with the new samples."""

    def miss(self) -> None:
        """Take the bus as lost: all motors are off until they are enabled again."""
        for motor in self.motors.values():
            motor.lose()

    def close(self) -> None:
        """Leave the bus."""
        self.port.close()

    def _handle(self, frame: Frame) -> bool:
        motor = self.motors.get(frame.identifier)
        if motor is not None and len(frame.data) == COMMAND_BYTES:
            return self._take(motor, frame)
        server = self._sdo.get(frame.identifier)
        for answer in () if server is None else server.answers(frame.data):
            self.port.send(frame.identifier - SDO_REQUEST + SDO_ANSWER, answer)
        return False

    def _take(self, motor: MitMotor, frame: Frame) -> bool:
        kind = special_of(frame.data)
        if kind is None and motor.is_new:
            self._held = frame
            return self._begin_tick()
        if kind is None:
            motor.take(frame.data)
        else:
            motor.special(kind)
        self.port.send(self._answer_id, motor.answer())
        return all(one.is_new for one in self.motors.values()) and self._begin_tick()

    def _begin_tick(self) -> bool:
        for motor in self.motors.values():
            motor.begin_tick()
        return True


class _Objects:
    """The objects of a motor for SDO."""

    def __init__(self, motor: MitMotor) -> None:
        self._motor, self._device = motor, motor.device

    def read(self, index: int, subindex: int) -> bytes:
        return self._device.read(index, subindex)

    def write(self, index: int, subindex: int, data: bytes) -> None:
        self._device.write(index, subindex, data, is_preoperational=not self._motor.is_on)
        self._motor.take_ranges()

    def size(self, index: int, subindex: int) -> int:
        return self._device.table.entry(index, subindex).data_type.bits + 7 >> 3
