"""FMMUs: whole bytes, single bits, and parts of either."""

import struct

from hypothesis import given, strategies
from isa_ros.fieldbus.ethercat.fmmu import active_fmmus, copy_bits, Fmmu, FmmuWindow, window
from isa_ros.fieldbus.ethercat.registers import power_on
from tests.fieldbus.ethercat.raw_master import LRD, LRW, LWR, OP, RawMaster, SAFEOP, Sent


def memory_with(*entries: bytes) -> bytearray:
    """Return a memory with FMMUs from 0x0600 on."""
    memory = power_on()
    for k, entry in enumerate(entries):
        memory[0x0600 + 16 * k:0x0600 + 16 * k + len(entry)] = entry
    return memory


def test_the_registers_describe_an_fmmu():
    entry = struct.pack('<IHBBHBBB', 0x10000, 4, 2, 5, 0x1200, 3, 1, 1)
    assert active_fmmus(memory_with(entry)) == [
        Fmmu(0x10000, 4, 2, 5, 0x1200, 3, True, False)]
    assert active_fmmus(memory_with(entry))[0].bits == 8 * 3 + 4


def test_one_that_is_off_or_empty_is_left_out():
    off = struct.pack('<IHBBHBBB', 0, 4, 0, 7, 0x1200, 0, 1, 0)
    empty = struct.pack('<IHBBHBBB', 0, 0, 0, 7, 0x1200, 0, 1, 1)
    reverse = struct.pack('<IHBBHBBB', 0, 1, 5, 2, 0x1200, 0, 1, 1)
    assert active_fmmus(memory_with(off, empty, reverse)) == []


def test_a_datagram_reaches_the_part_that_overlaps():
    fmmu = Fmmu(100, 10, 0, 7, 0x1200, 0, True, False)
    assert window(fmmu, 96, 8) == FmmuWindow(4 * 8, 0x1200 * 8, 4 * 8)
    assert window(fmmu, 104, 2) == FmmuWindow(0, 0x1204 * 8, 2 * 8)
    assert window(fmmu, 90, 10) is None
    assert window(fmmu, 110, 10) is None


def test_bits_reach_from_the_first_to_the_last():
    fmmu = Fmmu(100, 2, 6, 1, 0x1200, 3, True, False)
    assert window(fmmu, 100, 2) == FmmuWindow(6, 0x1200 * 8 + 3, 4)
    assert window(fmmu, 101, 1) == FmmuWindow(0, 0x1200 * 8 + 5, 2)


@given(strategies.binary(min_size=8, max_size=8), strategies.binary(min_size=8, max_size=8),
       strategies.integers(0, 31), strategies.integers(0, 31), strategies.integers(1, 32))
def test_bits_are_copied_one_by_one(source, target, first, at, bits):
    """Compare with a copy of every bit, counted from the least significant one."""
    wanted = list(bits_of(target))
    wanted[at:at + bits] = bits_of(source)[first:first + bits]
    found = bytearray(target)
    copy_bits(source, first, found, at, bits)
    assert bits_of(bytes(found)) == wanted


def bits_of(content: bytes) -> list[int]:
    """Return the bits of bytes, the least significant first."""
    return [byte >> k & 1 for byte in content for k in range(8)]


def test_the_full_bit_of_a_mailbox_is_read_at_a_bit_of_logical_memory():
    """As masters do that look for mail in their process data: bit 3 of 0x080D to bit 5 of 64."""
    master = RawMaster()
    master.bring_up(OP)
    master.write(0x0620, struct.pack('<IHBBHBBB', 64, 1, 5, 5, 0x080D, 3, 1, 1).ljust(16, b'\0'))
    answer = master.send(Sent(LRD, 64, b'\x41'))[0]
    assert (answer.data, answer.counter) == (b'\x41', 1)
    master.post(struct.pack('<HBHBI', 0x2000, 0x40, 0x1000, 0, 0))
    assert master.send(Sent(LRD, 64, b'\x41'))[0].data == b'\x61'


def test_the_status_of_a_mailbox_comes_with_the_process_data():
    """As SOEM maps it: byte 0x080D behind the inputs, in the same datagram."""
    master = RawMaster()
    master.bring_up(OP)
    master.write(0x0620, struct.pack('<IHBBHBBB', 12, 1, 0, 7, 0x080D, 0, 1, 1).ljust(16, b'\0'))
    answer = master.send(Sent(LRW, 0, struct.pack('<Hi', 15, 3).ljust(13, b'\0')))[0]
    assert (answer.data[12], answer.counter) == (0, 3)
    master.post(struct.pack('<HBHBI', 0x2000, 0x40, 0x1000, 0, 0))
    answer = master.send(Sent(LRW, 0, bytes(13)))[0]
    assert (answer.data[12] & 8, answer.counter) == (8, 3)
    assert struct.unpack_from('<Hi', answer.data, 6) == (1, 3)
    assert master.ticks == 2


def test_a_written_bit_leaves_the_others():
    master = RawMaster()
    master.write(0x0600, struct.pack('<IHBBHBBB', 8, 1, 0, 0, 0x2F00, 6, 2, 1).ljust(16, b'\0'))
    master.write(0x2F00, b'\x0f')
    assert master.send(Sent(LWR, 8, b'\x01'))[0].counter == 1
    assert master.read(0x2F00, 1) == b'\x4f'
    master.send(Sent(LWR, 8, b'\xfe'))
    assert master.read(0x2F00, 1) == b'\x0f'


def test_outputs_and_inputs_at_the_same_logical_address_are_exchanged():
    """As SOEM's overlapping map does: written first, then read."""
    master = RawMaster()
    master.bring_up(SAFEOP)
    master.write(0x0600, struct.pack('<IHBBHBBB', 0, 6, 0, 7, 0x1200, 0, 2, 1).ljust(16, b'\0'))
    master.write(0x0610, struct.pack('<IHBBHBBB', 0, 6, 0, 7, 0x1E00, 0, 1, 1).ljust(16, b'\0'))
    assert master.request(OP) == (OP, 0)
    answer = master.send(Sent(LRW, 0, struct.pack('<Hi', 15, 5)))[0]
    assert answer.counter == 3
    assert answer.data == bytes(6)
    assert master.toys[0].target == 5


def test_a_buffer_written_in_two_datagrams_is_passed_on_with_the_second():
    master = RawMaster()
    master.bring_up(OP)
    outputs = struct.pack('<Hi', 15, 0x01020304)
    assert master.send(Sent(LWR, 0, outputs[:4]))[0].counter == 1
    assert not master.toys[0].received
    assert master.send(Sent(LWR, 4, outputs[4:]))[0].counter == 1
    master.send(Sent(LRD, 6, bytes(6)))
    assert master.toys[0].received == [outputs]


def test_an_fmmu_that_begins_within_a_byte_shifts_its_bits():
    """Whole logical bytes from bit 3 on: 5 bytes that touch all 6 of the inputs."""
    master = RawMaster()
    master.bring_up(OP)
    master.toys[0].target = 0x5A3C9617
    master.tick()
    content = int.from_bytes(master.read(0x1E00, 6), 'little')
    master.write(0x0620, struct.pack('<IHBBHBBB', 0x9000, 5, 0, 7, 0x1E00, 3, 1, 1))
    answer, = master.send(Sent(LRD, 0x9000, bytes(5)))
    assert answer.counter == 1
    assert int.from_bytes(answer.data, 'little') == content >> 3 & (1 << 40) - 1
