"""The private wire: what is encoded is decoded, and is what the message type says."""

from collections.abc import Mapping

from hypothesis import given, strategies
from isa_ros.core.signals import COMMAND, LOAD_REPLY, SAMPLE, START
from isa_ros.errors import RunError
from isa_ros.run.wire.answers import Answer, AnswerKind, decode_answer, encode_answer
from isa_ros.run.wire.header import WireError
from isa_ros.run.wire.parts import actuator_parts, take_actuator_parts
from isa_ros.run.wire.roster import Roster
from isa_ros.run.wire.steps import (
    decode_step, encode_begin, encode_change, encode_end, encode_hello, encode_restore,
    encode_save, encode_tick, StepKind)
from isa_ros.surroundings.bodies.leg.port_kernel import LEG_SAMPLE
import numpy as np
import pytest
from rclpy.serialization import deserialize_message
from std_msgs.msg import UInt8MultiArray
from tests.run.filled import filled, LEG, rows

RUN_IDS = strategies.integers(1, 2**63)
TICKS = strategies.integers(0, 2**62)
_ROWS = 20  # byte of a step's number of participants: after prefix, version and kind
TWO = {'leg': LEG_SAMPLE, 'cart': np.dtype([('height', '<f8')])}
BODIES = strategies.sampled_from([{}, LEG, TWO])


def roster(n_supplies: int = 1, bodies: Mapping[str, np.dtype] = LEG) -> Roster:
    """Return who takes part beside ``n_supplies`` supplies and some bodies."""
    return Roster(
        ['haa', 'kfe', 'controller'], [f'supply_{k}' for k in range(n_supplies)], bodies)


@given(RUN_IDS, TICKS, strategies.integers(0, 12))
def test_step_round_trip(run_id, tick, n):
    """Every row of every record type arrives bit for bit, NaN included."""
    sent = filled(n)
    step = decode_step(encode_tick(run_id, tick, sent, has_controllers=False))
    assert (step.kind, step.run_id, step.tick) == (StepKind.TICK, run_id, tick)
    for k in range(n):
        assert step.port(k).tobytes() == sent.ports[k].tobytes()
        assert step.command(k).tobytes() == sent.commands[k].tobytes()


@given(strategies.integers(0, 5), strategies.integers(1, 3), BODIES)
def test_controllers_are_shown_samples_supplies_and_bodies(n, n_supplies, bodies):
    """In one step with the rows of the actuators; nothing is applied there."""
    sent = filled(n, n_supplies, bodies)
    step = decode_step(encode_tick(1, 2, sent, has_controllers=True))
    shown = step.state(roster(n_supplies, bodies))
    assert shown.samples.tobytes() == sent.samples.tobytes()
    assert shown.supplies.tobytes() == sent.supplies.tobytes()
    assert list(shown.bodies) == list(bodies)
    for name, sample in shown.bodies.items():
        assert sample.dtype == bodies[name] and sample.tobytes() == sent.bodies[name].tobytes()
    assert shown.applied['kinds'].tolist() == [0] * n
    assert [step.port(k).tobytes() for k in range(n)] == [port.tobytes() for port in sent.ports]


def test_without_controllers_nothing_is_shown():
    """A tick is as short as its ports and commands."""
    alone = filled(2)
    size = alone.ports.nbytes + alone.commands.nbytes
    shown = alone.samples.nbytes + alone.supplies.nbytes + alone.bodies['leg'].nbytes
    assert len(decode_step(encode_tick(1, 2, alone, False)).body) == size
    assert len(decode_step(encode_tick(1, 2, alone, True)).body) == size + shown


@given(strategies.lists(strategies.binary(max_size=300), min_size=1))
def test_restore_round_trip(snapshots):
    step = decode_step(encode_restore(5, -2, 9, snapshots))
    assert (step.kind, step.tick, step.restored_tick()) == (StepKind.RESTORE, -2, 9)
    assert [step.snapshot(k) for k in range(len(snapshots))] == snapshots


@given(strategies.dictionaries(strategies.integers(0, 3), strategies.dictionaries(
    strategies.sampled_from(('force.kp', 'plant.spool.stuck', 'reu.frozen')),
    strategies.floats(allow_nan=False, allow_infinity=False), max_size=3), max_size=4))
def test_change_round_trip(changes):
    """Each participant finds its own values, and those without any none."""
    step = decode_step(encode_change(5, -3, changes, 4))
    assert (step.kind, step.tick, step.rows) == (StepKind.CHANGE, -3, 4)
    assert [step.changes(k) for k in range(4)] == [changes.get(k, {}) for k in range(4)]
    with pytest.raises(WireError, match='changes of 4 participants, must be of 3'):
        step.refuse_change(3)


@pytest.mark.parametrize('value', [float('nan'), float('inf')])
def test_a_change_to_no_finite_number_is_refused(value):
    with pytest.raises(WireError, match='parameters that are not finite numbers'):
        decode_step(encode_change(5, -3, {0: {'reu.frozen': value}}, 1))


@pytest.mark.parametrize('bodies', [{}, LEG, TWO])
def test_hello_round_trip(bodies):
    """More names than actuators: a controller takes part without a row."""
    starts, everyone = rows(START, 2), roster(2, bodies)
    step = decode_step(encode_hello(7, 3, 2_000_000, starts, everyone))
    assert (step.kind, step.run_id, step.tick) == (StepKind.HELLO, 7, 3)
    assert step.roster() == everyone
    assert (step.rows, step.step_ns()) == (2, 2_000_000)
    assert step.start(1).tobytes() == starts[1].tobytes()


@pytest.mark.parametrize('tuned', [{}, {'force.kp': 1e-7, 'force.kf': 1.0 / 3.0}])
def test_the_parts_of_an_actuator_fill_its_row_alone(tuned):
    """Its three rows bit for bit, and the parameters that changed; what others said stays."""
    reply, sample, applied = rows(LOAD_REPLY, 1), rows(SAMPLE, 1), rows(COMMAND, 1)
    parts = actuator_parts(reply, sample, applied, tuned)
    taken = filled(3)
    before = taken.samples.tobytes()
    taken.tuned = {0: {'spool.kp': 2.0}}
    answer = decode_answer(encode_answer(AnswerKind.DONE, 1, 2, 1, parts))
    take_actuator_parts(answer.parts, 1, taken)
    assert taken.replies[1].tobytes() == reply.tobytes()
    assert taken.samples[1].tobytes() == sample.tobytes()
    assert taken.applied[1].tobytes() == applied.tobytes()
    assert taken.tuned == {0: {'spool.kp': 2.0}} | ({1: tuned} if tuned else {})
    size = SAMPLE.itemsize
    for k in (0, 2):
        assert taken.samples[k].tobytes() == before[k * size:(k + 1) * size]
        assert not taken.replies[k].tobytes().strip(b'\0')
        assert not taken.applied[k].tobytes().strip(b'\0')


@given(RUN_IDS, TICKS, strategies.lists(strategies.none() | strategies.binary(max_size=300)),
       strategies.booleans())
def test_answer_round_trip(run_id, tick, parts, is_repeated):
    """An absent part stays different from an empty one."""
    data = encode_answer(AnswerKind.DONE, run_id, tick, 2, parts, is_repeated)
    assert decode_answer(data) == Answer(
        AnswerKind.DONE, run_id, tick, 2, parts, is_repeated)


@pytest.mark.parametrize('data', [
    encode_end(5),
    encode_begin(5, [b'node', None]),
    encode_save(5, -1),
    encode_tick(5, 1, filled(3), True),
    encode_answer(AnswerKind.DONE, 5, 1, 0, [b'abc', None])])
def test_bytes_are_a_uint8_multi_array(data):
    """The prepared bytes are what rclpy would decode: prefix, then the array's length."""
    message = deserialize_message(data, UInt8MultiArray)
    assert list(message.layout.dim) == []
    assert message.layout.data_offset == 0
    assert bytes(message.data) == data[16:]


@pytest.mark.parametrize('participants', [1, 3])
def test_a_begin_whose_parts_are_not_its_bytes_is_refused(participants):
    """Of two participants, and said to be of fewer or more."""
    step = encode_begin(5, [b'node', None])
    assert step[_ROWS:_ROWS + 4] == (2).to_bytes(4, 'little')
    with pytest.raises(WireError, match='parts'):
        decode_step(step[:_ROWS] + participants.to_bytes(4, 'little') + step[_ROWS + 4:])


@pytest.mark.parametrize(('decode', 'data'), [
    (decode_step, encode_end(5)),
    (decode_answer, encode_answer(AnswerKind.BUSY, 5, 1, 0, ()))])
def test_another_version_is_refused(decode, data):
    with pytest.raises(RunError, match='wire version = 11, must be 10'):
        decode(data[:16] + b'\x0b' + data[17:])
