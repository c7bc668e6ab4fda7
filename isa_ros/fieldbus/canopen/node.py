"""
A node of CANopen: NMT state, objects and process data of one actuator.

States (CiA 301, 7.3.2): initialising -> (boot-up message) preoperational <-> operational,
stopped. SDO is answered while preoperational and operational, process data are exchanged while
operational, EMCY is sent in both.
"""

from collections.abc import Callable, Iterator

from isa_ros.config.models.bus_port import BUS_OFF, POWERLESS
from isa_ros.fieldbus.canopen.capacity import CyclicFrame
from isa_ros.fieldbus.canopen.communication import Communication
from isa_ros.fieldbus.canopen.dictionary import mappings, NodeDictionary
from isa_ros.fieldbus.canopen.errors import (
    BUS_OVERFULL, HEARTBEAT_LOST, NodeErrors, PDO_OVERDUE, RECOVERED, SYNC_LENGTH)
from isa_ros.fieldbus.canopen.guarding import Guarding
from isa_ros.fieldbus.canopen.heartbeat import HeartbeatConsumer, HeartbeatProducer
from isa_ros.fieldbus.canopen.lss import LssNode, UNCONFIGURED
from isa_ros.fieldbus.canopen.nmt import NmtCommand, NmtState
from isa_ros.fieldbus.canopen.pdo import Pdo, ReceivePdo, TransmitPdo
from isa_ros.fieldbus.canopen.pdo_handler import Handler, pdo_handler
from isa_ros.fieldbus.canopen.sdo import SdoServer
from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.device.can_identifiers import HEARTBEAT, LARGEST, SDO_ANSWER, SDO_REQUEST
from isa_ros.fieldbus.device.canopen_objects import (
    ERROR_BEHAVIOUR, GUARD_TIME, HEARTBEAT_CONSUMED, HEARTBEAT_PRODUCED, LIFE_TIME_FACTOR,
    RECEIVE_MAPPINGS, RECEIVE_PARAMETERS, SYNC_ID, SYNC_OVERFLOW, TRANSMIT_MAPPINGS,
    TRANSMIT_PARAMETERS)
from isa_ros.fieldbus.device.communication_area import ERROR_FIELD
from isa_ros.fieldbus.device.manufacturer_area import LAST_REFUSAL

Send = Callable[[int, bytes], None]

_ENTERED = {
    NmtCommand.START: NmtState.OPERATIONAL, NmtCommand.STOP: NmtState.STOPPED,
    NmtCommand.ENTER_PREOPERATIONAL: NmtState.PREOPERATIONAL}
_AFTER_ERROR = (NmtState.PREOPERATIONAL, None, NmtState.STOPPED)


class Node:
    """One actuator on the bus."""

    def __init__(
            self, device: BusDevice, node: int, step_ns: int, send: Send, bitrate: int) -> None:
        self.device, self.number = device, node
        self.lss = LssNode(device.identity, node, bitrate)
        self.state = NmtState.INITIALISING
        receive = mappings(device, RECEIVE_MAPPINGS)
        transmit = mappings(device, TRANSMIT_MAPPINGS)
        self.communication = Communication(device.table, node)
        self._bus, self._faults = send, set[str]()
        self.errors = NodeErrors(self.communication, self._send)
        self.receive = [ReceivePdo(one - RECEIVE_MAPPINGS + RECEIVE_PARAMETERS, one)
                        for one in receive]
        self.transmit = [TransmitPdo(one - TRANSMIT_MAPPINGS + TRANSMIT_PARAMETERS, one)
                         for one in transmit]
        self.is_synced = False
        """Whether a SYNC has begun a cycle that `update` has not ended yet."""
        self._step_ns = step_ns
        self._sdo = SdoServer(NodeDictionary(
            device, self.communication, self.errors,
            is_preoperational=lambda: self.state == NmtState.PREOPERATIONAL,
            follow=self._follow))
        self._produced, self._consumed = HeartbeatProducer(), HeartbeatConsumer()
        self._guarding = Guarding()
        self._counter: int | None = None
        self._has_wrong_sync = False

    # Connection

    @property
    def is_away(self) -> bool:
        """Return whether it neither sends nor receives frames."""
        return bool(self._faults)

    def set_port(self, fault: str, is_on: bool, now: float) -> None:
        """Begin or end a fault of the connection, a value of `BusPort`; ``now`` in s."""
        (self._faults.add if is_on else self._faults.discard)(fault)
        if fault == POWERLESS and is_on:
            self._reset(is_whole=True)
        elif fault == POWERLESS:
            self.begin(self.lss.pending, now)
        elif fault == BUS_OFF and is_on:
            self.lose()
        elif fault == BUS_OFF:
            self.errors.begin(RECOVERED, self.number, is_sent=self.is_talking)
            self.errors.end(RECOVERED, self.number, is_sent=self.is_talking)

    def _send(self, identifier: int, data: bytes) -> None:
        if not self._faults:
            self._bus(identifier, data)

    # NMT

    def boot(self, now: float) -> None:
        """Send the boot-up message, then be preoperational."""
        self._send(HEARTBEAT + self.number, bytes([NmtState.INITIALISING]))
        self.state = NmtState.PREOPERATIONAL
        self._produced.set_period(self.communication.value(HEARTBEAT_PRODUCED), now)

    def command(self, command: int, now: float) -> None:
        """Obey the NMT master; unknown commands are ignored."""
        if command in _ENTERED:
            self._enter(_ENTERED[NmtCommand(command)])
        elif command in (NmtCommand.RESET_NODE, NmtCommand.RESET_COMMUNICATION):
            self._reset(is_whole=command == NmtCommand.RESET_NODE)
            self.begin(self.lss.pending, now)
        self.report_emergencies()

    def _reset(self, *, is_whole: bool) -> None:
        self._enter(NmtState.INITIALISING)
        self.errors.reset()
        self._sdo.reset()
        self._consumed.set_watched([])
        self.device.restart(is_whole=is_whole)
        if is_whole:
            self.lss.restore()

    @property
    def is_configured(self) -> bool:
        """Return whether it has a number; without one it serves LSS only."""
        return self.number != UNCONFIGURED

    def begin(self, number: int, now: float) -> None:
        """Begin with a number and the communication of power-on; without one wait for LSS."""
        self.number = self.communication.node = number
        self.communication.reset()
        self._guarding.reset()
        self._follow(GUARD_TIME)
        self._produced.set_period(0, now)
        if self.is_configured:
            self.boot(now)

    def set_layer(self, data: bytes, now: float) -> bytes | None:
        """Return the answer to a frame of the LSS master, which is ignored while operational."""
        if self.state == NmtState.OPERATIONAL:
            return None
        answer = self.lss.answer(data, self.number)
        if not self.is_configured and self.lss.is_waiting and self.lss.pending != UNCONFIGURED:
            self.begin(self.lss.pending, now)
        return answer

    def guard(self) -> None:
        """Answer a request of node guarding; heartbeats take its place."""
        if not self.communication.value(HEARTBEAT_PRODUCED):
            self._send(HEARTBEAT + self.number, self._guarding.answer(self.state))
            self.errors.end(HEARTBEAT_LOST, self.number, is_sent=self.is_talking)

    def refuse_start(self, reason: str) -> None:
        """Stay preoperational, with an emergency and the reason as a text."""
        if LAST_REFUSAL in self.device.table:
            self.device.store(*LAST_REFUSAL, reason)
        self.errors.begin(BUS_OVERFULL, self.number, is_sent=self.is_talking)

    def lose(self, state: NmtState | None = None) -> None:
        """Leave operation because the bus is lost, by default as the object 0x1029 says."""
        if state is None:
            state = _AFTER_ERROR[self.communication.value(ERROR_BEHAVIOUR, 1)]
        if self.state == NmtState.OPERATIONAL:
            if state is None:   # no change: the drive alone takes it as lost
                self.device.end_operation(is_lost=True)
                self.device.begin_operation()
            else:
                self._enter(state, is_lost=True)
        self.report_emergencies()

    def _enter(self, state: NmtState, *, is_lost: bool = False) -> None:
        before, self.state = self.state, state
        if state == before:
            return
        if state == NmtState.OPERATIONAL:
            self.errors.end(BUS_OVERFULL, self.number, is_sent=True)
            for pdo in self.pdos():
                pdo.begin(self.communication, self.device)
            self.device.begin_operation()
        elif before == NmtState.OPERATIONAL:
            self.is_synced = False
            self.device.end_operation(is_lost)

    # Frames

    def pdos(self) -> Iterator[Pdo]:
        """Iterate over the PDOs of both directions."""
        yield from self.receive
        yield from self.transmit

    def cyclic_frames(self) -> list[CyclicFrame]:
        """Return the PDOs that are on, as frames of a cycle."""
        frames = (pdo.cyclic_frame(self.communication, self.device) for pdo in self.pdos())
        return [frame for frame in frames if frame is not None]

    def handlers(self) -> Iterator[tuple[int, Handler]]:
        """Iterate over the identifiers that the node receives, with their handlers."""
        if self.is_away:    # time goes on, for the fault has an end
            yield self.communication.value(SYNC_ID) & LARGEST, lambda data: True
            return
        if not self.is_configured:
            return
        yield SDO_REQUEST + self.number, self._on_sdo
        yield self.communication.value(SYNC_ID) & LARGEST, self._on_sync
        for node in self._consumed.nodes():
            yield HEARTBEAT + node, self._on_heartbeat(node)
        if self.state == NmtState.OPERATIONAL:
            for pdo in self.receive:
                if pdo.is_on:
                    yield pdo.identifier, pdo_handler(pdo, self.device, self.errors)

    def _on_sdo(self, data: bytes) -> bool:
        if self.is_talking:
            answers = self._sdo.answers(data)
            self.report_emergencies()
            for answer in answers:
                self._send(SDO_ANSWER + self.number, answer)
        return False

    def _on_heartbeat(self, node: int) -> Handler:
        def take(data: bytes) -> bool:
            self._consumed.take(node)
            self.errors.end(HEARTBEAT_LOST, node, is_sent=self.is_talking)
            return False
        return take

    def _on_sync(self, data: bytes) -> bool:
        if self.state != NmtState.OPERATIONAL:
            return False
        has_counter = self.communication.value(SYNC_OVERFLOW) > 0
        if len(data) != has_counter:
            if not self._has_wrong_sync:
                self.errors.begin(SYNC_LENGTH, 0, is_sent=True)
            self._has_wrong_sync = True
            return False
        if self._has_wrong_sync:
            self._has_wrong_sync = False
            self.errors.end(SYNC_LENGTH, 0, is_sent=True)
        self._counter = data[0] if has_counter else None
        self.is_synced = True
        for pdo in self.receive:
            if pdo.is_on:
                pdo.sync(self.device)
        return True

    # Time

    def update(self) -> None:
        """End a cycle: the device has its new sample. Report errors, send process data."""
        self.report_emergencies()
        if self.is_away and self.state == NmtState.OPERATIONAL:
            self._watch()
        if not self.is_synced:
            return
        self.is_synced = False
        for pdo in self.transmit:
            if pdo.is_on:
                data = pdo.due(self.device, self._counter, self._step_ns)
                if data is not None:
                    self._send(pdo.identifier, data)
        self._watch()

    def _watch(self) -> None:
        overdue = [pdo for pdo in self.receive if pdo.is_on and pdo.is_overdue(self._step_ns)]
        for pdo in overdue:
            self.errors.begin(PDO_OVERDUE, pdo.mapping - RECEIVE_MAPPINGS + 1, is_sent=True)
        lost = (self._consumed.lost(self._step_ns)
                + [self.number] * self._guarding.is_lost(self._step_ns))
        for node in lost:
            self.errors.begin(HEARTBEAT_LOST, node, is_sent=True)
        if overdue or lost:
            self.lose()

    def beat(self, now: float) -> float | None:
        """Send a heartbeat if it is due at ``now``; return the wall time until the next one, s."""
        if self._produced.is_due(now):
            self._send(HEARTBEAT + self.number, bytes([self.state]))
        return self._produced.wait(now)

    @property
    def is_talking(self) -> bool:
        """Return whether the state allows SDO and EMCY."""
        return self.state in (NmtState.PREOPERATIONAL, NmtState.OPERATIONAL)

    def report_emergencies(self) -> None:
        """Send what the device reports."""
        for emergency in self.device.emergencies():
            self.errors.take(emergency, is_sent=self.is_talking)

    def _follow(self, index: int) -> None:
        """Let a communication object that has been written take effect."""
        if index == HEARTBEAT_PRODUCED:
            self._produced.set_period(self.communication.value(index), 0.0)
        elif index in (GUARD_TIME, LIFE_TIME_FACTOR):
            self._guarding.set_life_time(
                self.communication.value(GUARD_TIME), self.communication.value(LIFE_TIME_FACTOR))
        elif index == HEARTBEAT_CONSUMED:
            self._consumed.set_watched(self.communication.values(index))
        elif index == ERROR_FIELD:
            self.errors.clear_history()
        watched = self._consumed.nodes() + [self.number] * self._guarding.is_on
        self.errors.end_others(HEARTBEAT_LOST, watched, is_sent=self.is_talking)
