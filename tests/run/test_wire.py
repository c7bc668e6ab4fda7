"""The private wire: what is encoded is decoded, and is what the message type says."""

from hypothesis import given, strategies
from isa_ros.core.signals import START
from isa_ros.errors import RunError
from isa_ros.run import wire
from isa_ros.run.exchange import Rows
import numpy as np
import pytest
from rclpy.serialization import deserialize_message
from std_msgs.msg import UInt8MultiArray

RUN_IDS = strategies.integers(1, 2**63)
TICKS = strategies.integers(0, 2**62)


def rows(dtype: np.dtype, n: int) -> np.ndarray:
    """Return rows whose bytes all differ."""
    return np.frombuffer(bytes(k % 251 for k in range(n * dtype.itemsize)), dtype).copy()


def filled(n: int) -> Rows:
    """Return an exchange of ``n`` actuators whose bytes all differ."""
    made = Rows(n)
    for name in ('ports', 'commands', 'samples'):
        getattr(made, name)[:] = rows(getattr(made, name).dtype, n)
    made.shared[:] = rows(made.shared.dtype, 1)
    return made


@given(RUN_IDS, TICKS, strategies.integers(0, 12), strategies.booleans())
def test_step_round_trip(run_id, tick, n, has_controllers):
    """Every row of every record type arrives bit for bit, NaN included."""
    sent = filled(n)
    step = wire.decode_step(wire.encode_tick(run_id, tick, sent, has_controllers))
    assert (step.kind, step.run_id, step.tick) == (wire.StepKind.TICK, run_id, tick)
    for k in range(n):
        assert step.port(k).tobytes() == sent.ports[k].tobytes()
        assert step.command(k).tobytes() == sent.commands[k].tobytes()
    if has_controllers:
        assert step.samples().tobytes() == sent.samples.tobytes()
        assert step.shared().tobytes() == sent.shared.tobytes()


@given(strategies.lists(strategies.binary(max_size=300), min_size=1))
def test_restore_round_trip(snapshots):
    step = wire.decode_step(wire.encode_restore(5, -2, 9, snapshots))
    assert (step.kind, step.tick, step.restored_tick()) == (wire.StepKind.RESTORE, -2, 9)
    assert [step.snapshot(k) for k in range(len(snapshots))] == snapshots


def test_hello_round_trip():
    """More names than actuators: a controller takes part without a row."""
    starts = rows(START, 2)
    step = wire.decode_step(wire.encode_hello(
        7, 3, 2_000_000, starts, ['haa', 'kfe', 'controller']))
    assert (step.kind, step.run_id, step.tick) == (wire.StepKind.HELLO, 7, 3)
    assert step.names() == ['haa', 'kfe', 'controller']
    assert (step.rows, step.step_ns()) == (2, 2_000_000)
    assert step.start(1).tobytes() == starts[1].tobytes()


@given(RUN_IDS, TICKS, strategies.lists(strategies.none() | strategies.binary(max_size=300)),
       strategies.booleans())
def test_answer_round_trip(run_id, tick, parts, is_repeated):
    """An absent part stays different from an empty one."""
    data = wire.encode_answer(wire.AnswerKind.DONE, run_id, tick, 2, parts, is_repeated)
    assert wire.decode_answer(data) == wire.Answer(
        wire.AnswerKind.DONE, run_id, tick, 2, parts, is_repeated)


@pytest.mark.parametrize('data', [
    wire.encode_end(5),
    wire.encode_begin(5),
    wire.encode_save(5, -1),
    wire.encode_tick(5, 1, filled(3), True),
    wire.encode_answer(wire.AnswerKind.DONE, 5, 1, 0, [b'abc', None])])
def test_bytes_are_a_uint8_multi_array(data):
    """The prepared bytes are what rclpy would decode: prefix, then the array's length."""
    message = deserialize_message(data, UInt8MultiArray)
    assert list(message.layout.dim) == []
    assert message.layout.data_offset == 0
    assert bytes(message.data) == data[16:]


@pytest.mark.parametrize(('decode', 'data'), [
    (wire.decode_step, wire.encode_end(5)),
    (wire.decode_answer, wire.encode_answer(wire.AnswerKind.BUSY, 5, 1, 0, ()))])
def test_another_version_is_refused(decode, data):
    with pytest.raises(RunError, match='wire version 9'):
        decode(data[:16] + b'\x09' + data[17:])
