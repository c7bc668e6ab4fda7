"""
What crosses a `Link`: a step of the coordinator, an answer of a worker.

The contents of a run's own wire without its care for strangers: the load port and command of
every actuator down, the load reply, sample and serialised messages of one actuator up. Little
endian, unpadded. That wire itself lives beside rclpy, which no peer needs.
"""

from enum import IntEnum
import struct
from typing import NamedTuple

from isa_ros.core.signals import COMMAND, LOAD_PORT, LOAD_REPLY, SAMPLE, START
from isa_ros.run.exchange import Messages, Records
import numpy as np

_STEP = struct.Struct('<IIq')       # kind, rows, tick
_ANSWER = struct.Struct('<IIq')     # worker, messages, tick
_ABSENT = 0xFFFFFFFF                # length of a message that is None


class Kind(IntEnum):
    """What the coordinator wants."""

    START = 1
    """Start at t = 0; ``tick`` counts these steps down from -1."""
    TICK = 2
    END = 3


class Step(NamedTuple):
    """One message of the coordinator."""

    kind: Kind
    tick: int
    rows: int
    body: bytes

    def start(self, index: int) -> np.void:
        """Return the `START` row of one actuator."""
        return _row(self.body, START, index * START.itemsize)

    def port(self, index: int) -> np.void:
        """Return the `LOAD_PORT` row of one actuator."""
        return _row(self.body, LOAD_PORT, index * LOAD_PORT.itemsize)

    def command(self, index: int) -> np.void:
        """Return the `COMMAND` row of one actuator."""
        return _row(
            self.body, COMMAND, self.rows * LOAD_PORT.itemsize + index * COMMAND.itemsize)


class Answer(NamedTuple):
    """One message of a worker."""

    worker: int
    tick: int
    reply: np.void
    """A `LOAD_REPLY`."""
    sample: np.void
    """A `SAMPLE`."""
    messages: Messages


def encode_start(count: int, starts: Records) -> bytes:
    """Return the ``count``-th start, with the `START` rows of all actuators, (n,)."""
    return _STEP.pack(Kind.START, len(starts), -count) + starts.tobytes()


def encode_tick(tick: int, ports: Records, commands: Records) -> bytes:
    """Return one tick: `LOAD_PORT` and `COMMAND` of every actuator, (n,) each."""
    return _STEP.pack(Kind.TICK, len(ports), tick) + ports.tobytes() + commands.tobytes()


def encode_end() -> bytes:
    """Return the end of a run."""
    return _STEP.pack(Kind.END, 0, 0)


def decode_step(data: bytes) -> Step:
    """Return a step from its bytes."""
    kind, rows, tick = _STEP.unpack_from(data)
    return Step(Kind(kind), tick, rows, data[_STEP.size:])


def encode_answer(
        worker: int, tick: int, reply: np.void, sample: np.void, messages: Messages) -> bytes:
    """Return the answer of one worker to the step of ``tick``."""
    n = len(messages)
    lengths = struct.pack(f'<{n}I', *(_ABSENT if m is None else len(m) for m in messages))
    return b''.join((
        _ANSWER.pack(worker, n, tick), reply.tobytes(), sample.tobytes(), lengths,
        *(message for message in messages if message is not None)))


def decode_answer(data: bytes) -> Answer:
    """Return an answer from its bytes."""
    worker, n, tick = _ANSWER.unpack_from(data)
    sample_at = _ANSWER.size + LOAD_REPLY.itemsize
    lengths_at = sample_at + SAMPLE.itemsize
    at = lengths_at + 4 * n
    messages: list[bytes | None] = []
    for length in struct.unpack_from(f'<{n}I', data, lengths_at):
        if length == _ABSENT:
            messages.append(None)
            continue
        messages.append(data[at:at + length])
        at += length
    return Answer(
        worker, tick, _row(data, LOAD_REPLY, _ANSWER.size), _row(data, SAMPLE, sample_at),
        messages)


def _row(data: bytes, dtype: np.dtype[np.void], offset: int) -> np.void:
    row: np.void = np.frombuffer(data, dtype, 1, offset)[0]
    return row
