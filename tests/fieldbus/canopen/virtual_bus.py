"""A line and a master on python-can's virtual bus, in one process and one thread."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
import uuid

import can
from isa_ros.fieldbus.canopen.line import canopen_line, CanopenLine
from isa_ros.fieldbus.device.bus_device import BusDevice

STEP_NS = 1_000_000
PREOPERATIONAL, OPERATIONAL, STOPPED = 0x7F, 0x05, 0x04
START, STOP, TO_PREOPERATIONAL, RESET_NODE, RESET_COMMUNICATION = 1, 2, 0x80, 0x81, 0x82


class Master:
    """Frames to the line, and what it answers."""

    def __init__(self, line: CanopenLine, bus: can.BusABC) -> None:
        self.line, self._bus = line, bus

    def send(self, identifier: int, data: bytes = b'') -> bool:
        """Send a frame; return whether the line has begun a cycle."""
        self._bus.send(can.Message(
            arbitration_id=identifier, data=data, is_extended_id=False))
        return self.line.serve(0.0)

    def send_message(self, message: can.Message) -> bool:
        """Send any message; return whether the line has begun a cycle."""
        self._bus.send(message)
        return self.line.serve(0.0)

    def received(self) -> list[tuple[int, bytes]]:
        """Return the frames of the line since the last call."""
        frames = []
        while (message := self._bus.recv(0.0)) is not None:
            frames.append((message.arbitration_id, bytes(message.data)))
        return frames

    def command(self, command: int, node: int = 0) -> None:
        """Send an NMT command."""
        self.send(0, bytes([command, node]))

    def sdo(self, request: bytes, node: int = 1) -> bytes:
        """Return the answer to an SDO request."""
        self.received()
        self.send(0x600 + node, request)
        answers = [data for identifier, data in self.received() if identifier == 0x580 + node]
        assert len(answers) == 1, f'{len(answers)} answers to {request.hex()}'
        return answers[0]

    def read(self, index: int, subindex: int = 0, node: int = 1) -> bytes:
        """Return an object of up to 4 bytes, or raise the abort code as `Refused`."""
        answer = self.sdo(b'\x40' + _multiplexor(index, subindex) + bytes(4), node)
        _raise_abort(answer)
        return answer[4:8 - (answer[0] >> 2 & 3)]

    def write(self, index: int, subindex: int, value: int, size: int, node: int = 1) -> None:
        """Write a whole number of up to 4 bytes, or raise the abort code as `Refused`."""
        command = 0x23 | 4 - size << 2
        answer = self.sdo(bytes([command]) + _multiplexor(index, subindex)
                          + value.to_bytes(size, 'little', signed=value < 0).ljust(4, b'\0'), node)
        _raise_abort(answer)

    def cycle(self, *rpdos: tuple[int, bytes], sync: bytes = b'') -> list[tuple[int, bytes]]:
        """Send RPDOs and SYNC, simulate the tick, and return the frames of the line."""
        self.received()
        for identifier, data in rpdos:
            assert not self.send(identifier, data)
        if self.send(0x80, sync):
            for node in self.line.nodes:
                node.device.tick()      # type: ignore[attr-defined]
            self.line.update()
        return self.received()


class Refused(Exception):
    """An abort code."""

    @property
    def code(self) -> int:
        """Return it."""
        return int(self.args[0])


def _multiplexor(index: int, subindex: int) -> bytes:
    return index.to_bytes(2, 'little') + bytes([subindex])


def _raise_abort(answer: bytes) -> None:
    if answer[0] == 0x80:
        raise Refused(int.from_bytes(answer[4:], 'little'))


@contextmanager
def virtual_master(
        devices: Sequence[BusDevice], step_ns: int = STEP_NS, **keywords: int) -> Iterator[Master]:
    """Yield a master of a line with toys, after its boot-up messages."""
    channel = uuid.uuid4().hex
    bus = can.Bus(interface='virtual', channel=channel)
    line = canopen_line(devices, 'virtual', channel, step_ns, **keywords)
    try:
        yield Master(line, bus)
    finally:
        line.close()
        bus.shutdown()
