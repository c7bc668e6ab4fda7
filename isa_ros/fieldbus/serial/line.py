"""
The actuators of a run on one serial line: a request with all setpoints, an answer with all states.

The content of a request of process data are the PDOs that each device has assigned (0x1C12), one
actuator after the other; its answer has those of 0x1C13, behind status and counter. Each request
is a tick, and is answered with the state after it. The first one begins the operation. Objects are
read and written by requests of their own, which are no ticks. `isa_ros.fieldbus.serial.frame` has
the frame.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
import time
from typing import NamedTuple

from isa_ros.config.models.wires import wire
from isa_ros.errors import ConfigError
from isa_ros.fieldbus.device.abort import SdoAbort, UNKNOWN_COMMAND, WRONG_LENGTH
from isa_ros.fieldbus.device.bus_device import BusDevice, RECEIVE_ASSIGNMENT, TRANSMIT_ASSIGNMENT
from isa_ros.fieldbus.serial.frame import (
    ANSWERED, FrameReader, OBJECT, OVERHEAD, packed, PROCESS_DATA, READ, SerialFrame, STATUS,
    WRITE)
from isa_ros.fieldbus.serial.port import SerialPort

_BITS_PER_BYTE = 10     # 8N1: start, 8 data, stop
_TURNS = 2              # of the direction in a cycle, a byte's time each
_NS_PER_S = 1_000_000_000
_DISCARDED_MASK = 0xFFFF


class PdoPart(NamedTuple):
    """One PDO of one actuator in the content of a frame."""

    device: BusDevice
    pdo: int
    offset: int
    size: int


def serial_line(
        devices: Sequence[BusDevice], path: Path | str, baud: int, step_ns: int) -> 'SerialLine':
    """
    Open a serial line for the devices; ``baud`` 0: the rate of the wire ``serial``.

    Raises
    ------
    ConfigError
        The frames of a tick do not fit the rate, or the line cannot be opened.

    """
    rate = baud or default_baud()
    refuse_overfull(devices, rate, step_ns)
    return SerialLine(devices, SerialPort(Path(path), rate))


def refuse_unusable(
        devices: Sequence[BusDevice], path: Path | str, baud: int, step_ns: int) -> None:
    """Refuse a line that cannot be used; parameters and errors as of `serial_line`."""
    rate = baud or default_baud()
    refuse_overfull(devices, rate, step_ns)
    SerialPort(Path(path), rate).close()


def default_baud() -> int:
    """Return the rate (bit/s) of the wire ``serial``."""
    return round(wire('serial')[0].bit_rate_mbit * 1e6)


def refuse_overfull(devices: Sequence[BusDevice], baud: int, step_ns: int) -> None:
    """
    Refuse devices whose request and answer a line does not carry in a tick.

    Raises
    ------
    ConfigError
        They do not fit; the message has the arithmetic and the least rate.

    """
    request = OVERHEAD + sum(part.size for part in parts(devices, RECEIVE_ASSIGNMENT))
    answer = OVERHEAD + STATUS.size + sum(
        part.size for part in parts(devices, TRANSMIT_ASSIGNMENT))
    needed = _BITS_PER_BYTE * (request + answer + _TURNS)
    available = baud * step_ns // _NS_PER_S
    if needed > available:
        names = ', '.join(device.name for device in devices)
        raise ConfigError(
            f'baud = {baud}, must be >= {-(-needed * _NS_PER_S // step_ns)}: {len(devices)} '
            f'actuators ({names}) need {_BITS_PER_BYTE} x (request {request} + answer {answer} + '
            f'turns {_TURNS}) = {needed} bit a tick, {baud} baud carries {available} bit in '
            f'{step_ns / 1e6:g} ms')


def parts(devices: Sequence[BusDevice], assignment: int) -> Iterator[PdoPart]:
    """Iterate over the content of requests (0x1C12) or, behind the status, of answers (0x1C13)."""
    offset = 0
    for device in devices:
        for pdo in device.assigned(assignment):
            size = device.size(pdo)
            yield PdoPart(device, pdo, offset, size)
            offset += size


class SerialLine:
    """The devices of a run on their line, a `Line`."""

    def __init__(self, devices: Sequence[BusDevice], port: SerialPort) -> None:
        self.port = port
        self._devices = list(devices)
        self._reader = FrameReader()
        self._is_operational = False
        self._request: SerialFrame | None = None
        self._received: list[PdoPart] = []
        self._transmitted: list[PdoPart] = []

    @property
    def discarded(self) -> int:
        """Return how many requests had a wrong CRC."""
        return self._reader.discarded

    def serve(self, timeout: float) -> bool:
        """
        Handle what arrives within ``timeout`` seconds; 0: what is there.

        Return True as soon as process data have begun a tick.

        Raises
        ------
        RunError
            The line is lost.

        """
        deadline = time.monotonic() + timeout
        while True:
            while (frame := self._reader.take()) is not None:
                if self._handle(frame):
                    return True
            left = deadline - time.monotonic()
            data = self.port.receive(left)
            if not data:
                return False
            self._reader.feed(data)

    def update(self) -> None:
        """Answer the process data of the tick with the new samples."""
        if self._request is not None:
            request, self._request = self._request, None
            self._answer(request, 0, b''.join(
                part.device.transmit(part.pdo) for part in self._transmitted))

    def miss(self) -> None:
        """Take the line as lost: the next process data begin the operation again."""
        if self._is_operational:
            self._is_operational = False
            for device in self._devices:
                device.end_operation(is_lost=True)

    def close(self) -> None:
        """Close the line."""
        self.port.close()

    def _handle(self, frame: SerialFrame) -> bool:
        try:
            if frame.kind == PROCESS_DATA:
                self._receive(frame.content)
                self._request = frame
                return True
            self._answer(frame, 0, self._access(frame))
        except SdoAbort as refused:
            self._answer(frame, refused.code, b'')
        return False

    def _receive(self, content: bytes) -> None:
        if not self._is_operational:
            self._begin()
        if len(content) != sum(part.size for part in self._received):
            raise SdoAbort(WRONG_LENGTH)
        for part in self._received:
            part.device.receive(part.pdo, content[part.offset:part.offset + part.size])

    def _begin(self) -> None:
        """Take the mappings, which do not change while operational, and begin."""
        self._received = list(parts(self._devices, RECEIVE_ASSIGNMENT))
        self._transmitted = list(parts(self._devices, TRANSMIT_ASSIGNMENT))
        self._is_operational = True
        for device in self._devices:
            device.begin_operation()

    def _access(self, frame: SerialFrame) -> bytes:
        """Read or write an object; raises `SdoAbort`."""
        if frame.kind not in (READ, WRITE):
            raise SdoAbort(UNKNOWN_COMMAND)
        if len(frame.content) < OBJECT.size:
            raise SdoAbort(WRONG_LENGTH)
        place, index, subindex = OBJECT.unpack_from(frame.content)
        if place >= len(self._devices):
            raise SdoAbort(UNKNOWN_COMMAND)
        device: BusDevice = self._devices[place]
        data = frame.content[OBJECT.size:]
        if frame.kind == READ:
            return device.read(index, subindex)
        device.write(index, subindex, data, is_preoperational=not self._is_operational)
        return b''

    def _answer(self, request: SerialFrame, code: int, data: bytes) -> None:
        status = STATUS.pack(code, self.discarded & _DISCARDED_MASK)
        self.port.send(packed(SerialFrame(request.kind | ANSWERED, request.number, status + data)))
