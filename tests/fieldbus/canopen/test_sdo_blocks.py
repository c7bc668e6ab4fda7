"""Transfers of an SDO server in blocks: what is lost, refused and checked."""

from binascii import crc_hqx

import canopen
from hypothesis import example, given, strategies as st
from isa_ros.fieldbus.canopen import sdo
from isa_ros.fieldbus.canopen.sdo import MOST_BYTES
import pytest
from tests.fieldbus.canopen.sdo_requests import code, request, SdoServer, TEXT, Values


def in_blocks(server: sdo.SdoServer, sizes: list[int], lost: set[int]) -> bytes:
    """Read the text in blocks of these sizes; segments with these numbers of all are lost."""
    first, = server.answers(request(0xA4, TEXT, bytes([sizes[0], 0])))
    assert first[:4] == b'\xc6\x01\x20\0'
    size, data, sent, k = int.from_bytes(first[4:], 'little'), b'', 0, 0
    frames = server.answers(bytes([0xA3]) + bytes(7))
    while True:
        assert 0 < len(frames) <= sizes[k]
        assert [frame[0] & 0x7F for frame in frames] == list(range(1, len(frames) + 1))
        arrived = 0
        for number, frame in enumerate(frames, 1):
            sent += 1
            if sent not in lost and arrived == number - 1:
                arrived, data = number, data + frame[1:]
                is_last = bool(frame[0] & 0x80)
        k = min(k + 1, len(sizes) - 1)
        frames = server.answers(bytes([0xA2, arrived, sizes[k]]) + bytes(5))
        if arrived and is_last:
            end, = frames
            assert end[0] & 0xE3 == 0xC1
            assert len(data) - (end[0] >> 2 & 7) == size
            assert int.from_bytes(end[1:3], 'little') == crc_hqx(data[:size], 0)
            assert server.answers(bytes([0xA1]) + bytes(7)) == []
            return data[:size]


@given(st.binary(max_size=300), st.lists(st.integers(1, 127), min_size=1, max_size=4),
       st.sets(st.integers(1, 60), max_size=10))
@example(b'', [5], {1})
@example(b'seven b', [1], {1, 2})
def test_what_is_read_in_blocks_is_whole_whatever_is_lost(data, sizes, lost):
    values = Values()
    values.content[TEXT] = data
    server = sdo.SdoServer(values)
    assert in_blocks(server, sizes, lost) == data
    assert code(server.answers(bytes([0xA1]) + bytes(7))[0]) == 0x05040001


class Wire:
    """Carries the frames between a client of `canopen` and a server, in one thread."""

    def __init__(self, server: sdo.SdoServer, client: canopen.sdo.SdoClient) -> None:
        self._server, self._client = server, client

    def send_message(self, identifier: int, data: bytes, remote: bool = False) -> None:
        for frame in self._server.answers(bytes(data)):
            self._client.on_response(0x581, bytearray(frame), 0.0)


@pytest.mark.parametrize('size', [5, 7, 889, 890, 2000])
def test_the_client_of_canopen_reads_in_blocks(size):
    """127 segments of 7 bytes are 889; it checks sequence, length and CRC."""
    values = Values()
    values.content[TEXT] = bytes(k % 251 for k in range(size))
    client = canopen.sdo.SdoClient(0x601, 0x581, canopen.ObjectDictionary())
    client.network = Wire(sdo.SdoServer(values), client)
    with client.open(*TEXT, mode='rb', buffering=0, block_transfer=True) as stream:
        assert stream.readall() == values.content[TEXT]


def test_the_crc_is_that_of_cia_301():
    """CRC-16/XMODEM of "123456789" is 0x31C3; 9 bytes are 2 segments, 5 bytes unused."""
    values = Values()
    values.content[TEXT] = b'123456789'
    server = sdo.SdoServer(values)
    server.answers(request(0xA4, TEXT, bytes([127, 0])))
    assert server.answers(bytes([0xA3]) + bytes(7)) == [b'\x011234567', b'\x8289' + bytes(5)]
    assert server.answers(bytes([0xA2, 2, 127]) + bytes(5)) == [b'\xd5\xc3\x31' + bytes(5)]


@pytest.mark.parametrize('size', [1, 7, 889, 890, 4096])
def test_the_client_of_canopen_writes_in_blocks(size):
    """It announces the size, and its CRC is that of the library."""
    values = Values()
    client = canopen.sdo.SdoClient(0x601, 0x581, canopen.ObjectDictionary())
    client.network = Wire(sdo.SdoServer(values), client)
    content = bytes(k % 251 for k in range(size))
    with client.open(*TEXT, mode='wb', size=size, block_transfer=True) as stream:
        stream.write(content)
    assert values.content[TEXT] == content


def into_blocks(server: sdo.SdoServer, data: bytes, flags: int, lost: set[int],
                crc: int | None = None) -> bytes:
    """Write the text in blocks; segments with these numbers of all are lost; return the end."""
    first, = server.answers(request(0xC0 | flags, TEXT, len(data).to_bytes(4, 'little')))
    assert first == request(0xA4, TEXT, bytes([127]))
    parts = [data[k:k + 7] for k in range(0, len(data), 7)] or [b'']
    place, sent = 0, 0
    while place < len(parts):
        block = parts[place:place + 127]
        for number, part in enumerate(block, 1):
            is_last = place + number == len(parts)
            sent += 1
            ends = number == len(block)
            if sent in lost and not ends:   # a client waits for the answer to the end of a block
                continue
            answers = server.answers(
                bytes([number | 0x80 * is_last]) + part.ljust(7, b'\0'))
            assert len(answers) == ends
        (confirmed,) = answers
        assert (confirmed[0], confirmed[2]) == (0xA2, 127)
        place += confirmed[1]
    unused = 7 - len(parts[-1])
    own = crc_hqx(data, 0) if crc is None else crc
    (end,) = server.answers(
        bytes([0xC1 | unused << 2]) + own.to_bytes(2, 'little') + bytes(5))
    return end


@given(st.binary(max_size=2000), st.sampled_from([0, 2, 4, 6]),
       st.sets(st.integers(1, 300), max_size=10))
@example(b'', 6, set())
@example(bytes(range(250)) * 4, 6, {1})
def test_what_is_written_in_blocks_is_whole_whatever_is_lost(data, flags, lost):
    values = Values()
    server = sdo.SdoServer(values)
    assert into_blocks(server, data, flags, lost) == bytes([0xA1]) + bytes(7)
    assert values.content[TEXT] == data
    assert code(server.answers(bytes([0xC1]) + bytes(7))[0]) == 0x05040001


def test_a_wrong_crc_is_refused_where_the_client_has_one():
    values = Values()
    server = sdo.SdoServer(values)
    assert code(into_blocks(server, b'123456789', 6, set(), crc=0x31C2)) == 0x05040004
    assert values.content[TEXT] == b''
    assert into_blocks(server, b'123456789', 2, set(), crc=0x31C2)[0] == 0xA1
    assert values.content[TEXT] == b'123456789'


def block(number: int) -> list[int]:
    """Return a segment of sevens."""
    return [number, *([7] * 7)]


@pytest.mark.parametrize(('size', 'frames', 'expected'), [
    (MOST_BYTES + 1, [], 0x05040005), (9, [block(0)], 0x05040003),
    (7, [block(1), block(2), block(3)], 0x06070012),
    (7, [block(1), block(0x82), [0xC1]], 0x06070012),
    (8, [block(0x81), [0xC1]], 0x06070013), (6, [block(0x81), [0xC1]], 0x06070012),
    (9, [block(0x81), block(1)], 0x05040001), (9, [block(0x81), [0xA1]], 0x05040001)])
def test_a_download_in_blocks_is_refused_by_its_length_and_order(size, frames, expected):
    """A segment behind the last one belongs to no transfer."""
    values = Values()
    server = sdo.SdoServer(values)
    answers = server.answers(request(0xC2, TEXT, size.to_bytes(4, 'little')))
    for one in frames:
        answers = server.answers(bytes(one).ljust(8, b'\0'))
    assert code(answers[0]) == expected
    assert answers[0][1:4] == b'\x01\x20\0'
    assert values.content[TEXT] == b''
    assert code(server.answers(bytes([0xC1]) + bytes(7))[0]) == 0x05040001


def test_a_download_in_blocks_without_a_size_ends_where_there_is_no_room():
    """4096 bytes are 585 segments and one of a byte; the last may be empty, but no further one."""
    server = sdo.SdoServer(Values())
    server.answers(request(0xC0, TEXT))
    for sent in range(586):
        answers = server.answers(bytes(block(sent % 127 + 1)))
        assert [one[0] for one in answers] == ([0xA2] if sent % 127 == 126 else [])
    assert code(server.answers(bytes(block(586 % 127 + 1)))[0]) == 0x05040005


def test_a_download_in_blocks_is_refused_by_what_does_not_exist_and_ended_by_an_abort():
    values = Values()
    server = sdo.SdoServer(values)
    assert code(server.answers(request(0xC0, (0x1234, 5)))[0]) == 0x06020000
    server.answers(request(0xC0, TEXT))
    assert server.answers(bytes(block(1))) == []
    assert server.answers(bytes([0x80]) + bytes(7)) == []
    assert server.answers(request(0x40, TEXT))[0][0] == 0x41


@pytest.mark.parametrize(('threshold', 'begin'), [(9, 0xC6), (10, 0x41), (255, 0x41), (0, 0xC6)])
def test_up_to_its_threshold_a_client_gets_the_other_protocol(threshold, begin):
    values = Values()
    values.content[TEXT] = b'0123456789'
    server = SdoServer(values)
    assert server.answer(request(0xA4, TEXT, bytes([5, threshold])))[0] == begin


@pytest.mark.parametrize(('before', 'wrong', 'expected'), [
    ([], [0xA3], 0x05040001), ([], [0xA2, 0, 5], 0x05040001), ([], [0xA1], 0x05040001),
    ([[0xA4, 1, 0x20, 0, 5]], [0xA2, 0, 5], 0x05040001),
    ([[0xA4, 1, 0x20, 0, 5]], [0xA1], 0x05040001),
    ([[0xA4, 1, 0x20, 0, 5], [0xA3]], [0xA3], 0x05040001),
    ([[0xA4, 1, 0x20, 0, 5], [0xA3]], [0xA1], 0x05040001),
    ([[0xA4, 1, 0x20, 0, 5], [0xA3]], [0xA2, 6, 5], 0x05040003),
    ([[0xA4, 1, 0x20, 0, 5], [0xA3]], [0xA2, 5, 0], 0x05040002),
    ([[0xA4, 1, 0x20, 0, 5], [0xA3]], [0xA2, 5, 128], 0x05040002),
    ([[0xA4, 1, 0x20, 0, 5], [0xA3]], [0x60], 0x05040001),
    ([], [0xA4, 1, 0x20, 0, 0], 0x05040002), ([], [0xA4, 1, 0x20, 0, 128], 0x05040002)])
def test_a_request_out_of_order_ends_an_upload_in_blocks(before, wrong, expected):
    values = Values()
    values.content[TEXT] = bytes(100)
    server = sdo.SdoServer(values)
    for one in before:
        assert server.answers(bytes(one).ljust(8, b'\0'))[0][0] != 0x80
    assert code(server.answers(bytes(wrong).ljust(8, b'\0'))[0]) == expected
    assert code(server.answers(bytes([0xA3]) + bytes(7))[0]) == 0x05040001
