"""
The coordinator's end of the wire, compiled: a step to all sockets, an answer from each actuator.

Answers are taken if they differ by their numbers only from those that `encode_answer` makes of a
tick without changed parameters. All others, and what has arrived before them, are left to Python.
"""

from collections.abc import Sequence
from typing import NamedTuple

from isa_ros.actuator.rows import row_record
from isa_ros.core.bound import Bound
from isa_ros.core.kernel import kernel
from isa_ros.core.record import float_columns
from isa_ros.core.signals import (
    COMMAND, EVERY_KIND, LOAD_REPLY, Records, SAMPLE, SUPPLY_REPLY, WAS_REFUSED)
from isa_ros.core.system_calls import (
    AT_ONCE, copy_memory, receive, send, system_calls, SystemCalls)
from isa_ros.run.wire import steps
from isa_ros.run.wire.answers import AnswerKind, encode_answer
from isa_ros.run.wire.parts import actuator_parts, is_valid_command, PARTS
from isa_ros.run.wire.steps import encode_tick, parts_of_tick
from isa_ros.run.wire.words import (
    ANSWER_HEAD, are_finite, begins_with, copy_words, STEP_HEAD, WORD, words_of, write_tick)
from isa_ros.tick.exchange import Rows
import numpy as np

_COMMAND = COMMAND.itemsize // WORD
_APPLIED_KINDS = EVERY_KIND | WAS_REFUSED
_APART = 1024   # bytes between two messages, so that they do not share lines of a cache

ROUND = np.dtype([
    ('tick', 'i8'),
    ('step', 'i8'),         # address and bytes of the step
    ('step_bytes', 'i8'),
    ('answers', 'i8'),      # address of the memory for answers
    ('largest', 'i8'),      # bytes of a message
    ('first', 'i8'),        # place of a message in its memory, and of the rows in that, words
    ('rows', 'i8'),
    ('feed', 'i8'),         # whether the supplies of the run have ports
    ('sizes', 'i8', (2,)),  # of an answer without and with a sent command, bytes
])

_TICK = float_columns(ROUND)['tick']


class Round(NamedTuple):
    """Memory of the exchange of n actuators; messages and rows are words."""

    this: np.ndarray
    """`ROUND`, (1,)."""
    system: SystemCalls
    step: np.ndarray
    """The step."""
    sources: np.ndarray
    """Address in the step, address and bytes of what is copied to there, (m, 3)."""
    sockets: np.ndarray
    """Their numbers, those of the actuators first."""
    heads: np.ndarray
    """How both answers of each begin, (n, 2, words)."""
    answers: np.ndarray
    """What has arrived from each, (n, words)."""
    values: np.ndarray
    """The same memory as floats."""
    received: np.ndarray
    """Bytes of it, (n,); 0: nothing yet."""
    checked: np.ndarray
    """A `COMMAND`, (1,), and the same as words."""
    checked_words: np.ndarray
    replies: np.ndarray
    """Rows of the run: `LOAD_REPLY`, `SAMPLE`, applied and sent `COMMAND`, `SUPPLY_REPLY`."""
    samples: np.ndarray
    applied: np.ndarray
    sent: np.ndarray
    fed: np.ndarray


@kernel
def send_step(own):
    """Send the step of the tick to all; return 1 + the place of a socket that failed, or 0."""
    this = own.this[0]
    write_tick(this.tick, own.step, STEP_HEAD)
    for k in range(len(own.sources)):
        copy_memory(own.system, own.sources[k, 0], own.sources[k, 1], own.sources[k, 2])
    for k in range(len(own.sockets)):
        if send(own.system, own.sockets[k], this.step, this.step_bytes, AT_ONCE) < 0:
            return k + 1
    return 0


@kernel
def is_command(at, k, known, own):
    """Return whether a command of the answer of actuator ``k`` is valid."""
    copy_words(own.answers[k], at, own.checked_words, 0, _COMMAND)
    return is_valid_command(own.checked[0], known)


@kernel
def is_answer(k, own):
    """Return whether an answer of actuator ``k`` to the tick can be taken."""
    this, n = own.this[0], len(own.received)
    message = own.answers[k, this.first:]
    is_sent = -1
    for form in range(2):
        write_tick(this.tick, own.heads[k, form], ANSWER_HEAD)
        if own.received[k] == this.sizes[form] and begins_with(own.heads[k, form], message):
            is_sent = form
    if is_sent < 0:
        return False
    at = this.first + this.rows
    numbers = (len(own.replies) + len(own.samples)) // n
    if not are_finite(own.values[k], at // 2, numbers // 2):
        return False
    at += numbers
    if not is_command(at, k, _APPLIED_KINDS, own):
        return False
    at += _COMMAND
    if is_sent:
        if not is_command(at, k, EVERY_KIND, own):
            return False
        at += _COMMAND
    return not this.feed or are_finite(own.values[k], at // 2, len(own.fed) // n // 2)


@kernel
def receive_answers(own):
    """
    Receive the answer of each actuator; return 0, or 1 at what is left to Python.

    It waits for the last one first: the others have answered meanwhile, without a wake-up each.
    """
    this = own.this[0]
    own.received[:] = 0
    for k in range(len(own.received) - 1, -1, -1):
        address = this.answers + WORD * (k * own.answers.shape[1] + this.first)
        found = receive(own.system, own.sockets[k], address, this.largest, 0)
        if found <= 0:
            return 1
        own.received[k] = found
        if not is_answer(k, own):
            return 1
    return 0


@kernel
def take_rows(at, k, answer, rows, n):
    """Copy one row of n from a place of an answer; return the place after it."""
    size = len(rows) // n
    copy_words(answer, at, rows, k * size, size)
    return at + size


@kernel
def take_answers(own):
    """Fill the rows of the run from the answers that were received, the next tick; return 0."""
    this, n = own.this[0], len(own.received)
    this.tick += 1
    for k in range(n):
        answer, at = own.answers[k], this.first + this.rows
        at = take_rows(at, k, answer, own.replies, n)
        at = take_rows(at, k, answer, own.samples, n)
        at = take_rows(at, k, answer, own.applied, n)
        if own.received[k] == this.sizes[1]:
            at = take_rows(at, k, answer, own.sent, n)
        else:
            own.sent[k * _COMMAND] = 0      # its kinds
        if this.feed:
            take_rows(at, k, answer, own.fed, n)
    return 0


class TickRound:
    """
    Exchange of the ticks of a run over sockets, which are those of its actuators first.

    ``largest`` is how many bytes a message on them can have. Answers go to ``rows``.
    """

    def __init__(
            self, rows: Rows, run_id: int, sockets: Sequence[int], has_controllers: bool,
            largest: int) -> None:
        n, has_feed = len(rows.ports), rows.has_supply_ports
        self.rows = rows
        """The rows that are exchanged."""
        step = words_of(encode_tick(run_id, 0, rows, has_controllers))
        forms = [[words_of(_answer(run_id, k, is_sent, has_feed)) for is_sent in (False, True)]
                 for k in range(n)]
        at = ANSWER_HEAD + PARTS + has_feed
        received = np.zeros((n, (largest + _APART) // 8 * 2), np.uint32)
        checked = np.zeros(1, COMMAND)
        own = self._own = Round(
            np.zeros(1, ROUND), system_calls(), step,
            _sources(step.ctypes.data, parts_of_tick(rows, has_controllers)),
            np.array(sockets, np.int64),
            np.array([[form[:at] for form in both] for both in forms]),
            received, received.view(np.float64), np.zeros(n, np.int64), checked, _words(checked),
            _words(rows.replies), _words(rows.samples), _words(rows.applied), _words(rows.sent),
            _words(rows.fed))
        this = self._this = row_record(own.this)
        this.step, this.step_bytes, this.answers = step.ctypes.data, step.nbytes, (
            received.ctypes.data)
        this.largest, this.rows, this.feed = largest, at, has_feed
        this.first = at % 2     # numbers of 8 bytes are at multiples of them
        this.sizes = [form.nbytes for form in forms[0]]
        self.is_too_large = step.nbytes > largest
        """Whether the step is larger than a message can be."""
        self._numbers = own.this.view(np.int64).data    # faster than a record's fields
        self._send, self._receive, self._take = self.bounds = tuple(
            Bound(kernel, own) for kernel in (send_step, receive_answers, take_answers))
        """The kernels of a tick, in their order; each tick after `begin` is the next one."""

    def begin(self, tick: int) -> None:
        """Let a tick be the next one."""
        self._numbers[_TICK] = tick

    def send(self, tick: int) -> bool:
        """Send the step of a tick to all; return whether all sockets have taken it."""
        self.begin(tick)
        return not self._send.run()

    def receive(self) -> bool:
        """Receive the answers to it; return whether all have come and none is unusual."""
        return not self._receive.run()

    def take(self) -> None:
        """Fill the rows from the answers, all of which `receive` has found."""
        self._take.run()

    def step(self) -> bytes:
        """Return the step that was sent last."""
        return self._own.step.tobytes()

    def received(self) -> list[bytes]:
        """Return the messages that have arrived in the last `receive`."""
        first, messages = int(self._this.first), self._own.answers
        return [messages[k, first:].view(np.uint8)[:size].tobytes()
                for k, size in enumerate(self._own.received) if size]


def _answer(run_id: int, index: int, is_sent: bool, has_feed: bool) -> bytes:
    """Return an answer to tick 0 with rows of zeros."""
    return encode_answer(AnswerKind.DONE, run_id, 0, index, actuator_parts(
        np.zeros(1, LOAD_REPLY), np.zeros(1, SAMPLE), np.zeros(1, COMMAND), {},
        np.ones(1, COMMAND) if is_sent else None,
        np.zeros(1, SUPPLY_REPLY) if has_feed else None))


def _sources(step: int, parts: Sequence[Records]) -> np.ndarray:
    """Return the sources of the parts of a step at an address; see `Round`."""
    found, at = [], step + steps.HEADER_BYTES
    for part in parts:
        found.append((at, part.ctypes.data, part.nbytes))
        at += part.nbytes
    return np.array(found, np.int64)


def _words(rows: Records) -> np.ndarray:
    """Return the memory of rows as words."""
    return rows.view(np.uint32)
