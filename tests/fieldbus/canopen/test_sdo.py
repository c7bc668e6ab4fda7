"""The SDO server: expedited, segmented and block transfers, and each abort code."""

from hypothesis import given, strategies as st
from isa_ros.fieldbus.canopen import sdo
from isa_ros.fieldbus.canopen.sdo import MOST_BYTES
import pytest
from tests.fieldbus.canopen.sdo_requests import (
    code, downloaded, NUMBER, request, SdoServer, TEXT, uploaded, Values)


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
