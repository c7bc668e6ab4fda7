"""MIT-mode frames: coding, enabling, the tick of several motors, faults and capacity."""

from collections.abc import Iterator
from contextlib import contextmanager, ExitStack
import struct
import uuid

import can
from hypothesis import given, strategies as st
import isa_ros
from isa_ros.core.signals import COMMAND
from isa_ros.errors import ConfigError
from isa_ros.fieldbus.canopen.mit_frames import (
    answer_frame, command_of, DISABLE, ENABLE, MotorAnswer, MotorCommand, Range, Ranges, SET_ZERO,
    special_of)
from isa_ros.fieldbus.canopen.mit_line import mit_line, MitLine
from isa_ros.fieldbus.device.devices import devices_of
import numpy as np
import pytest
from tests.fieldbus.canopen.mit_master import answer_of, command_frame, special_frame
from tests.fieldbus.canopen.toy import ToyDrive
from tests.fieldbus.canopen.virtual_bus import STEP_NS

RANGES = Ranges(Range(-0.065535, 0.065535), Range(-0.5, 0.5), Range(0.0, 4095.0),
                Range(0.0, 40.95), Range(-1023.75, 1023.75))
REST = MotorCommand(0.0, 0.0, 0.0, 0.0, 0.0)
HALF_STEP = 1.001e-6    # m: of 2 * 0.065535 m in 65535 steps, and the rounding of a float
PUSH = REST._replace(effort=100.25)


class Master:
    """Commands to motors, and their answers."""

    def __init__(self, line: MitLine, toys: list[ToyDrive], bus: can.BusABC) -> None:
        self.line, self.toys, self._bus = line, toys, bus

    def send(self, identifier: int, data: bytes) -> list[tuple[int, bytes]]:
        """Send a frame, simulate a tick if one begins, and return the answers."""
        self._bus.send(can.Message(
            arbitration_id=identifier, data=data, is_extended_id=False))
        while self.line.serve(0.0):
            for toy in self.toys:
                toy.tick()
            self.line.update()
        answers = []
        while (message := self._bus.recv(0.0)) is not None:
            answers.append((message.arbitration_id, bytes(message.data)))
        return answers

    def command(self, motor: int, command: MotorCommand) -> MotorAnswer:
        """Command a motor and return its answer."""
        (identifier, data), = self.send(motor, command_frame(command, RANGES))
        assert identifier == 0
        return answer_of(data, RANGES)


@contextmanager
def motors(*toys: ToyDrive) -> Iterator[Master]:
    channel = uuid.uuid4().hex
    bus = can.Bus(interface='virtual', channel=channel)
    line = mit_line(toys, 'virtual', channel, STEP_NS)
    try:
        yield Master(line, list(toys), bus)
    finally:
        line.close()
        bus.shutdown()


def number(one: Range) -> st.SearchStrategy[float]:
    return st.floats(one.low, one.high)


@given(st.builds(MotorCommand, *map(number, RANGES)))
def test_a_command_keeps_its_numbers_within_half_a_step(command):
    decoded = command_of(command_frame(command, RANGES), RANGES)
    for value, back, (low, high), bits in zip(command, decoded, RANGES, (16, 12, 12, 12, 12),
                                              strict=True):
        half = (high - low) / ((1 << bits) - 1) / 2
        assert abs(back - value) <= half * (1 + 1e-9)   # rounding of the division


def test_the_bits_are_those_of_the_published_frame():
    """Position 0x1234, velocity 0x567, stiffness 0x89A, damping 0xBCD, effort 0xEF0."""
    ranges = Ranges(Range(0, 0xFFFF), *[Range(0, 0xFFF)] * 4)
    command, answer = MotorCommand(0x1234, 0x567, 0x89A, 0xBCD, 0xEF0), MotorAnswer(
        5, 0x1234, 0x567, 0x89A)
    assert command_frame(command, ranges) == bytes.fromhex('123456789abcdef0')
    assert answer_frame(answer, ranges) == bytes.fromhex('05123456789a')


def test_numbers_beyond_their_range_saturate():
    far = MotorCommand(9.0, -9.0, 1e6, -1.0, 1e6)
    assert command_of(command_frame(far, RANGES), RANGES) == (
        RANGES.position.high, RANGES.velocity.low, RANGES.stiffness.high, 0.0, RANGES.effort.high)


def test_special_frames_are_no_commands():
    assert special_of(special_frame(ENABLE)) == 0xFC
    assert special_frame(SET_ZERO).hex() == 'fffffffffffffffe'
    assert special_of(b'\xff' * 8) is None


def test_a_motor_is_enabled_state_by_state_and_pushes():
    toy = ToyDrive()
    with motors(toy) as master:
        master.command(1, PUSH)
        assert (toy.ticks, toy.is_wanted) == (1, False)
        (_, data), = master.send(1, special_frame(ENABLE))
        assert data[0] == 1 and toy.is_operational and toy.ticks == 1
        for state in ('ready', 'switched on', 'enabled'):
            master.command(1, PUSH)
            assert toy.state == state
        efforts = [master.command(1, PUSH).effort for _ in range(2)]
        # rounded by the toy; of 0.5 N a step in a frame, with no code for 0
        assert efforts == [pytest.approx(100.0, abs=0.25), pytest.approx(100.0, abs=0.25)]
        master.send(1, special_frame(DISABLE))
        master.command(1, PUSH)
        assert toy.state == 'disabled'


def test_an_answer_has_the_state_before_the_tick_of_its_command():
    toy = ToyDrive()
    with motors(toy) as master:
        toy.position = 2000
        assert master.command(1, REST).position == pytest.approx(0.0, abs=HALF_STEP)
        assert master.command(1, REST).position == pytest.approx(2e-3, abs=HALF_STEP)


def test_a_tick_begins_when_all_motors_have_a_command():
    toys = ToyDrive('hfe'), ToyDrive('kfe')
    with motors(*toys) as master:
        master.command(1, REST)
        assert toys[0].ticks == 0
        master.command(2, REST)
        assert [toy.ticks for toy in toys] == [1, 1]


def test_a_second_command_begins_the_tick_without_the_others():
    toys = ToyDrive('hfe'), ToyDrive('kfe')
    with motors(*toys) as master:
        master.command(1, REST)
        toys[0].position = 4000
        answer = master.command(1, REST)
        assert toys[0].ticks == 1
        assert answer.position == pytest.approx(4e-3, abs=HALF_STEP)   # after that tick
        master.command(2, REST)
        assert toys[0].ticks == 2


def test_set_zero_moves_the_frames_and_not_the_drive():
    toy = ToyDrive()
    with motors(toy) as master:
        toy.position = 30_000
        master.command(1, REST)
        master.send(1, special_frame(SET_ZERO))
        assert master.command(1, REST).position == pytest.approx(0.0, abs=HALF_STEP)
        master.send(1, special_frame(ENABLE))
        master.command(1, REST._replace(position=1e-3))
        assert toy.values[0x607A, 0] == pytest.approx(31_000, abs=1)
        assert toy.position == 30_000


def test_a_fault_switches_off_until_the_next_enable():
    toy = ToyDrive(fault_at=6)
    with motors(toy) as master:
        master.send(1, special_frame(ENABLE))
        for _ in range(10):
            master.command(1, PUSH)
        assert toy.state == 'fault'
        master.send(1, special_frame(ENABLE))
        for _ in range(4):
            master.command(1, PUSH)
        assert toy.state == 'enabled'


def test_a_missed_bus_is_lost_once_and_needs_an_enable():
    toy = ToyDrive()
    with motors(toy) as master:
        master.line.miss()
        assert toy.ended_lost == []
        master.send(1, special_frame(ENABLE))
        master.line.miss()
        master.line.miss()
        assert toy.ended_lost == [True]
        assert not master.line.motors[1].is_on


def test_ranges_are_objects_and_may_be_changed():
    toy = ToyDrive()
    with motors(toy) as master:
        (identifier, answer), = master.send(0x601, b'\x40\x02\x20\x05\0\0\0\0')
        assert identifier == 0x581
        assert struct.unpack('<f', answer[4:]) == (1023.75,)
        master.send(0x601, b'\x23\x02\x20\x05' + struct.pack('<f', 10.0))
        assert master.line.motors[1].ranges.effort == (-10.0, 10.0)


@pytest.mark.parametrize(('identifier', 'data'), [(1, b'\0' * 7), (2, b'\0' * 8), (0x80, b'')])
def test_other_frames_are_ignored(identifier, data):
    toy = ToyDrive()
    with motors(toy) as master:
        assert master.send(identifier, data) == []
        assert toy.ticks == 0


def test_four_motors_fit_in_a_millisecond_and_five_do_not():
    with motors(*(ToyDrive(str(k)) for k in range(4))):
        pass
    with pytest.raises(ConfigError, match='5 actuators .* need .* = 12.. bit a tick'):
        mit_line([ToyDrive(str(k)) for k in range(5)], 'virtual', 'mit', STEP_NS)


def test_an_actuator_without_impedance_is_no_motor():
    run = isa_ros.load('rig_linear').configuration
    with pytest.raises(ConfigError, match='has no impedance mode'):
        mit_line(devices_of(run, 'cia408'), 'virtual', 'mit', STEP_NS)


@pytest.mark.parametrize('answer_id', [1, -1, 0x800])
def test_answers_are_no_commands(answer_id):
    with pytest.raises(ConfigError, match=f'answer_id = {answer_id}: must be 0 to 2047'):
        mit_line([ToyDrive()], 'virtual', 'mit', STEP_NS, answer_id=answer_id)


def test_a_real_actuator_follows_a_motor_command():
    """A position 2 mm away, reached within 0.2 mm (12 bit of stiffness) in 0.3 s."""
    with ExitStack() as stack:
        simulation = isa_ros.load('rig_linear').simulation()
        device, = devices_of(simulation.scenario.run)
        commands = np.zeros(1, COMMAND)
        channel = uuid.uuid4().hex
        bus = stack.enter_context(can.Bus(interface='virtual', channel=channel))
        line = mit_line([device], 'virtual', channel, STEP_NS)
        stack.callback(line.close)
        device.take_sample(simulation.group.samples[0], 0)
        ranges = line.motors[1].ranges
        start = float(simulation.group.samples[0]['position'])
        stiffness, damping = (struct.unpack('<f', device.read(0x2010, k))[0] for k in (1, 2))
        frame = command_frame(MotorCommand(start + 2e-3, 0.0, stiffness, damping, 0.0), ranges)
        bus.send(can.Message(arbitration_id=1, data=special_frame(ENABLE), is_extended_id=False))
        for k in range(300):
            bus.send(can.Message(arbitration_id=1, data=frame, is_extended_id=False))
            assert line.serve(0.0)
            device.fill_command(commands[0])
            simulation.step(commands)
            device.take_sample(simulation.group.samples[0], k + 1)
            line.update()
        position = float(simulation.group.samples[0]['position'])
        assert abs(position - start - 2e-3) < 2e-4
