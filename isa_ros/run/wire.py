"""
Private wire of the lockstep: per tick, one step message to all and one answer from each.

Both are sent as std_msgs/UInt8MultiArray whose bytes are made here, without rclpy's encoder:
the 16 bytes before the array are fixed except for its length. Every message has the run's id,
so that messages of two coordinators in one domain are not mixed up. Little endian, unpadded;
the layout is an implementation detail of one version of this package, and a message with
another ``WIRE_VERSION`` is refused.
"""

from collections.abc import Mapping, Sequence
from enum import IntEnum
from functools import cache
import json
import struct
from typing import NamedTuple

from isa_ros.core.signals import COMMAND, LOAD_PORT, LOAD_REPLY, Records, SAMPLE, START
from isa_ros.errors import RunError
from isa_ros.run.exchange import Rows
from isa_ros.run.packing import Shown
from isa_ros.surroundings.supply import SUPPLY_SAMPLE
import numpy as np

STEP_TOPIC = '/_isa/step'
ACKNOWLEDGEMENT_TOPIC = '/_isa/acknowledgement'
WIRE_VERSION = 4

_ENCAPSULATION = 0x00000100  # bytes 00 01 00 00: little endian CDR, no options
_PREFIX = struct.Struct('<IIII')  # encapsulation, no dimensions, data_offset, array length
_STEP = struct.Struct('<IIIIHHIQq')  # prefix; version, kind, rows, run id, tick
_ACKNOWLEDGEMENT = struct.Struct('<IIIIHHIIIQq')
"""Prefix; version, kind, index, number of parts, is_repeated, run id, tick."""

_NUMBER = struct.Struct('<q')
_ABSENT = 0xFFFFFFFF  # length of a part that is None

DIVERGENCE = struct.Struct('<qd')
"""First part of a `DIVERGED` answer: t_ns, value."""

_COUNT = 4  # bytes of a length


class StepKind(IntEnum):
    """Kinds of messages from the coordinator."""

    HELLO = 1
    """Call of the listed participants: answer and start at t = 0; ``tick`` counts the hellos."""
    TICK = 2
    END = 3
    """The run has ended; the next hello may begin another."""
    BEGIN = 4
    """Publish the first messages: all participants are ready and `/clock` is published. Sent again
    while the run continues without ticks on the topic. Not answered."""
    SAVE = 5
    """Answer with the complete state before the next tick; ``tick`` is a number below 0, different
    for each request, so that answers can be assigned to their request."""
    RESTORE = 6
    """Continue from the state before the tick given in the body; ``tick`` as in a save."""


class AnswerKind(IntEnum):
    """Kinds of answers of a participant."""

    READY = 1
    """To a hello: identity, digest, then the parts of the participant's role at t = 0."""
    DONE = 2
    """To a tick: the parts of the participant's role at the tick's end."""
    DIVERGED = 3
    """To a tick: t_ns and value, then the name of the field that is no longer finite."""
    BUSY = 4
    """To a hello: this participant takes part in another run."""
    REFUSED = 5
    """To a tick, a save or a restore: the reason of its failure."""
    UNBOUND = 6
    """To the first message of a run that has not called this participant: its name."""
    SAVED = 7
    """To a save: the complete state."""
    RESTORED = 8
    """To a restore: the parts of the participant's role at that instant."""


# Calling an enumeration takes about a microsecond per tick; a dictionary a twentieth of it.
_STEP_KINDS = {int(kind): kind for kind in StepKind}
_ANSWER_KINDS = {int(kind): kind for kind in AnswerKind}


class Cast(NamedTuple):
    """The participants of a run, and the supplies and body whose samples controllers receive."""

    names: Sequence[str]
    """The participants in order: the actuators first, then the controllers."""
    supplies: Sequence[str]
    body: np.dtype[np.void] | None
    """Record type of the body's sample; None: no body."""

    def encode(self) -> bytes:
        """Return the bytes that `decode` reads."""
        body = None if self.body is None else [
            [name, self.body[name].base.str, self.body[name].shape]
            for name in self.body.names or ()]
        return json.dumps([list(self.names), list(self.supplies), body]).encode()

    @classmethod
    def decode(cls, data: bytes) -> 'Cast':
        """Return the cast from its bytes."""
        names, supplies, body = json.loads(data)
        record = None if body is None else np.dtype(
            [(name, format_, tuple(shape)) for name, format_, shape in body])
        return cls(names, supplies, record)


class Step(NamedTuple):
    """One message of the coordinator."""

    kind: StepKind
    run_id: int
    tick: int
    rows: int
    body: bytes

    def cast(self) -> Cast:
        """Return the participants that a hello calls: ``rows`` actuators first."""
        return Cast.decode(self.body[_NUMBER.size + self.rows * START.itemsize:])

    def step_ns(self) -> int:
        """Return the length of a tick from a hello."""
        return int(_NUMBER.unpack_from(self.body)[0])

    def start(self, index: int) -> np.void:
        """Return the `START` row of one actuator."""
        return self._row(START, _NUMBER.size + index * START.itemsize)

    def port(self, index: int) -> np.void:
        """Return the `LOAD_PORT` row of one actuator."""
        return self._row(LOAD_PORT, index * LOAD_PORT.itemsize)

    def command(self, index: int) -> np.void:
        """Return the `COMMAND` row of one actuator."""
        return self._row(COMMAND, self.rows * LOAD_PORT.itemsize + index * COMMAND.itemsize)

    def shown(self, cast: Cast) -> Shown:
        """Return the rows that controllers receive: the state before a tick, nothing applied."""
        at = self.rows * (LOAD_PORT.itemsize + COMMAND.itemsize)
        samples = np.frombuffer(self.body, SAMPLE, self.rows, at)
        at += samples.nbytes
        supplies = np.frombuffer(self.body, SUPPLY_SAMPLE, len(cast.supplies), at)
        at += supplies.nbytes
        body = None if cast.body is None else np.frombuffer(self.body, cast.body, 1, at)
        return Shown(samples, np.zeros(self.rows, COMMAND), supplies, body)

    def _row(self, record: np.dtype[np.void], offset: int) -> np.void:
        row: np.void = np.frombuffer(self.body, record, 1, offset)[0]
        return row

    def restored_tick(self) -> int:
        """Return the tick before which a restored run continues."""
        return int(_NUMBER.unpack_from(self.body)[0])

    def snapshot(self, index: int) -> bytes:
        """Return the state from which one participant continues."""
        own = _split(self.body, self.rows, _NUMBER.size)[index]
        assert own is not None
        return own


class Answer(NamedTuple):
    """One message of a participant."""

    kind: AnswerKind
    run_id: int
    tick: int
    participant: int
    """Index into the names of the hello."""
    parts: list[bytes | None]
    is_repeated: bool
    """Whether the step had been answered before."""


def encode_hello(
        run_id: int, count: int, step_ns: int, starts: Records, cast: Cast) -> bytes:
    """Return the bytes of the ``count``-th hello; ``starts`` are the actuators' `START`, (n,)."""
    return _step(
        StepKind.HELLO, run_id, count, len(starts),
        _NUMBER.pack(step_ns) + starts.tobytes() + cast.encode())


def encode_tick(run_id: int, tick: int, rows: Rows, has_controllers: bool) -> bytes:
    """Return the bytes of one tick: ports and commands, for controllers also the samples."""
    body = rows.ports.tobytes() + rows.commands.tobytes()
    if has_controllers:
        body += rows.samples.tobytes() + rows.supplies.tobytes()
        body += b'' if rows.body is None else rows.body.tobytes()
    return _step(StepKind.TICK, run_id, tick, len(rows.ports), body)


def encode_begin(run_id: int) -> bytes:
    """Return the bytes of a begin; see `StepKind.BEGIN`."""
    return _step(StepKind.BEGIN, run_id, 0, 0, b'')


def encode_save(run_id: int, number: int) -> bytes:
    """Return the bytes that request the state before the next tick; see `StepKind.SAVE`."""
    return _step(StepKind.SAVE, run_id, number, 0, b'')


def encode_restore(run_id: int, number: int, tick: int, snapshots: Sequence[bytes]) -> bytes:
    """Return the bytes that restore every participant before ``tick``; see `StepKind.RESTORE`."""
    body = _NUMBER.pack(tick) + _join(snapshots)
    return _step(StepKind.RESTORE, run_id, number, len(snapshots), body)


def encode_end(run_id: int) -> bytes:
    """Return the bytes that end a run."""
    return _step(StepKind.END, run_id, 0, 0, b'')


def _step(kind: StepKind, run_id: int, tick: int, rows: int, body: bytes) -> bytes:
    return _STEP.pack(
        _ENCAPSULATION, 0, 0, _STEP.size - _PREFIX.size + len(body),
        WIRE_VERSION, kind, rows, run_id, tick) + body


def decode_step(data: bytes) -> Step:
    """
    Return the message of a coordinator from its bytes.

    Raises
    ------
    RunError
        The message is from another version of this package.

    """
    _, _, _, size, version, kind, rows, run_id, tick = _STEP.unpack_from(data)
    _check_version(version)
    return Step(_STEP_KINDS[kind], run_id, tick, rows, data[_STEP.size:_PREFIX.size + size])


def encode_answer(
        kind: AnswerKind, run_id: int, tick: int, index: int,
        parts: Sequence[bytes | None], is_repeated: bool = False) -> bytes:
    """Return the bytes of an answer; a part that is None stays None."""
    body = _join(parts)
    return _ACKNOWLEDGEMENT.pack(
        _ENCAPSULATION, 0, 0, _ACKNOWLEDGEMENT.size - _PREFIX.size + len(body),
        WIRE_VERSION, kind, index, len(parts), is_repeated, run_id, tick) + body


def decode_answer(data: bytes) -> Answer:
    """
    Return the message of a participant from its bytes.

    Raises
    ------
    RunError
        The message is from another version of this package.

    """
    _, _, _, _, version, kind, index, n, is_repeated, run_id, tick = (
        _ACKNOWLEDGEMENT.unpack_from(data))
    _check_version(version)
    parts = _split(data, n, _ACKNOWLEDGEMENT.size)
    return Answer(_ANSWER_KINDS[kind], run_id, tick, index, parts, bool(is_repeated))


def actuator_parts(
        reply: Records, sample: Records, applied: Records,
        tuned: Mapping[str, float]) -> list[bytes | None]:
    """
    Return the parts of an actuator's answer: its rows, and the parameters that changed.

    ``reply``, ``sample`` and ``applied`` are its `LOAD_REPLY`, `SAMPLE` and `COMMAND`, (1,).
    """
    return [reply.tobytes() + sample.tobytes() + applied.tobytes(),
            json.dumps(dict(tuned)).encode() if tuned else None]


def take_actuator_parts(parts: Sequence[bytes | None], row: int, rows: Rows) -> None:
    """Fill one row from the parts of an actuator's answer; inverse of `actuator_parts`."""
    data, tuned = parts
    assert data is not None
    sample_at = LOAD_REPLY.itemsize
    applied_at = sample_at + SAMPLE.itemsize
    rows.reply_values[row] = np.frombuffer(data, np.float64, sample_at // 8)
    rows.sample_values[row] = np.frombuffer(data, np.float64, SAMPLE.itemsize // 8, sample_at)
    rows.applied[row] = np.frombuffer(data, COMMAND, 1, applied_at)[0]
    if tuned is not None:
        rows.tuned = {**rows.tuned, row: json.loads(tuned)}


def _join(parts: Sequence[bytes | None]) -> bytes:
    """Return the lengths of all parts, followed by the parts that are not None."""
    lengths = [_ABSENT if part is None else len(part) for part in parts]
    return b''.join((_counts(len(parts)).pack(*lengths), *filter(None, parts)))


def _split(data: bytes, n: int, offset: int) -> list[bytes | None]:
    """Return the ``n`` parts that begin at ``offset``; inverse of `_join`."""
    parts: list[bytes | None] = []
    start = offset + _COUNT * n
    for length in _counts(n).unpack_from(data, offset):
        if length == _ABSENT:
            parts.append(None)
            continue
        parts.append(data[start:start + length])
        start += length
    return parts


@cache
def _counts(n: int) -> struct.Struct:
    return struct.Struct(f'<{n}I')


def _check_version(version: int) -> None:
    if version != WIRE_VERSION:
        raise RunError(
            f'lockstep wire version = {version}, must be {WIRE_VERSION}: coordinator and '
            'participants must be of the same version of isa_ros')
