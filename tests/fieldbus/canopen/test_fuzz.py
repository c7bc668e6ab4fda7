"""Altered frames at every door: no traceback, no hang, and the nodes still answer."""

from collections.abc import Iterator
import random
import struct

import can
import isa_ros
from isa_ros.fieldbus.canopen.line import CanopenLine
from isa_ros.fieldbus.canopen.mit_frames import ENABLE
from isa_ros.fieldbus.device.bus_device import BusDevice
from isa_ros.fieldbus.device.devices import devices_of
import pytest
from tests.fieldbus.canopen.mit_master import special_frame
from tests.fieldbus.canopen.test_mit import motors
from tests.fieldbus.canopen.toy import ToyDrive
from tests.fieldbus.canopen.virtual_bus import Master, RESET_NODE, START, virtual_master

FRAMES = 1500
Sent = tuple[int, bytes]


def true_frames(device: BusDevice) -> list[Sent]:
    """Return what a master sends to node 1: NMT, SYNC, PDOs, heartbeats, SDO of all objects."""
    frames = [(0x000, bytes([command, node])) for command in (1, 2, 0x80, 0x81, 0x82)
              for node in (0, 1)]
    frames += [(0x080, b''), (0x080, b'\x01'), (0x701, b'\x05'), (0x77F, b'\x7f')] * 5
    frames += [(0x201, struct.pack('<Hbh', word, mode, 100))
               for word in (0, 6, 7, 15, 0x80) for mode in (-1, 8, 9, 10)] * 5
    frames += [(0x301, struct.pack('<ii', 1000, -1000))] * 20
    for entry in device.table.on('canopen').entries:
        head = struct.pack('<HB', entry.index, entry.subindex)
        data = device.read(entry.index, entry.subindex)
        frames.append((0x601, b'\x40' + head + bytes(4)))
        if len(data) <= 4:
            command = bytes([0x23 | 4 - len(data) << 2])
            frames.append((0x601, command + head + data.ljust(4, b'\0')))
        frames.append((0x601, b'\x21' + head + struct.pack('<I', len(data))))
    frames += [(0x601, bytes([command]) + b'segment') for command in
               (0x00, 0x10, 0x01, 0x11, 0x60, 0x70, 0x80, 0xA0, 0xC0, 0xFF)] * 20
    return frames


def altered(frames: list[Sent], count: int, most: int) -> Iterator[Sent]:
    """Yield frames with changed bytes, lengths and identifiers, the same on every run."""
    draw = random.Random(12)
    for _ in range(count):
        identifier, data = draw.choice(frames)
        content = bytearray(data)
        for _ in range(draw.choice((0, 0, 1, 1, 2, 4))):
            if content:
                content[draw.randrange(len(content))] = draw.choice((0, 1, 0x7F, 0x80, 0xFF,
                                                                     draw.randrange(256)))
        kind = draw.random()
        if kind < 0.1:
            content = content[:draw.randrange(len(content) + 1)]
        elif kind < 0.2:
            content += draw.randbytes(draw.randrange(most + 1))
        elif kind < 0.3:
            identifier = draw.randrange(0x800)
        yield identifier, bytes(content[:most])


def send_all(master: Master, devices: list[BusDevice]) -> None:
    """Send the altered frames of the first device; a tick has no plant here."""
    for identifier, data in altered(true_frames(devices[0]), FRAMES, 8):
        if master.send(identifier, data):
            master.line.update()
        master.received()


@pytest.fixture(scope='module')
def run():
    return isa_ros.load('leg').configuration


def test_altered_frames_leave_the_nodes_of_a_leg_working(run):
    devices = devices_of(run)[:2]
    with virtual_master(devices) as master:
        send_all(master, devices)
        master.command(RESET_NODE)
        assert master.read(0x1000) == b'\x92\x01\x02\x00'
        master.command(START)
        assert master.send(0x080)


def test_the_frames_find_a_missing_guard(run, monkeypatch):
    def unguarded(self, data):
        command, number = data
    monkeypatch.setattr(CanopenLine, '_command', unguarded)
    devices = devices_of(run)[:1]
    with virtual_master(devices) as master, pytest.raises(ValueError):
        send_all(master, devices)


def test_altered_frames_leave_mit_motors_working():
    toys = ToyDrive('hfe'), ToyDrive('kfe')
    frames = [(motor, special_frame(kind)) for motor in (1, 2) for kind in (0xFC, 0xFD, 0xFE)]
    frames += [(motor, bytes.fromhex('8000800000000800')) for motor in (1, 2)] * 10
    frames += true_frames(toys[0])[:20]
    with motors(*toys) as master:
        for identifier, data in altered(frames, FRAMES, 8):
            master.send(identifier, data)
        ticks = toys[0].ticks
        assert ticks > 0
        for _ in range(6):
            master.send(1, special_frame(ENABLE))
            for motor in (1, 2):
                master.send(motor, bytes.fromhex('8000800000000800'))
        assert toys[0].state == 'enabled'


def test_frames_of_every_kind_are_ignored_or_handled():
    """What python-can can represent at all: remote, extended, FD and error frames."""
    draw = random.Random(7)
    toy = ToyDrive()
    with virtual_master([toy]) as master:
        for _ in range(FRAMES // 5):
            is_fd = draw.random() < 0.2
            data = draw.randbytes(draw.choice((0, 1, 2, 5, 8)))
            message = can.Message(
                arbitration_id=draw.randrange(0x800), is_extended_id=draw.random() < 0.2,
                is_remote_frame=not is_fd and draw.random() < 0.2, is_fd=is_fd,
                is_error_frame=not is_fd and draw.random() < 0.1, data=data)
            if master.send_message(message):
                toy.tick()
                master.line.update()
        assert master.line.port.ignored > 0
