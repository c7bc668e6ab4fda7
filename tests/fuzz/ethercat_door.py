"""Frames on EtherCAT: random ones and altered true ones, at slaves in any state."""

from collections.abc import Callable
import random
import struct

import isa_ros
from isa_ros.fieldbus.device.bus_device import Emergency
from isa_ros.fieldbus.device.devices import devices_of
from tests.fieldbus.ethercat.raw_master import (
    APRD, APWR, at, BRD, BWR, FPRD, frame_of, FRMW, INIT, LRD, LRW, LWR, OP, PREOP, RawMaster,
    SAFEOP, Sent)
from tests.fieldbus.toys import Toy
from tests.fuzz.bytes_of import altered
from tests.fuzz.property import Broken

LEG = isa_ros.load('leg').configuration
LONGEST_FRAME = 1514
"""Ethernet frame without its check sequence."""
FRAMES_EACH = 25
"""Frames that one ring gets before a new one is made."""
STATES = (INIT, PREOP, SAFEOP, OP)
SERVICES = (0x1000, 0x2000, 0x3000, 0x4000, 0x8000)
COMMANDS = (0x40, 0x50, 0x60, 0x70, 0x21, 0x23, 0x31, 0x00, 0x10, 0x01, 0x80, 0xFF)
INDICES = (0x1000, 0x1008, 0x1018, 0x1600, 0x1C12, 0x1C13, 0x2000, 0x2001, 0x9999)
OFFSETS = (0x0000, 0x0010, 0x0100, 0x0110, 0x0120, 0x0130, 0x0300, 0x0400, 0x0420, 0x0442, 0x0500,
           0x0502, 0x0508, 0x0600, 0x0610, 0x0800, 0x0808, 0x080E, 0x0810, 0x0818, 0x0900, 0x0910,
           0x0920, 0x0981, 0x09A0, 0x0FFE, 0x1000, 0x1100, 0x1200, 0x1E00, 0x2FFF, 0xFFFF)


def toys(state: int) -> RawMaster:
    """Return two toys in a state, one of them with mails that wait."""
    master = RawMaster(Toy('a'), Toy('b', 2, filler=3))
    if state > INIT:
        master.bring_up(state)
        master.toys[1].pending = [Emergency(0x1000, 1, b'12345')]
        master.tick()
    return master


def actuators(state: int) -> RawMaster:
    """Return the actuators of the leg in a state, of one profile or the other."""
    found = RawMaster(*devices_of(LEG, 'cia402' if state in (PREOP, OP) else 'cia408'))
    found.tick = found.line.update
    if state > INIT:
        found.bring_up(state)
    return found


def mail(dice: random.Random) -> bytes:
    """Return a mail that is nearly right: an SDO, SDO information, or another service."""
    service, command = dice.choice(SERVICES), dice.choice(COMMANDS)
    content = struct.pack('<HBHBI', service, command, dice.choice(INDICES), dice.randrange(4),
                          dice.choice((0, 1, 4, 300, 2**32 - 1)))
    if service == 0x8000:
        content = struct.pack('<HBBHHBB', service, dice.randrange(10), 0, 0, dice.choice(
            (*INDICES, *range(7))), dice.randrange(4), 0)
    content += bytes(dice.choice((0, 3, 100, 240)))
    length = dice.choice((len(content), len(content), dice.randrange(12), 0xFFFF))
    kind = dice.choice((3, 3, 3, dice.randrange(16))) | dice.randrange(8) << 4
    return struct.pack('<HHBB', length, 0, 0, kind) + content


def content(offset: int, dice: random.Random) -> bytes:
    """Return data that suit an offset."""
    if offset == 0x1000:
        return mail(dice).ljust(256, b'\0')[:256]
    if offset == 0x0120:
        return struct.pack('<H', dice.choice((*STATES, 0x12, 0x14, 0x18, 3, 0, 0x1F)))
    return dice.randbytes(dice.choice((1, 2, 4, 6, 8, 16, 256)))


def datagram(dice: random.Random) -> Sent:
    """Return a datagram that a master might send."""
    command = dice.choice((APRD, APWR, FPRD, BRD, BWR, LRD, LWR, LRW, FRMW, dice.randrange(256)))
    if LRD <= command <= LRW:
        return Sent(command, dice.choice((0, 0, 6, 0x1000, 0x0FFF, 2**32 - 4)),
                    dice.randbytes(dice.choice((1, 6, 12, 36, 200))))
    offset = dice.choice(OFFSETS)
    return Sent(command, at(dice.choice((0, 0, -1, 0, 1001)), offset), content(offset, dice))


def frame(dice: random.Random) -> bytes:
    """Return a frame: nearly right, altered, or noise."""
    made = frame_of([datagram(dice) for _ in range(dice.choice((1, 1, 2, 4)))])
    act = dice.randrange(4)
    if act == 0:
        made = made[:16] + altered(made[16:], dice)
    elif act == 1:
        made = altered(made, dice)
    elif act == 2 and dice.random() < 0.2:
        made = made[:16] + dice.randbytes(dice.randrange(200))
    return made[:LONGEST_FRAME]


def check(master: RawMaster, sent: bytes) -> bool:
    """
    Return whether a frame was answered.

    Assert that it comes back with its length, and that every slave is in a state.
    """
    answers = len(master.wire.outgoing)
    master.wire.incoming.append(sent)
    for _ in range(2):
        if master.line.serve(0.0):
            master.tick()
    assert not master.wire.incoming
    found = master.wire.outgoing[answers:]
    assert len(found) == (len(sent) >= 16 and sent[12:14] == b'\x88\xa4' and sent[15] >> 4 == 1)
    for answer in found:
        end = 16 + (struct.unpack_from('<H', sent, 14)[0] & 0x07FF)
        assert len(answer) == len(sent)
        assert answer[12:16] == sent[12:16], 'a header has changed'
        assert answer[end:] == sent[end:], 'bytes behind the datagrams have changed'
    master.wire.outgoing.clear()
    for slave, toy in zip(master.ring.slaves, master.toys):
        memory = slave.controller.memory
        assert len(memory) == 0x3000
        assert memory[0x0130] & 0x0F == slave.state and slave.state in STATES
        assert memory[0x0000:0x0008] == bytes((0x11, 0, 0, 0, 8, 8, 8, 0x0F))
        if isinstance(toy, Toy):
            assert toy.is_operational == (slave.state == OP)
            assert all(len(one) in (6, 18) for one in toy.received)
    return bool(found)


def fuzz(cases: int, seed: int, ring: Callable[[int], RawMaster] = toys) -> int:
    """Send that many frames; return how many were answered."""
    dice, answered = random.Random(seed), 0
    for k in range(cases):
        if k % FRAMES_EACH == 0:
            master = ring(STATES[k // FRAMES_EACH % len(STATES)])
        sent = frame(dice)
        try:
            answered += check(master, sent)
        except Exception as error:
            raise Broken(f'case {k} of seed {seed}, frame {sent!r}: '
                         f'{type(error).__name__}: {error}') from error
    return answered
