"""
A master that writes every byte of its frames itself, for slaves in the same process.

Layout: ETG.1000.4. Ethernet header of 14 bytes, EtherCAT header of 2 (length, type 1 in the top
four bits), then datagrams: command, index, address of 4 bytes, length (bit 15: another follows),
IRQ, data, working counter.
"""

from collections import deque
from collections.abc import Sequence
import struct
from typing import NamedTuple

from isa_ros.fieldbus.ethercat.line import EthercatLine
from isa_ros.fieldbus.ethercat.ring import Ring
import numpy as np
from tests.fieldbus.toys import Toy

STEP_NS = 1_000_000
APRD, APWR, APRW, FPRD, FPWR, FPRW, BRD, BWR, BRW, LRD, LWR, LRW, ARMW, FRMW = range(1, 15)
INIT, PREOP, SAFEOP, OP = 1, 2, 4, 8
NOTHING = np.zeros(1, np.dtype([('nothing', '<f8')]))[0]


class Sent(NamedTuple):
    """A datagram as its sender writes it."""

    command: int
    address: int
    """Slave in the low 16 bits and offset in the high ones, or a logical address."""
    data: bytes
    counter: int = 0


class Answer(NamedTuple):
    """A datagram as it comes back."""

    data: bytes
    counter: int
    slave: int
    irq: int


def at(slave: int, offset: int) -> int:
    """Return the address of a memory offset at a slave."""
    return (slave & 0xFFFF) | offset << 16


def frame_of(sent: Sequence[Sent]) -> bytes:
    """Return an Ethernet frame with datagrams."""
    body = b''
    for k, one in enumerate(sent):
        more = 0x8000 if k < len(sent) - 1 else 0
        body += struct.pack('<BBIHH', one.command, k, one.address, len(one.data) | more, 0)
        body += one.data + struct.pack('<H', one.counter)
    return (b'\xff' * 6 + bytes.fromhex('010101010101') + b'\x88\xa4'
            + struct.pack('<H', len(body) | 0x1000) + body).ljust(60, b'\0')


def answers_in(frame: bytes) -> list[Answer]:
    """Return the datagrams of a frame that came back."""
    found, place, more = [], 16, True
    while more:
        _, _, slave, _, length, irq = struct.unpack_from('<BBHHHH', frame, place)
        more, size = bool(length & 0x8000), length & 0x7FF
        data = frame[place + 10:place + 10 + size]
        counter = struct.unpack_from('<H', frame, place + 10 + size)[0]
        found.append(Answer(data, counter, slave, irq))
        place += 12 + size
    return found


class Wire:
    """Stands for a raw socket: frames to receive, frames that were sent."""

    def __init__(self) -> None:
        self.incoming: deque[bytes] = deque()
        self.outgoing: list[bytes] = []

    def recv_into(self, buffer: bytearray, size: int, flags: int) -> int:
        """Return the next frame."""
        if not self.incoming:
            raise BlockingIOError
        frame = self.incoming.popleft()
        buffer[:len(frame)] = frame
        return len(frame)

    def send(self, frame: memoryview) -> int:
        """Keep a frame."""
        self.outgoing.append(bytes(frame))
        return len(frame)

    def setsockopt(self, *_: object) -> None:
        """Ignore options."""

    def close(self) -> None:
        """Do nothing."""


class RawMaster:
    """Toys in a ring, and a master that is stepped."""

    def __init__(self, *toys: Toy, step_ns: int = STEP_NS) -> None:
        self.toys = toys or (Toy(),)
        self.wire = Wire()
        self.ring = Ring(self.toys, step_ns)
        self.line = EthercatLine(self.ring, self.wire, 'wire')  # type: ignore[arg-type]
        self.ticks = 0
        self._counter = 0

    def send(self, *sent: Sent) -> list[Answer]:
        """Send one frame and return its datagrams; ticks that begin meanwhile pass."""
        before = len(self.wire.outgoing)
        self.wire.incoming.append(frame_of(sent))
        while len(self.wire.outgoing) == before:
            if self.line.serve(0.0):
                self.tick()
        return answers_in(self.wire.outgoing[-1])

    def tick(self) -> None:
        """Let a tick pass."""
        self.ticks += 1
        for toy in self.toys:
            toy.take_sample(NOTHING, self.ticks)
        self.line.update()

    def read(self, offset: int, size: int, slave: int = 0) -> bytes:
        """Return memory of the slave at a position; it must answer."""
        answer = self.send(Sent(APRD, at(-slave, offset), bytes(size)))[0]
        assert answer.counter == 1, hex(offset)
        return answer.data

    def number(self, offset: int, size: int = 2, slave: int = 0) -> int:
        """Return a number in the memory of a slave."""
        return int.from_bytes(self.read(offset, size, slave), 'little')

    def write(self, offset: int, data: bytes, slave: int = 0) -> int:
        """Write memory of the slave at a position; return the working counter."""
        return self.send(Sent(APWR, at(-slave, offset), data))[0].counter

    # What a master does to bring a slave up, from the standard's layout.

    def configure_mailboxes(self, slave: int = 0) -> None:
        """Write sync managers 0 and 1: 256 bytes each, from and to the master."""
        self.write(0x0800, struct.pack('<HHBBBB', 0x1000, 256, 0x26, 0, 1, 0), slave)
        self.write(0x0808, struct.pack('<HHBBBB', 0x1100, 256, 0x22, 0, 1, 0), slave)

    def configure_process_data(
            self, slave: int = 0, sizes: tuple[int, int] | None = None) -> None:
        """Write sync managers 2 and 3 and FMMUs: outputs at 0x1000 * slave, inputs behind."""
        out, into = sizes or self.sizes(slave)
        self.write(0x0810, struct.pack('<HHBBBB', 0x1200, out, 0x64, 0, 1, 0), slave)
        self.write(0x0818, struct.pack('<HHBBBB', 0x1E00, into, 0x20, 0, 1, 0), slave)
        self.write(0x0600, struct.pack(
            '<IHBBHBBB', 0x1000 * slave, out, 0, 7, 0x1200, 0, 2, 1).ljust(16, b'\0'), slave)
        self.write(0x0610, struct.pack(
            '<IHBBHBBB', 0x1000 * slave + out, into, 0, 7, 0x1E00, 0, 1, 1).ljust(16, b'\0'),
            slave)

    def sizes(self, slave: int) -> tuple[int, int]:
        """Return the bytes of outputs and inputs by the PDOs assigned."""
        toy = self.toys[slave]
        out, into = (sum(map(toy.size, toy.assigned(one))) for one in (0x1C12, 0x1C13))
        return out, into

    def request(self, state: int, slave: int = 0) -> tuple[int, int]:
        """Ask for a state; return AL status and AL status code."""
        self.write(0x0120, struct.pack('<H', state), slave)
        return self.number(0x0130, 2, slave), self.number(0x0134, 2, slave)

    def bring_up(self, state: int = OP) -> None:
        """Bring all slaves into a state."""
        for slave in range(len(self.toys)):
            self.configure_mailboxes(slave)
            assert self.request(PREOP, slave) == (PREOP, 0)
            if state > PREOP:
                self.configure_process_data(slave)
                assert self.request(SAFEOP, slave) == (SAFEOP, 0)
            if state == OP:
                assert self.request(OP, slave) == (OP, 0)

    def exchange(self, *outputs: bytes) -> list[Answer]:
        """Exchange process data, one datagram a slave in one frame; inputs follow outputs."""
        sent = []
        for slave in range(len(self.toys)):
            own = outputs[slave] if slave < len(outputs) else b''
            size = sum(self.sizes(slave))
            sent.append(Sent(LRW, 0x1000 * slave, own.ljust(size, b'\0')))
        return self.send(*sent)

    # Mailbox.

    def post(self, content: bytes, kind: int = 3, counter: int | None = None,
             slave: int = 0, length: int | None = None) -> int:
        """Send a mail; return the working counter."""
        self._counter = self._counter % 7 + 1
        number = self._counter if counter is None else counter
        mail = struct.pack('<HHBB', len(content) if length is None else length, 0, 0,
                           kind | number << 4)
        return self.write(0x1000, (mail + content).ljust(256, b'\0'), slave)

    def fetch(self, slave: int = 0) -> tuple[int, bytes] | None:
        """Return type and content of the next mail, None if there is none."""
        if not self.number(0x080D, 1, slave) & 8:
            return None
        mail = self.read(0x1100, 256, slave)
        length, _, _, kind = struct.unpack_from('<HHBB', mail)
        return kind & 0x0F, mail[6:6 + length]

    def ask(self, content: bytes, kind: int = 3, slave: int = 0) -> bytes:
        """Send a mail and return the content of the answer of the same type."""
        assert self.post(content, kind, slave=slave) == 1
        answer = self.fetch(slave)
        assert answer is not None and answer[0] == kind, answer
        return answer[1]

    def upload(self, index: int, subindex: int, flags: int = 0) -> bytes:
        """Send an initiate upload; return the SDO of the answer without the service."""
        return self.ask(struct.pack('<HBHBI', 0x2000, 0x40 | flags, index, subindex, 0))[2:]


def in_state(state: int, *toys: Toy) -> RawMaster:
    """Return the master of slaves that it has brought into a state."""
    master = RawMaster(*toys)
    if state > INIT:
        master.bring_up(state)
    return master


def abort_of(answer: bytes) -> int:
    """Return the code of an SDO abort."""
    assert answer[2] == 0x80
    return struct.unpack_from('<I', answer, 6)[0]
