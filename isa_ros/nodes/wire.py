"""
The private wire of the lockstep: one step to all, one acknowledgement from each.

Both travel as std_msgs/UInt8MultiArray whose bytes are made here, without rclpy's encoder:
the 16 bytes in front of the array are fixed but for its length. Every message carries the
run's id, so that two coordinators in one domain can tell their messages apart. Little
endian, unpadded; the layout is an implementation detail of one version of this package,
and ``WIRE_VERSION`` is refused where it differs.
"""

from collections.abc import Sequence
from enum import IntEnum
import struct
from typing import NamedTuple

from isa_ros.coordinator import Records
from isa_ros.errors import RunError
from isa_ros.signals import COMMAND, LOAD_PORT
from isa_ros.stepping import START
import numpy as np

STEP_TOPIC = '/_isa/step'
ACKNOWLEDGEMENT_TOPIC = '/_isa/acknowledgement'
WIRE_VERSION = 1

_ENCAPSULATION = 0x00000100  # bytes 00 01 00 00: little endian CDR, no options
_PREFIX = struct.Struct('<IIII')  # encapsulation, no dimensions, data_offset, array length
_STEP = struct.Struct('<HHIQq')  # version, kind, rows, run id, tick
_ACKNOWLEDGEMENT = struct.Struct('<HHIIIQq')  # version, kind, index, parts, -, run id, tick
_ABSENT = 0xFFFFFFFF  # length of a part that is None

DIVERGENCE = struct.Struct('<qd')
"""First part of a `DIVERGED` answer: t_ns, value."""

_STEP_START = _PREFIX.size + _STEP.size
_PARTS_START = _PREFIX.size + _ACKNOWLEDGEMENT.size


class StepKind(IntEnum):
    """What the coordinator wants."""

    HELLO = 1
    """Answer if your name is listed, and start over at t = 0; ``tick`` counts the hellos."""
    TICK = 2
    END = 3
    """The run is over; the next hello may begin another."""


class AnswerKind(IntEnum):
    """What a participant answers."""

    READY = 1
    """To a hello: identity, digest, then the messages of t = 0."""
    DONE = 2
    """To a tick: the load reply, then the messages of its end."""
    DIVERGED = 3
    """To a tick: t_ns and value, then the field that is no longer finite."""
    BUSY = 4
    """To a hello: this participant is in another run."""
    REFUSED = 5
    """To a tick: the reason why it cannot be done."""
    UNBOUND = 6
    """To the first tick of a run that never called this participant: its name."""


class Step(NamedTuple):
    """One message of the coordinator."""

    kind: StepKind
    run_id: int
    tick: int
    rows: int
    body: bytes

    def names(self) -> list[str]:
        """Return the participants that a hello calls, in order."""
        return self.body[self.rows * START.itemsize:].decode().split('\n')

    def start(self, index: int) -> np.void:
        """Return the `START` row of one actuator."""
        row: np.void = np.frombuffer(self.body, START, 1, index * START.itemsize)[0]
        return row

    def port(self, index: int) -> np.void:
        """Return the `LOAD_PORT` row of one actuator."""
        row: np.void = np.frombuffer(
            self.body, LOAD_PORT, 1, index * LOAD_PORT.itemsize)[0]
        return row

    def command(self, index: int) -> np.void:
        """Return the `COMMAND` row of one actuator."""
        offset = self.rows * LOAD_PORT.itemsize + index * COMMAND.itemsize
        row: np.void = np.frombuffer(self.body, COMMAND, 1, offset)[0]
        return row


class Answer(NamedTuple):
    """One message of a participant."""

    kind: AnswerKind
    run_id: int
    tick: int
    participant: int
    """Its place in the hello's names."""
    parts: list[bytes | None]


def encode_hello(run_id: int, count: int, starts: Records, names: Sequence[str]) -> bytes:
    """
    Return the bytes of the ``count``-th hello.

    ``starts`` are the `START` rows of the actuators, (n,); ``names`` all participants, the
    actuators first.
    """
    return _step(
        StepKind.HELLO, run_id, count, len(starts),
        starts.tobytes() + '\n'.join(names).encode())


def encode_tick(run_id: int, tick: int, ports: Records, commands: Records) -> bytes:
    """Return the bytes of one tick: `LOAD_PORT` and `COMMAND` of every actuator, (n,) each."""
    return _step(
        StepKind.TICK, run_id, tick, len(ports), ports.tobytes() + commands.tobytes())


def encode_end(run_id: int) -> bytes:
    """Return the bytes that end a run."""
    return _step(StepKind.END, run_id, 0, 0, b'')


def _step(kind: StepKind, run_id: int, tick: int, rows: int, body: bytes) -> bytes:
    return (_PREFIX.pack(_ENCAPSULATION, 0, 0, _STEP.size + len(body))
            + _STEP.pack(WIRE_VERSION, kind, rows, run_id, tick) + body)


def decode_step(data: bytes) -> Step:
    """
    Return the message of a coordinator.

    Raises
    ------
    RunError
        It is of another version of this package.

    """
    version, kind, rows, run_id, tick = _STEP.unpack_from(data, _PREFIX.size)
    _check_version(version)
    end = _PREFIX.size + _PREFIX.unpack_from(data)[3]
    return Step(StepKind(kind), run_id, tick, rows, data[_STEP_START:end])


def encode_answer(
        kind: AnswerKind, run_id: int, tick: int, index: int,
        parts: Sequence[bytes | None]) -> bytes:
    """Return the bytes of an answer; a part that is None stays None."""
    n = len(parts)
    present = [part for part in parts if part is not None]
    lengths = struct.pack(f'<{n}I', *(_ABSENT if p is None else len(p) for p in parts))
    size = _ACKNOWLEDGEMENT.size + len(lengths) + sum(map(len, present))
    return b''.join((
        _PREFIX.pack(_ENCAPSULATION, 0, 0, size),
        _ACKNOWLEDGEMENT.pack(WIRE_VERSION, kind, index, n, 0, run_id, tick),
        lengths, *present))


def decode_answer(data: bytes) -> Answer:
    """
    Return the message of a participant.

    Raises
    ------
    RunError
        It is of another version of this package.

    """
    version, kind, index, n, _, run_id, tick = _ACKNOWLEDGEMENT.unpack_from(data, _PREFIX.size)
    _check_version(version)
    parts: list[bytes | None] = []
    start = _PARTS_START + 4 * n
    for length in struct.unpack_from(f'<{n}I', data, _PARTS_START):
        if length == _ABSENT:
            parts.append(None)
            continue
        parts.append(data[start:start + length])
        start += length
    return Answer(AnswerKind(kind), run_id, tick, index, parts)


def _check_version(version: int) -> None:
    if version != WIRE_VERSION:
        raise RunError(
            f'lockstep wire version {version} met, this isa_ros speaks {WIRE_VERSION}: '
            'coordinator and participants must be of one installation')
