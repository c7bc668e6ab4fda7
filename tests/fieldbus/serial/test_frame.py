"""The frame of the serial line: its bytes, and finding it in a stream."""

from binascii import crc_hqx

from hypothesis import given, strategies as st
from isa_ros.fieldbus.serial.frame import (
    FrameReader, MOST_CONTENT, OVERHEAD, packed, PROCESS_DATA, SerialFrame, START)
import pytest

FRAMES = st.builds(SerialFrame, st.integers(0, 255), st.integers(0, 255), st.binary(max_size=40))
FRAME = SerialFrame(PROCESS_DATA, 7, b'setpoints')


def taken(reader: FrameReader) -> list[SerialFrame]:
    frames = []
    while (frame := reader.take()) is not None:
        frames.append(frame)
    return frames


def test_the_check_is_that_of_its_catalogue():
    """CRC-16/IBM-3740 of "123456789" is 0x29B1."""
    assert crc_hqx(b'123456789', 0xFFFF) == 0x29B1
    data = packed(FRAME)
    assert data[:-2] == START + b'\x01\x07\x09\x00setpoints'
    assert int.from_bytes(data[-2:], 'little') == crc_hqx(data[2:-2], 0xFFFF)


@given(st.lists(FRAMES, max_size=5), st.lists(st.integers(1, 30), min_size=1, max_size=20))
def test_frames_are_found_however_the_bytes_arrive(frames, sizes):
    stream = b''.join(map(packed, frames))
    reader, found = FrameReader(), []
    for k in range(len(stream) + 1):
        part, stream = stream[:sizes[k % len(sizes)]], stream[sizes[k % len(sizes)]:]
        reader.feed(part)
        found += taken(reader)
    assert found == frames
    assert reader.discarded == 0


@given(FRAMES, st.integers(0), st.integers(1, 255))
def test_a_changed_byte_is_never_a_frame_and_the_next_frame_is_found(frame, place, change):
    """A CRC of 16 bits finds every error within 16 bits."""
    changed = bytearray(packed(frame))
    changed[place % len(changed)] ^= change
    reader = FrameReader()
    reader.feed(bytes(changed))
    assert taken(reader) == []
    reader.feed(packed(FRAME))
    assert taken(reader) == [FRAME]


def test_a_wrong_check_is_counted():
    reader = FrameReader()
    reader.feed(packed(FRAME)[:-1] + b'\xff')
    assert taken(reader) == []
    assert reader.discarded == 1


@pytest.mark.parametrize('noise', [b'', b'noise', START[:1], START[:1] * 3, START * 2])
def test_noise_before_a_frame_is_dropped(noise):
    reader = FrameReader()
    reader.feed(noise)
    assert taken(reader) == []
    reader.feed(packed(FRAME))
    assert taken(reader) == [FRAME]


def test_a_frame_that_is_cut_short_is_given_up_for_a_whole_one():
    reader = FrameReader()
    reader.feed(packed(FRAME)[:-3])
    assert taken(reader) == []
    reader.feed(packed(FRAME._replace(number=8)))
    assert taken(reader) == [FRAME._replace(number=8)]
    assert reader.discarded == 1


def test_a_length_beyond_the_largest_is_no_frame():
    reader = FrameReader()
    reader.feed(START + b'\x01\x00' + (MOST_CONTENT + 1).to_bytes(2, 'little') + packed(FRAME))
    assert taken(reader) == [FRAME]


def test_the_largest_content_is_a_frame():
    frame = SerialFrame(1, 2, bytes(MOST_CONTENT))
    reader = FrameReader()
    reader.feed(packed(frame))
    assert taken(reader) == [frame]
    assert len(packed(frame)) == MOST_CONTENT + OVERHEAD


def test_an_impossible_length_is_not_counted_as_a_discarded_request():
    """Bytes that look like a start are no request that a master has sent."""
    reader = FrameReader()
    reader.feed(START + b'\x01\x00' + (MOST_CONTENT + 1).to_bytes(2, 'little') + packed(FRAME))
    assert taken(reader) == [FRAME]
    assert reader.discarded == 0
