"""The SDO server: expedited, segmented and block transfers, and each abort code."""

from binascii import crc_hqx

import canopen
from hypothesis import example, given, strategies as st
from isa_ros.fieldbus.canopen import sdo
from isa_ros.fieldbus.canopen.sdo import MOST_BYTES
from isa_ros.fieldbus.device.abort import NO_OBJECT, SdoAbort
import pytest

NUMBER, TEXT = (0x2000, 1), (0x2001, 0)


class SdoServer(sdo.SdoServer):
    """A server of which every answer is one frame or none."""

    def answer(self, data: bytes) -> bytes | None:
        frames = self.answers(data)
        assert len(frames) <= 1
        return frames[0] if frames else None


class Values:
    """A dictionary of a number of 4 bytes and a text."""

    def __init__(self) -> None:
        self.content = {NUMBER: b'\x01\x02\x03\x04', TEXT: b''}

    def read(self, index: int, subindex: int) -> bytes:
        self.size(index, subindex)
        return self.content[index, subindex]

    def write(self, index: int, subindex: int, data: bytes) -> None:
        self.size(index, subindex)
        self.content[index, subindex] = data

    def size(self, index: int, subindex: int) -> int:
        if (index, subindex) not in self.content:
            raise SdoAbort(NO_OBJECT)
        return 4 if (index, subindex) == NUMBER else 0


def request(command: int, key: tuple[int, int], data: bytes = b'') -> bytes:
    index, subindex = key
    return (bytes([command]) + index.to_bytes(2, 'little') + bytes([subindex]) + data).ljust(
        8, b'\0')


def uploaded(server: SdoServer, key: tuple[int, int]) -> bytes:
    """Read an object as a client does; each answer has the toggle bit of its request."""
    answer = server.answer(request(0x40, key))
    if answer[0] & 2:
        return answer[4:8 - (answer[0] >> 2 & 3)]
    size, data, toggle = int.from_bytes(answer[4:], 'little'), b'', 0
    while True:
        answer = server.answer(bytes([0x60 | toggle]) + bytes(7))
        assert answer[0] & 0xF0 == toggle
        data += answer[1:8 - (answer[0] >> 1 & 7)]
        toggle ^= 0x10
        if answer[0] & 1:
            assert len(data) == size
            return data


def downloaded(server: SdoServer, key: tuple[int, int], data: bytes, announced: int) -> bytes:
    """Write an object in segments; return the last answer."""
    answer = server.answer(request(0x21, key, announced.to_bytes(4, 'little')))
    toggle = 0
    while answer[0] != 0x80:
        part, data = data[:7], data[7:]
        command = toggle | 7 - len(part) << 1 | (0 if data else 1)
        answer = server.answer(bytes([command]) + part.ljust(7, b'\0'))
        toggle ^= 0x10
        if not data:
            break
    return answer


def code(answer: bytes | None) -> int:
    assert answer is not None and answer[0] == 0x80
    return int.from_bytes(answer[4:], 'little')


@given(st.binary(max_size=60))
def test_what_is_written_in_segments_is_read_back(data):
    values = Values()
    server = SdoServer(values)
    answer = downloaded(server, TEXT, data, len(data))
    assert answer[0] >> 5 == 1
    assert values.content[TEXT] == data
    assert uploaded(server, TEXT) == data


@pytest.mark.parametrize('size', [1, 2, 3, 4])
def test_up_to_four_bytes_are_one_frame(size):
    server = SdoServer(Values())
    command = 0x23 | 4 - size << 2
    assert server.answer(request(command, TEXT, b'abcd')) == request(0x60, TEXT)
    assert uploaded(server, TEXT) == b'abcd'[:size]


def test_an_expedited_download_without_size_has_that_of_the_type():
    values = Values()
    SdoServer(values).answer(request(0x22, NUMBER, b'wxyz'))
    assert values.content[NUMBER] == b'wxyz'


@pytest.mark.parametrize('data', [b'', b'\x40', bytes(7), bytes(9)])
def test_a_frame_of_other_than_eight_bytes_is_no_request(data):
    assert SdoServer(Values()).answer(data) is None


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


def test_another_request_begins_anew():
    values = Values()
    values.content[TEXT] = bytes(100)
    server = sdo.SdoServer(values)
    for begin in ([0x80], [0x40, 0, 0x20, 1], [0x23, 0, 0x20, 1, 1, 2, 3, 4]):
        server.answers(request(0xA4, TEXT, bytes([5, 0])))
        server.answers(bytes(begin).ljust(8, b'\0'))
        assert code(server.answers(bytes([0xA3]) + bytes(7))[0]) == 0x05040001


def test_a_finished_upload_cannot_be_continued():
    values = Values()
    values.content[TEXT] = b'twelve bytes'
    for toggle in (0x60, 0x70):
        server = SdoServer(values)
        assert uploaded(server, TEXT) == b'twelve bytes'
        assert code(server.answer(bytes([toggle]) + bytes(7))) == 0x05040001


@pytest.mark.parametrize(('begin', 'segment'), [(0x40, 0x01), (0x21, 0x60)])
def test_a_segment_of_the_other_direction_ends_the_transfer(begin, segment):
    """0x40 begins to read a text of 20 bytes, 0x21 to write one."""
    values = Values()
    values.content[TEXT] = bytes(20)
    server = SdoServer(values)
    server.answer(request(begin, TEXT, (20).to_bytes(4, 'little')))
    assert code(server.answer(bytes([segment]) + b'written')) == 0x05040001
    assert values.content[TEXT] == bytes(20)
    assert code(server.answer(bytes([0x60]) + bytes(7))) == 0x05040001


@pytest.mark.parametrize('command', [0x00, 0x60, 0x71])
def test_a_segment_without_a_transfer_is_refused(command):
    assert code(SdoServer(Values()).answer(bytes([command]) + bytes(7))) == 0x05040001


def test_a_segment_with_the_same_toggle_bit_is_refused_and_ends_the_transfer():
    values = Values()
    server = SdoServer(values)
    server.answer(request(0x21, TEXT, (20).to_bytes(4, 'little')))
    server.answer(b'\x00abcdefg')
    assert code(server.answer(b'\x00abcdefg')) == 0x05030000
    assert code(server.answer(b'\x10abcdefg')) == 0x05040001
    assert values.content[TEXT] == b''


@pytest.mark.parametrize(('announced', 'expected'), [(3, 0x06070012), (30, 0x06070013)])
def test_another_length_than_announced_is_refused(announced, expected):
    values = Values()
    assert code(downloaded(SdoServer(values), TEXT, b'0123456789', announced)) == expected
    assert values.content[TEXT] == b''


def test_a_value_that_is_too_long_is_refused_before_and_while_it_is_sent():
    server = SdoServer(Values())
    assert code(server.answer(
        request(0x21, TEXT, (MOST_BYTES + 1).to_bytes(4, 'little')))) == 0x05040005
    answer = server.answer(request(0x20, TEXT))
    toggle, sent = 0, 0
    while answer[0] != 0x80:
        answer = server.answer(bytes([toggle]) + bytes(7))
        toggle, sent = toggle ^ 0x10, sent + 7
    assert code(answer) == 0x05040005
    assert MOST_BYTES < sent <= MOST_BYTES + 7


def test_an_abort_of_the_client_ends_the_transfer_without_an_answer():
    server = SdoServer(Values())
    server.answer(request(0x21, TEXT))
    assert server.answer(request(0x80, TEXT)) is None
    assert code(server.answer(bytes(8))) == 0x05040001


def test_what_the_dictionary_refuses_is_aborted_with_its_object():
    answer = SdoServer(Values()).answer(request(0x40, (0x1234, 5)))
    assert answer == bytes([0x80, 0x34, 0x12, 5]) + (0x06020000).to_bytes(4, 'little')
    answer = downloaded(SdoServer(Values()), (0x1234, 5), b'12345', 5)
    assert code(answer) == 0x06020000
