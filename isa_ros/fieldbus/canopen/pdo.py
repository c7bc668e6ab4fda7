"""
The process data objects of a node: when one that arrives takes effect, and when one is sent.

Time is simulated: a SYNC is a tick. Remote requests (types 252 and 253) are not offered.
"""

from isa_ros.fieldbus.canopen.capacity import CyclicFrame
from isa_ros.fieldbus.canopen.communication import Communication, MOST_SYNCS
from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.device.can_identifiers import INVALID, LARGEST
from isa_ros.fieldbus.device.canopen_objects import (
    COB_ID, EVENT_TIMER, INHIBIT_TIME, SYNC_START, TRANSMISSION)

_NS_PER_MS = 1_000_000
_NS_PER_INHIBIT = 100_000


class Pdo:
    """Parameters of a PDO as they are when the node becomes operational."""

    def __init__(self, parameters: int, mapping: int) -> None:
        self.parameters = parameters
        """Index of its communication parameters."""
        self.mapping = mapping
        """Index of its mapping."""
        self.identifier = 0
        self.is_on = False
        self.transmission = 0
        self.size = 0
        self.timer_ns = 0

    def begin(self, communication: Communication, device: BusDevice) -> None:
        """Take the parameters and the mapping; they do not change before the next time."""
        frame = self.cyclic_frame(communication, device)
        self.is_on = frame is not None
        if frame is not None:
            self.identifier, self.size = frame
        self.transmission = communication.value(self.parameters, TRANSMISSION)
        self.timer_ns = communication.value(self.parameters, EVENT_TIMER) * _NS_PER_MS

    def cyclic_frame(
            self, communication: Communication, device: BusDevice) -> CyclicFrame | None:
        """Return it as a frame of a cycle, None while it is off."""
        cob_id = communication.value(self.parameters, COB_ID)
        size = device.size(self.mapping)
        return None if cob_id & INVALID or not size else CyclicFrame(cob_id & LARGEST, size)

    @property
    def is_synchronous(self) -> bool:
        """Return whether it goes with a SYNC."""
        return self.transmission <= MOST_SYNCS


class ReceivePdo(Pdo):
    """A PDO from the master."""

    def __init__(self, parameters: int, mapping: int) -> None:
        super().__init__(parameters, mapping)
        self._waiting: bytes | None = None
        self._silent_ns = 0
        self._is_watched = False

    def begin(self, communication: Communication, device: BusDevice) -> None:
        """Take the parameters; its timer begins with the first one that arrives."""
        super().begin(communication, device)
        self._waiting = None
        self._is_watched = False

    def take(self, data: bytes, device: BusDevice) -> None:
        """Take data of at least its length: for the next SYNC, or at once."""
        self._silent_ns = 0
        self._is_watched = self.timer_ns > 0
        if self.is_synchronous:
            self._waiting = data[:self.size]
        else:
            device.receive(self.mapping, data[:self.size])

    def sync(self, device: BusDevice) -> None:
        """Give what has waited for the SYNC to the device."""
        if self._waiting is not None:
            device.receive(self.mapping, self._waiting)
            self._waiting = None

    def is_overdue(self, step_ns: int) -> bool:
        """Let a tick pass; return whether its timer has run out, once."""
        if not self._is_watched:
            return False
        self._silent_ns += step_ns
        if self._silent_ns <= self.timer_ns:
            return False
        self._is_watched = False
        return True


class TransmitPdo(Pdo):
    """A PDO to the master."""

    def __init__(self, parameters: int, mapping: int) -> None:
        super().__init__(parameters, mapping)
        self._inhibit_ns = 0
        self._start = 0
        self._has_started = False
        self._syncs = 0
        self._since_ns = 0
        self._sent: bytes | None = None

    def begin(self, communication: Communication, device: BusDevice) -> None:
        """Take the parameters; nothing has been sent."""
        super().begin(communication, device)
        self._inhibit_ns = communication.value(self.parameters, INHIBIT_TIME) * _NS_PER_INHIBIT
        self._start = communication.value(self.parameters, SYNC_START)
        self._has_started = False
        self._syncs = self._since_ns = 0
        self._sent = None

    def due(self, device: BusDevice, counter: int | None, step_ns: int) -> bytes | None:
        """Let a tick pass, whose SYNC had ``counter``; return the data if it is to be sent."""
        self._since_ns += step_ns
        if self.is_synchronous and not self._is_nth(counter):
            return None
        data = device.transmit(self.mapping)
        if self._is_held(data):
            return None
        self._sent, self._since_ns = data, 0
        return data

    def _is_nth(self, counter: int | None) -> bool:
        if not self._has_started:
            self._has_started = not self._start or counter is None or counter == self._start
            if not self._has_started:
                return False
            self._syncs = max(1, self.transmission) - 1  # the first SYNC is answered
        self._syncs += 1
        if self._syncs < self.transmission:
            return False
        self._syncs = 0
        return True

    def _is_held(self, data: bytes) -> bool:
        if self._sent is None or 0 < self.transmission <= MOST_SYNCS:
            return False
        if not self.is_synchronous:
            if self.timer_ns and self._since_ns >= self.timer_ns:
                return False
            if self._since_ns < self._inhibit_ns:
                return True
        return data == self._sent
