"""SDO transfers by bytes written by hand: expedited, normal, segmented, complete, aborted."""

import struct

from isa_ros.fieldbus.device import abort
import pytest
from tests.fieldbus.ethercat.raw_master import OP, RawMaster
from tests.fieldbus.toys import LONG_TEXT

ROOM, SEGMENT = 240, 247
"""Bytes of data in a normal transfer and in a segment of a mailbox of 256."""


def aborted(answer: bytes) -> int:
    """Return the code of an abort: service 2, command 0x80."""
    assert answer[:3] == b'\x00\x20\x80'
    return struct.unpack_from('<I', answer, 6)[0]


def refused_upload(master: RawMaster, index: int, subindex: int, flags: int = 0) -> int:
    """Return the code by which an upload is refused; its abort names the object."""
    answer = master.ask(struct.pack('<HBHBI', 0x2000, 0x40 | flags, index, subindex, 0))
    assert struct.unpack_from('<HB', answer, 3) == (index, subindex)
    return aborted(answer)


def download(master: RawMaster, index: int, subindex: int, data: bytes, flags: int = 0) -> bytes:
    """Send a download that fits into one mail; return the answer."""
    if len(data) <= 4:
        command = 0x23 | (4 - len(data)) << 2 | flags
        return master.ask(
            struct.pack('<HBHB', 0x2000, command, index, subindex) + data.ljust(4, b'\0'))
    return master.ask(struct.pack('<HBHBI', 0x2000, 0x21 | flags, index, subindex, len(data))
                      + data)


@pytest.mark.parametrize(('index', 'subindex', 'command', 'data'), [
    (0x1000, 0, 0x43, b'\x92\x01\x02\x00'), (0x1018, 0, 0x4F, b'\x04'),
    (0x1C12, 1, 0x4B, b'\x00\x16')])
def test_up_to_four_bytes_are_expedited(master, index, subindex, command, data):
    assert master.upload(index, subindex) == struct.pack(
        '<BHB', command, index, subindex) + data.ljust(4, b'\0')


def test_more_bytes_are_sent_behind_their_number(master):
    assert master.upload(0x1018, 0, 0x10) == struct.pack('<BHBI', 0x51, 0x1018, 0, 18) + (
        struct.pack('<HIIII', 4, 0xBAD, 1, 1, 1))


def segments(master: RawMaster) -> bytes:
    """Upload all segments; return the data."""
    found, toggle = b'', 0
    while True:
        answer = master.ask(struct.pack('<HB', 0x2000, 0x60 | toggle).ljust(10, b'\0'))
        assert answer[:2] == b'\x00\x30' and answer[2] & 0xF0 == toggle
        unused = answer[2] >> 1 & 7
        found += answer[3:len(answer) - unused]
        if answer[2] & 1:
            return found
        toggle ^= 0x10


def test_what_fits_into_no_mail_comes_in_segments(master):
    assert master.upload(0x2001, 0) == struct.pack('<BHBI', 0x41, 0x2001, 0, len(LONG_TEXT))
    assert segments(master) == LONG_TEXT.encode()


@pytest.mark.parametrize('size', [
    ROOM, ROOM + 1, SEGMENT, SEGMENT + 1, SEGMENT + 7, SEGMENT + 8, 2 * SEGMENT, 600])
def test_every_length_comes_back_whole(master, size):
    text = (LONG_TEXT * 2)[:size].encode()
    assert write_long(master, text)[:3] in (b'\x00\x30\x60', b'\x00\x30\x20', b'\x00\x30\x30')
    answer = master.upload(0x2001, 0)
    assert struct.unpack_from('<I', answer, 4)[0] == size
    assert (answer[8:] if size <= ROOM else segments(master)) == text


def write_long(master: RawMaster, data: bytes, size: int | None = None) -> bytes:
    """Download in segments behind a first part; return the last answer."""
    answer = master.ask(struct.pack(
        '<HBHBI', 0x2000, 0x21, 0x2001, 0, len(data) if size is None else size) + data[:ROOM])
    data, toggle = data[ROOM:], 0
    while data and answer[2] != 0x80:
        part, data = data[:SEGMENT], data[SEGMENT:]
        unused = max(0, 7 - len(part))
        command = toggle | unused << 1 | (0 if data else 1)
        answer = master.ask(struct.pack('<HB', 0x2000, command) + part.ljust(7, b'\0'))
        assert answer[2] in (0x20 | toggle, 0x80)
        toggle ^= 0x10
    return answer


def test_a_download_is_written(master):
    assert download(master, 0x2000, 0, struct.pack('<f', 2.5)) == struct.pack(
        '<HBHBI', 0x3000, 0x60, 0x2000, 0, 0)
    assert master.toys[0].read(0x2000, 0) == struct.pack('<f', 2.5)


def test_an_expedited_download_without_a_size_has_four_bytes(master):
    master.ask(struct.pack('<HBHBf', 0x2000, 0x22, 0x2000, 0, -1.0))
    assert master.toys[0].read(0x2000, 0) == struct.pack('<f', -1.0)


def test_segments_that_do_not_make_the_announced_size_are_refused(master):
    text = b'x' * 600
    assert aborted(write_long(master, text, 700)) == abort.TOO_SHORT
    assert aborted(write_long(master, text, 500)) == abort.TOO_LONG
    assert aborted(write_long(master, text, 2**31)) == abort.OUT_OF_MEMORY


def test_a_toggle_bit_that_does_not_alternate_ends_the_transfer(master):
    master.upload(0x2001, 0)
    again = struct.pack('<HB', 0x2000, 0x60).ljust(10, b'\0')
    master.ask(again)
    assert aborted(master.ask(again)) == abort.TOGGLE_BIT
    assert aborted(master.ask(again)) == abort.UNKNOWN_COMMAND


def test_a_segment_without_a_transfer_is_refused(master):
    assert aborted(master.ask(struct.pack('<HB', 0x2000, 0x60).ljust(10, b'\0'))) == (
        abort.UNKNOWN_COMMAND)
    assert aborted(master.ask(struct.pack('<HB', 0x2000, 0x01).ljust(10, b'\0'))) == (
        abort.UNKNOWN_COMMAND)


def test_the_master_can_end_a_transfer(master):
    master.upload(0x2001, 0)
    assert master.post(struct.pack('<HBHBI', 0x2000, 0x80, 0x2001, 0, abort.GENERAL)) == 1
    assert master.fetch() is None
    assert aborted(master.ask(struct.pack('<HB', 0x2000, 0x60).ljust(10, b'\0'))) == (
        abort.UNKNOWN_COMMAND)


def test_an_unknown_command_is_refused(master):
    answer = master.ask(struct.pack('<HBHBI', 0x2000, 0xC0, 0x1000, 0, 0))
    assert aborted(answer) == abort.UNKNOWN_COMMAND


def test_an_object_is_read_and_written_whole(master):
    """Subindex 0 as 16 bit; from subindex 1 on it is left out."""
    whole = master.upload(0x1C12, 0, 0x10)
    assert whole[:4] == struct.pack('<BHB', 0x53, 0x1C12, 0) and whole[4:] == b'\x01\0\x00\x16'
    assert master.upload(0x1C12, 1, 0x10) == struct.pack('<BHB', 0x5B, 0x1C12, 1) + b'\0\x16\0\0'
    assert download(master, 0x1C12, 0, b'\x00\0', 0x10)[2] == 0x70
    assert master.toys[0].assigned(0x1C12) == []
    assert download(master, 0x1C12, 0, b'\x01\0\x00\x16', 0x10)[2] == 0x70
    assert master.toys[0].assigned(0x1C12) == [0x1600]
    assert download(master, 0x1600, 1, struct.pack('<II', 0x60400010, 0x607A0020), 0x10)[2] == 0x70


@pytest.mark.parametrize(('index', 'subindex', 'flags', 'code'), [
    (0x9999, 0, 0, abort.NO_OBJECT), (0x1018, 9, 0, abort.NO_SUBINDEX),
    (0x2002, 0, 0, abort.WRITE_ONLY), (0x1000, 0, 0x10, abort.NO_COMPLETE_ACCESS),
    (0x1018, 2, 0x10, abort.UNSUPPORTED_ACCESS)])
def test_an_upload_is_refused_by_its_code(master, index, subindex, flags, code):
    assert refused_upload(master, index, subindex, flags) == code


@pytest.mark.parametrize(('index', 'data', 'flags', 'code'), [
    (0x9999, b'\0', 0, abort.NO_OBJECT), (0x1000, b'\0\0\0\0', 0, abort.READ_ONLY),
    (0x2000, b'\0\0', 0, abort.TOO_SHORT), (0x2000, bytes(8), 0, abort.TOO_LONG),
    (0x1018, bytes(18), 0x10, abort.READ_ONLY)])
def test_a_download_is_refused_by_its_code(master, index, data, flags, code):
    assert aborted(download(master, index, 0, data, flags)) == code


def test_mappings_are_written_in_preop_only():
    master = RawMaster()
    master.bring_up(OP)
    assert aborted(download(master, 0x1C12, 0, b'\0')) == abort.WRONG_STATE
    assert download(master, 0x2000, 0, struct.pack('<f', 1.0))[2] == 0x60
