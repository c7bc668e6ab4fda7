"""What frames take of a bus, against the frames themselves."""

from hypothesis import given, strategies as st
from isa_ros.config.models.wires import wire
from isa_ros.errors import ConfigError
from isa_ros.fieldbus.canopen.capacity import CyclicFrame, frame_bits, refuse_overfull
from isa_ros.fieldbus.canopen.line import canopen_line
import pytest
from tests.fieldbus.canopen.toy import ToyDrive
from tests.fieldbus.canopen.virtual_bus import (
    PREOPERATIONAL, RESET_COMMUNICATION, START, STEP_NS, virtual_master)

POLYNOMIAL = 0x4599     # of CAN's check, x^15 + ...


def sent_bits(identifier: int, data: bytes) -> int:
    """Return the bits of a frame on the wire, with its true check and stuff bits."""
    bits = [0] + [identifier >> k & 1 for k in range(10, -1, -1)] + [0, 0, 0]
    bits += [len(data) >> k & 1 for k in range(3, -1, -1)]
    bits += [byte >> k & 1 for byte in data for k in range(7, -1, -1)]
    check = 0
    for bit in bits:
        is_set = bit ^ check >> 14 & 1
        check = check << 1 & 0x7FFF
        if is_set:
            check ^= POLYNOMIAL
    bits += [check >> k & 1 for k in range(14, -1, -1)]
    stuffed, run, last = 0, 0, None
    for bit in bits:
        run, last = (run + 1 if bit == last else 1), bit
        if run == 5:
            stuffed, run, last = stuffed + 1, 1, 1 - bit
    return len(bits) + stuffed + 13     # delimiters, acknowledge, end and 3 between frames


@given(st.integers(0, 0x7FF), st.one_of(
    st.binary(max_size=8), st.lists(st.sampled_from([0, 0xFF, 0x87, 0x78, 0xC3, 0xE1, 0x0F, 0xF0]),
                                    max_size=8).map(bytes)))
def test_no_frame_takes_more_than_its_bits(identifier, data):
    assert sent_bits(identifier, data) <= frame_bits(CyclicFrame(identifier, len(data)))


def worst_data(identifier: int, size: int) -> bytes:
    """Return data that repeat the last bit on the wire: a stuff bit after every four."""
    run, last = 0, None
    header = f'0{identifier:011b}000{size:04b}'
    data = ''
    for k in range(len(header) + 8 * size):
        bit = header[k] if k < len(header) else last
        data += bit if k >= len(header) else ''
        run, last = (run + 1 if bit == last else 1), bit
        if run == 5:
            run, last = 1, '1' if bit == '0' else '0'
    return int(data, 2).to_bytes(size, 'big')


@pytest.mark.parametrize('identifier', [0x181, 0x281, 0x201, 0x001, 0x7F0])
def test_the_bits_are_those_of_the_worst_data(identifier):
    """Only the check of 15 bits cannot be chosen: it has at most 4 stuff bits less."""
    sent = sent_bits(identifier, worst_data(identifier, 8))
    assert 0 <= frame_bits(CyclicFrame(identifier, 8)) - sent <= 4


def test_the_wire_of_links_has_the_same_frames_with_unknown_identifiers():
    """Four PDOs of 5, 8, 5 and 8 bytes: `can.yaml` allows any identifier, so a few bits more."""
    frames = [CyclicFrame(0x201, 5), CyclicFrame(0x301, 8), CyclicFrame(0x181, 5),
              CyclicFrame(0x281, 8)]
    mine = sum(map(frame_bits, frames))
    assert 4 * 47 + 26 * 8 < mine <= wire('can')[0].actuator_bits


def test_two_actuators_fit_in_a_millisecond_and_three_do_not():
    canopen_line([ToyDrive('a'), ToyDrive('b')], 'virtual', 'capacity', STEP_NS).close()
    with pytest.raises(ConfigError) as refused:
        canopen_line([ToyDrive(name) for name in ('haa', 'hfe', 'kfe')], 'virtual', 'capacity',
                     STEP_NS)
    assert str(refused.value) == (
        'step_ms = 1 ms, must be >= 1.453 ms: 3 actuators (haa, hfe, kfe) need SYNC 53 + 466 + '
        '468 + 466 = 1453 bit a tick, CAN at 1 Mbit/s carries 1000 bit')


def test_a_lower_bit_rate_carries_less():
    with pytest.raises(ConfigError, match='519 bit a tick, CAN at 0.5 Mbit/s carries 500 bit'):
        canopen_line([ToyDrive()], 'virtual', 'capacity', STEP_NS, bitrate=500_000)


def test_a_full_bus_is_not_refused():
    frame = CyclicFrame(0x181, 8)
    bits = frame_bits(frame)
    refuse_overfull([], {'kfe': [frame]}, 1000 * bits, STEP_NS)
    with pytest.raises(ConfigError):
        refuse_overfull([], {'kfe': [frame]}, 1000 * bits - 1, STEP_NS)


def test_nodes_that_the_master_makes_too_long_do_not_start():
    toys = [ToyDrive('hfe'), ToyDrive('kfe')]
    with virtual_master(toys) as master:
        master.write(0x1402, 1, 0x401, 4)
        master.received()
        master.command(START)
        assert [node.state for node in master.line.nodes] == [PREOPERATIONAL] * 2
        assert master.received()[0] == (0x81, b'\x00\x81\x11\x01\0\0\0\0')
        assert toys[0].values[0x2003, 0] == (
            'step_ms = 1 ms, must be >= 1.119 ms: 2 actuators (hfe, kfe) need SYNC 53 + 598 + 468 '
            '= 1119 bit a tick, CAN at 1 Mbit/s carries 1000 bit')
        master.command(START, 1)
        assert master.cycle()[0][0] == 0x181
        master.command(RESET_COMMUNICATION)
        master.command(START)
        assert len(master.cycle()) == 4
