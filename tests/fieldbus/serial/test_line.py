"""The serial line: a request is a tick; objects, wrong checks, capacity, the pseudo terminal."""

from collections.abc import Iterator
from contextlib import contextmanager
import os
from pathlib import Path
import random
import struct
import termios
import tty

from isa_ros.errors import ConfigError, RunError
from isa_ros.fieldbus.serial.frame import (
    ANSWERED, FrameReader, OBJECT, packed, PROCESS_DATA, READ, SerialFrame, STATUS, WRITE)
from isa_ros.fieldbus.serial.line import serial_line, SerialLine
import pytest
from tests.fieldbus.canopen.toy import STATUS as STATES
from tests.fieldbus.canopen.toy import ToyDrive

STEP_NS = 1_000_000


class Master:
    """Requests over the terminal, and their answers."""

    def __init__(self, line: SerialLine, toys: list[ToyDrive], handle: int) -> None:
        self.line, self.toys, self.handle = line, toys, handle
        self._reader = FrameReader()

    def send(self, data: bytes) -> None:
        """Send bytes, and simulate the ticks that they begin."""
        os.write(self.handle, data)
        while self.line.serve(0.0):
            for toy in self.toys:
                toy.tick()
            self.line.update()

    def received(self) -> SerialFrame | None:
        """Return the next answer, None without any."""
        try:
            self._reader.feed(os.read(self.handle, 65536))
        except BlockingIOError:
            pass
        return self._reader.take()

    def ask(self, kind: int, content: bytes, number: int = 0) -> tuple[int, bytes]:
        """Return abort code and data of the answer to a request."""
        self.send(packed(SerialFrame(kind, number, content)))
        answer = self.received()
        assert answer is not None and answer[:2] == (kind | ANSWERED, number)
        return STATUS.unpack_from(answer.content)[0], answer.content[STATUS.size:]


@contextmanager
def serial_master(path: Path, *toys: ToyDrive) -> Iterator[Master]:
    line = serial_line(toys, path, 0, STEP_NS)
    handle = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    try:
        yield Master(line, list(toys), handle)
    finally:
        os.close(handle)
        line.close()


@pytest.fixture
def toys() -> list[ToyDrive]:
    return [ToyDrive('hfe'), ToyDrive('kfe')]


@pytest.fixture
def master(tmp_path: Path, toys: list[ToyDrive]) -> Iterator[Master]:
    with serial_master(tmp_path / 'line', *toys) as one:
        yield one


def setpoints(word: int, torque: int) -> bytes:
    """Return 0x1600 and 0x1601 of a toy."""
    return struct.pack('<Hbhii', word, 10, torque, 0, 0)


def test_a_request_is_a_tick_of_all_and_is_answered_with_the_state_after_it(master, toys):
    for word in (6, 7, 15):
        code, data = master.ask(PROCESS_DATA, setpoints(word, 100) + setpoints(word, -50))
        assert code == 0
    assert [toy.ticks for toy in toys] == [3, 3]
    states = [struct.unpack_from('<Hbhii', data, 13 * k) for k in range(2)]
    assert states == [(STATES['enabled'], 10, 100, toys[0].position, toys[0].velocity),
                      (STATES['enabled'], 10, -50, toys[1].position, toys[1].velocity)]
    assert all(toy.is_operational for toy in toys)


@pytest.mark.parametrize('content', [b'', setpoints(6, 0), setpoints(6, 0) * 3])
def test_process_data_of_another_length_are_refused_and_no_tick(master, toys, content):
    assert master.ask(PROCESS_DATA, content) == (0x06070010, b'')
    assert toys[0].ticks == 0


def test_a_wrong_check_is_ignored_and_counted(master, toys):
    request = packed(SerialFrame(PROCESS_DATA, 0, setpoints(6, 0) * 2))
    master.send(request[:-1] + bytes([request[-1] ^ 1]))
    assert master.received() is None
    assert (toys[0].ticks, master.line.discarded) == (0, 1)
    master.send(request)
    answer = master.received()
    assert answer is not None and STATUS.unpack_from(answer.content) == (0, 1)


def test_a_request_is_answered_once_however_often_samples_are_new(master):
    assert master.ask(PROCESS_DATA, setpoints(6, 0) * 2)[0] == 0
    master.line.update()
    assert master.received() is None


def test_objects_are_read_and_written_without_a_tick(master, toys):
    assert master.ask(WRITE, OBJECT.pack(1, 0x2010, 1) + struct.pack('<f', 2.5)) == (0, b'')
    assert toys[1].values[0x2010, 1] == 2.5 and toys[0].values[0x2010, 1] == 0.0
    assert master.ask(READ, OBJECT.pack(1, 0x2010, 1)) == (0, struct.pack('<f', 2.5))
    assert master.ask(READ, OBJECT.pack(0, 0x1008, 0)) == (0, b'hfe')
    assert toys[0].ticks == 0


@pytest.mark.parametrize(('kind', 'content', 'code'), [
    (READ, OBJECT.pack(0, 0x1234, 0), 0x06020000), (READ, OBJECT.pack(2, 0x1000, 0), 0x05040001),
    (WRITE, OBJECT.pack(0, 0x6041, 0) + b'\0\0', 0x06010002), (READ, b'\0', 0x06070010),
    (0x55, b'', 0x05040001)])
def test_what_is_refused_is_answered_by_its_code(master, kind, content, code):
    assert master.ask(kind, content) == (code, b'')


def test_mappings_change_before_the_operation_only(master):
    assert master.ask(WRITE, OBJECT.pack(0, 0x1A00, 0) + b'\x02') == (0, b'')
    _, data = master.ask(PROCESS_DATA, setpoints(6, 0) * 2)
    assert len(data) == 2 * 13 - 2
    assert master.ask(WRITE, OBJECT.pack(0, 0x1A00, 0) + b'\x01')[0] == 0x08000022


def test_a_missed_line_is_lost_until_the_next_request(master, toys):
    master.line.miss()
    assert toys[0].ended_lost == []
    master.ask(PROCESS_DATA, setpoints(6, 0) * 2)
    master.line.miss()
    assert toys[0].ended_lost == [True]
    master.ask(PROCESS_DATA, setpoints(6, 0) * 2)
    assert toys[0].is_operational


def test_noise_and_halves_leave_the_line_working(master, toys):
    request = packed(SerialFrame(PROCESS_DATA, 0, setpoints(6, 0) * 2))
    master.send(b'\x49\x53\x01' + b'noise' * 10 + request[:10])
    master.send(request[10:])
    assert toys[0].ticks == 1
    assert master.ask(PROCESS_DATA, setpoints(6, 0) * 2)[0] == 0


def test_answers_that_nobody_reads_do_not_stop_the_line(master, toys):
    request = packed(SerialFrame(PROCESS_DATA, 0, setpoints(6, 0) * 2))
    for _ in range(500):
        master.send(request)
    assert toys[0].ticks == 500
    assert master.line.port.unsent > 0


def test_a_master_may_leave_and_come_back(tmp_path):
    toy = ToyDrive()
    with serial_master(tmp_path / 'line', toy) as master:
        other = os.open(tmp_path / 'line', os.O_RDWR | os.O_NOCTTY)
        os.close(other)
        assert master.ask(PROCESS_DATA, setpoints(6, 0))[0] == 0


def test_the_link_to_the_terminal_ends_with_the_line(tmp_path):
    path = tmp_path / 'line'
    with serial_master(path, ToyDrive()):
        assert path.is_symlink()
    assert not path.is_symlink()


def test_the_link_of_a_killed_run_is_replaced(tmp_path):
    path = tmp_path / 'line'
    path.symlink_to(tmp_path / 'gone')
    with serial_master(path, ToyDrive()) as master:
        assert master.ask(READ, OBJECT.pack(0, 0x1008, 0)) == (0, b'kfe')


def test_a_file_in_the_way_is_not_touched(tmp_path):
    path = tmp_path / 'line'
    path.write_text('mine')
    with pytest.raises(ConfigError, match='exists and is no serial device'):
        serial_line([ToyDrive()], path, 0, STEP_NS)
    assert path.read_text() == 'mine'


def test_a_folder_that_is_missing_is_one_line(tmp_path):
    with pytest.raises(ConfigError, match='cannot be opened: .*No such file'):
        serial_line([ToyDrive()], tmp_path / 'none' / 'line', 0, STEP_NS)


def test_a_device_that_is_no_terminal_is_one_line():
    with pytest.raises(ConfigError) as refused:
        serial_line([ToyDrive()], '/dev/null', 0, STEP_NS)
    assert str(refused.value) == 'serial line /dev/null: is no serial device'


def test_a_serial_device_has_its_rate_set(tmp_path):
    own, device = os.openpty()
    tty.setraw(device)
    name = os.ttyname(device)
    line = serial_line([ToyDrive()], name, 1_000_000, STEP_NS)
    assert termios.tcgetattr(device)[4:6] == [termios.B1000000] * 2
    with pytest.raises(ConfigError, match=f'{name}: another program uses it'):
        serial_line([ToyDrive()], name, 1_000_000, STEP_NS)
    line.close()
    with pytest.raises(ConfigError, match='baud = 1234567 is no rate of it; one of 50, 75'):
        serial_line([ToyDrive()], name, 1_234_567, STEP_NS)
    line = serial_line([ToyDrive()], name, 1_000_000, STEP_NS)
    os.close(own)
    os.close(device)
    with pytest.raises(RunError, match='is lost'):
        line.serve(0.0)
    line.close()


def test_frames_that_the_line_does_not_carry_are_refused_with_the_arithmetic(tmp_path):
    """Request 8 + 26 bytes, answer 8 + 6 + 26 bytes, 2 turns, 10 bit each."""
    toys = [ToyDrive('hfe'), ToyDrive('kfe')]
    with pytest.raises(ConfigError) as refused:
        serial_line(toys, tmp_path / 'line', 500_000, STEP_NS)
    assert str(refused.value) == (
        'baud = 500000, must be >= 760000: 2 actuators (hfe, kfe) need 10 x (request 34 + answer '
        '40 + turns 2) = 760 bit a tick, 500000 baud carries 500 bit in 1 ms')
    serial_line(toys, tmp_path / 'line', 760_000, STEP_NS).close()


def test_of_altered_requests_the_whole_ones_are_ticks_and_no_others(master, toys):
    draw = random.Random(5)
    true = [packed(SerialFrame(kind, 1, content)) for kind, content in (
        (PROCESS_DATA, setpoints(15, 20) * 2), (READ, OBJECT.pack(0, 0x1008, 0)),
        (WRITE, OBJECT.pack(1, 0x2010, 1) + bytes(4)))]
    whole = 0
    for _ in range(1500):
        sent = draw.choice(true)
        data = bytearray(sent)
        for _ in range(draw.choice((0, 1, 2))):
            data[draw.randrange(len(data))] = draw.randrange(256)
        del data[draw.choice((len(data), len(data), draw.randrange(len(data)))):]
        master.send(bytes(data))
        master.received()
        whole += data == true[0]
    assert toys[0].ticks == whole > 50
    assert master.line.discarded > 500
    while master.received():
        pass
    assert master.ask(PROCESS_DATA, setpoints(6, 0) * 2)[0] == 0
