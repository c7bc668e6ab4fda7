"""
An actuator's end of the wire as one compiled loop: receive a step, tick, send the answer.

The loop takes the steps that differ from the last one, which Python has checked, by their tick
and their numbers only. It ends with what is left to Python, see `Ended`.
"""

from enum import IntEnum
from typing import NamedTuple

from isa_ros.actuator.rows import row_record
from isa_ros.actuator.ticking import Ticked
from isa_ros.core.bound import Bound
from isa_ros.core.kernel import kernel
from isa_ros.core.pointers import call_at
from isa_ros.core.record import float_columns
from isa_ros.core.signals import COMMAND, EVERY_KIND, LOAD_PORT, Records, SUPPLY_PORT
from isa_ros.core.system_calls import monotonic_ns, receive, send, system_calls, SystemCalls
from isa_ros.core.timebase import PLANT_STEP_NS
from isa_ros.run.rare_messages import is_status_due
from isa_ros.run.wire import answers, steps
from isa_ros.run.wire.answers import AnswerKind, encode_answer
from isa_ros.run.wire.parts import actuator_parts, is_valid_command, PARTS
from isa_ros.run.wire.steps import Step
from isa_ros.run.wire.words import (
    are_finite, begins_with, copy_words, WORD, words_of, write_tick)
import numpy as np

_STEP_HEAD = steps.HEADER_BYTES // WORD
_ANSWER_HEAD = answers.HEADER_BYTES // WORD
_PORT, _COMMAND, _FEED = (row.itemsize // WORD for row in (LOAD_PORT, COMMAND, SUPPLY_PORT))


class Ended(IntEnum):
    """Why the loop has ended."""

    NOTHING = 1
    """No message has arrived, or the socket is closed."""
    DUE = 2
    """A step has arrived, and the time is over: Python looks at all else before it."""
    OTHER = 3
    """A message has arrived that the loop does not take."""
    ANSWERED = 4
    """All ticks are answered; the last one may have something to publish."""
    UNSENT = 5
    """The answer to the last tick could not be sent."""
    BROKEN = 6
    """A state is no longer finite after the last tick."""


LOOP = np.dtype([
    ('socket', 'i8'),       # its number
    ('step', 'i8'),         # addresses of the memory for steps and of that for answers
    ('answers', 'i8'),
    ('advance', 'i8'),      # addresses of the actuator's tick and of its table
    ('table', 'i8'),
    ('expected', 'i8'),     # bytes of a step; 0: none is taken
    ('port', 'i8'),         # places of the actuator's rows in a step, words
    ('command', 'i8'),
    ('feed', 'i8'),         # 0: the supplies of the run have no ports
    ('rows', 'i8'),         # place of the rows in an answer, words
    ('sizes', 'i8', (2,)),  # of the answers without and with a sent command, bytes
    ('received', 'i8'),     # bytes of the step that is not handled yet; 0: there is none
    ('tick', 'i8'),         # of the next step
    ('until_ns', 'i8'),     # on the host's monotonic clock: `Ended.DUE` from then on
    ('most', 'i8'),         # ticks of a call
    ('done', 'i8'),         # ticks of the last call
    ('broken', 'i8'),       # what the last tick returned
])
_SOCKET, _TICK, _UNTIL, _MOST, _DONE, _BROKEN, _RECEIVED, _EXPECTED = (
    float_columns(LOOP)[name] for name in (
        'socket', 'tick', 'until_ns', 'most', 'done', 'broken', 'received', 'expected'))

# Calling an enumeration takes about a microsecond; a dictionary a twentieth of it.
_ENDED = {int(ended): ended for ended in Ended}


class Answering(NamedTuple):
    """Memory of the loop; messages and rows are words of `isa_ros.run.wire.words`."""

    loop: np.ndarray
    """`LOOP`, (1,)."""
    system: SystemCalls
    step: np.ndarray
    """The step that was received last."""
    values: np.ndarray
    """The same memory as floats."""
    head: np.ndarray
    """Header of the next step."""
    answers: np.ndarray
    """An answer without and one with a sent command, (2, words)."""
    port_words: np.ndarray
    """`LOAD_PORT`, `COMMAND` and `SUPPLY_PORT` of the tick."""
    command_words: np.ndarray
    feed_words: np.ndarray
    reply_words: np.ndarray
    """`LOAD_REPLY`, `SAMPLE`, applied and sent `COMMAND`, `SUPPLY_REPLY` of the answer."""
    sample_words: np.ndarray
    applied_words: np.ndarray
    sent_words: np.ndarray
    fed_words: np.ndarray
    commands: np.ndarray
    """The same memory as rows, (1,)."""
    observed: np.ndarray
    applied: np.ndarray
    sent: np.ndarray
    clock: np.ndarray
    """Of a `Ticked`."""


@kernel
def takes_step(own):
    """Return whether the message received is the expected tick; copy its rows if so."""
    loop = own.loop[0]
    write_tick(loop.tick, own.head, _STEP_HEAD)
    if loop.received != loop.expected or not begins_with(own.head, own.step):
        return False
    if not are_finite(own.values, loop.port // 2, _PORT // 2) or (
            loop.feed and not are_finite(own.values, loop.feed // 2, _FEED // 2)):
        return False
    copy_words(own.step, loop.command, own.command_words, 0, _COMMAND)
    if not is_valid_command(own.commands[0], EVERY_KIND):
        return False
    copy_words(own.step, loop.port, own.port_words, 0, _PORT)
    if loop.feed:
        copy_words(own.step, loop.feed, own.feed_words, 0, _FEED)
    return True


@kernel
def write_answer(is_sent, own):
    """Write an answer from the rows of the tick that has ended; ``is_sent`` is 0 or 1."""
    loop, answer = own.loop[0], own.answers[is_sent]
    write_tick(loop.tick, answer, _ANSWER_HEAD)
    at = loop.rows
    for rows in (own.reply_words, own.sample_words, own.applied_words):
        copy_words(rows, 0, answer, at, len(rows))
        at += len(rows)
    if is_sent:
        copy_words(own.sent_words, 0, answer, at, len(own.sent_words))
        at += len(own.sent_words)
    if loop.feed:
        copy_words(own.fed_words, 0, answer, at, len(own.fed_words))


@kernel
def has_news(own):
    """Return whether a tick has a message that is published in any case."""
    t_ns, sample = own.clock[0] * PLANT_STEP_NS, own.observed[0]
    return bool(own.applied[0].kinds or own.sent[0].kinds or is_status_due(
        sample.state_since, sample.age, sample.is_stale, t_ns,
        t_ns - own.clock[1] * PLANT_STEP_NS))


@kernel
def answer_ticks(own):
    """Receive steps, advance and answer; return how it `Ended`. ``own`` is an `Answering`."""
    loop = own.loop[0]
    loop.done = 0
    while loop.done < loop.most:
        if loop.received == 0:
            found = receive(own.system, loop.socket, loop.step, WORD * len(own.step), 0)
            if found <= 0:
                return Ended.NOTHING.value
            loop.received = found
        if monotonic_ns(own.system) >= loop.until_ns:
            return Ended.DUE.value
        if not takes_step(own):
            return Ended.OTHER.value
        loop.received = 0
        loop.broken = call_at(loop.advance, loop.table)
        loop.done += 1
        if loop.broken != 0:
            return Ended.BROKEN.value
        is_sent = 1 if own.sent[0].kinds else 0
        write_answer(is_sent, own)
        loop.tick += 1
        if send(own.system, loop.socket, loop.answers + is_sent * WORD * own.answers.shape[1],
                loop.sizes[is_sent], 0) < 0:
            return Ended.UNSENT.value
        if has_news(own):
            return Ended.ANSWERED.value
    return Ended.ANSWERED.value


class AnswerLoop:
    """
    The loop of one actuator with the memory of its tick; steps have at most ``largest`` bytes.

    ``advance`` is the tick, bound to ``ticked``.
    """

    def __init__(self, ticked: Ticked, advance: Bound, largest: int) -> None:
        self._ticked, self._advance = ticked, advance
        memory = ticked.memory
        step = np.zeros(largest // WORD, np.uint32)
        longest = len(self._answer(0, 0, is_sent=True, has_feed=True))
        own = Answering(
            np.zeros(1, LOOP), system_calls(), step, step.view(np.float64),
            np.zeros(_STEP_HEAD, np.uint32), np.zeros((2, longest // WORD), np.uint32),
            _words(ticked.ports), _words(ticked.commands), _words(memory.feeds),
            _words(memory.replies), _words(memory.observed), _words(memory.applied),
            _words(memory.sent), _words(memory.fed),
            ticked.commands, memory.observed, memory.applied, memory.sent, ticked.clock)
        self._own, self._loop = own, row_record(own.loop)
        self._loop.step, self._loop.answers = step.ctypes.data, own.answers.ctypes.data
        self._loop.advance, self._loop.table = advance.address, advance.table.ctypes.data
        self._values = own.loop.view(np.int64).data    # faster than a record's fields
        self._bound = Bound(answer_ticks, own)
        self._form: object = None   # of the steps that are expected

    def _answer(self, run_id: int, index: int, is_sent: bool, has_feed: bool) -> bytes:
        """Return an answer to tick 0."""
        memory = self._ticked.memory
        return encode_answer(AnswerKind.DONE, run_id, 0, index, actuator_parts(
            memory.replies, memory.observed, memory.applied, {},
            np.ones(1, COMMAND) if is_sent else None, memory.fed if has_feed else None))

    def expect(self, step: Step, index: int, has_feed: bool) -> None:
        """
        Take steps like this one, a tick that was checked and executed.

        ``index`` is that of the participant; ``has_feed``: the supplies of the run have ports.
        """
        own, loop, rows = self._own, self._loop, step.rows
        form = step.run_id, len(step.body), rows, index, has_feed
        loop.expected = steps.HEADER_BYTES + len(step.body)
        if form == self._form:
            return
        self._form = form
        own.head[:] = words_of(step.header())
        loop.port = _STEP_HEAD + index * _PORT
        loop.command = _STEP_HEAD + rows * _PORT + index * _COMMAND
        loop.feed = _STEP_HEAD + rows * (_PORT + _COMMAND) + index * _FEED if has_feed else 0
        loop.rows = _ANSWER_HEAD + (PARTS + has_feed)
        for is_sent in (False, True):
            answer = words_of(self._answer(step.run_id, index, is_sent, has_feed))
            own.answers[int(is_sent), :len(answer)] = answer
            loop.sizes[int(is_sent)] = answer.nbytes

    def forget(self) -> None:
        """Take no steps until the next `expect`."""
        self._values[_EXPECTED] = 0

    @property
    def is_expecting(self) -> bool:
        """Return whether the loop takes steps."""
        return self._values[_EXPECTED] > 0

    def run(self, socket: int, tick: int, until_ns: int, most: int) -> Ended:
        """
        Answer at most so many ticks from ``tick`` on; a step that was `Ended.DUE` is the first.

        A step is due from ``until_ns`` on, on the host's monotonic clock.
        """
        values = self._values
        values[_SOCKET], values[_TICK] = socket, tick
        values[_UNTIL], values[_MOST] = until_ns, most
        return _ENDED[self._bound.run()]

    def leave(self) -> Ended:
        """Run no tick, and leave the step that was `Ended.DUE`."""
        self._values[_DONE] = 0
        return Ended.OTHER

    @property
    def done(self) -> int:
        """Return the number of ticks of the last `run`."""
        return self._values[_DONE]

    @property
    def broken(self) -> int:
        """Return what the last tick returned."""
        return self._values[_BROKEN]

    @property
    def has_step(self) -> bool:
        """Return whether a message was received and not handled."""
        return self._values[_RECEIVED] > 0

    def take_step(self) -> bytes:
        """Return the message that was received and not handled; it is no longer the loop's."""
        size, self._values[_RECEIVED] = self._values[_RECEIVED], 0
        return self._own.step.view(np.uint8)[:size].tobytes()


def _words(rows: Records) -> np.ndarray:
    """Return the memory of rows as words."""
    return rows.view(np.uint32)
