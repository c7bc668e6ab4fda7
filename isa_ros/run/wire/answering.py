"""
An actuator's end of the wire as one compiled loop: receive a step, tick, give the answer.

A step comes from the board of the run or by socket, and the answer goes where it came from.

The loop takes the steps that differ from the last one, which Python has checked, by their tick
and their numbers only. It ends with what is left to Python, see `Ended`.
"""

from enum import IntEnum
from typing import NamedTuple

from isa_ros.core.device import is_status_due
from isa_ros.core.kernel import kernel
from isa_ros.core.pointers import call_at, load_at
from isa_ros.core.signals import COMMAND, EVERY_KIND, LOAD_PORT, SUPPLY_PORT
from isa_ros.core.system_calls import (
    copy_memory, monotonic_ns, receive, send, SystemCalls, wait_while)
from isa_ros.core.timebase import PLANT_STEP_NS
from isa_ros.run.wire.board import answer, Board
from isa_ros.run.wire.parts import is_valid_command
from isa_ros.run.wire.words import (
    ANSWER_HEAD, are_finite, begins_with, copy_words, STEP_HEAD, WORD, write_tick)
import numpy as np

PORT, COMMAND_ROW, FEED = (row.itemsize // WORD for row in (LOAD_PORT, COMMAND, SUPPLY_PORT))
"""Words of an actuator's rows in a step."""


class Ended(IntEnum):
    """Why the loop has ended."""

    NOTHING = 1
    """No message has arrived, or one by socket while the loop waits at the board."""
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
    ('keeps', 'i8'),        # whether a tick with a command does not end the loop
    ('kept', 'i8'),         # number of such ticks whose commands are kept
    ('slot', 'i8'),         # at the board
    ('posted', 'i8'),       # the last step there that was received, as its number
    ('heard', 'i8'),        # messages by socket that the coordinator has rung for, so far
    ('is_posted', 'i8'),    # whether the step that was received last was one of the board
])


class Answering(NamedTuple):
    """Memory of the loop; messages and rows are words of `isa_ros.run.wire.words`."""

    loop: np.ndarray
    """`LOOP`, (1,)."""
    system: SystemCalls
    board: Board
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
    kept: np.ndarray
    """`COMMAND` that took effect and is not published yet, (m,)."""
    kept_at: np.ndarray
    """Plant step at the end of its tick, (m,)."""


@kernel
def next_message(own):
    """
    Wait for a message and return its bytes.

    A number of 0 or below: none came, or the coordinator has rung for one by socket.
    """
    loop, board = own.loop[0], own.board
    at, head = board.at[0], board.head[0]
    loop.is_posted = 0
    if at.bell == 0:
        return receive(own.system, loop.socket, loop.step, WORD * len(own.step), 0)
    while True:
        rung, posted = load_at(at.bell), load_at(at.posted)
        if posted != loop.posted:
            loop.posted, loop.is_posted = posted, 1
            k = posted & 1
            size = min(head.n_bytes[k], WORD * len(own.step))
            copy_memory(
                own.system, loop.step, at.steps + k * WORD * board.steps.shape[1], size)
            return size
        if head.messages != loop.heard:
            loop.heard = head.messages
            return 0
        if not wait_while(own.system, at.bell, rung):
            return 0


@kernel
def takes_step(own):
    """Return whether the message received is the expected tick; copy its rows if so."""
    loop = own.loop[0]
    write_tick(loop.tick, own.head, STEP_HEAD)
    if loop.received != loop.expected or not begins_with(own.head, own.step):
        return False
    if not are_finite(own.values, loop.port // 2, PORT // 2) or (
            loop.feed and not are_finite(own.values, loop.feed // 2, FEED // 2)):
        return False
    copy_words(own.step, loop.command, own.command_words, 0, COMMAND_ROW)
    if not is_valid_command(own.commands[0], EVERY_KIND):
        return False
    copy_words(own.step, loop.port, own.port_words, 0, PORT)
    if loop.feed:
        copy_words(own.step, loop.feed, own.feed_words, 0, FEED)
    return True


@kernel
def write_answer(is_sent, own):
    """Write an answer from the rows of the tick that has ended; ``is_sent`` is 0 or 1."""
    loop, answer = own.loop[0], own.answers[is_sent]
    write_tick(loop.tick, answer, ANSWER_HEAD)
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
def give_answer(is_sent, own):
    """Give the answer that was written; return a number below 0 if that failed."""
    loop, size = own.loop[0], own.loop[0].sizes[is_sent]
    if loop.is_posted:
        copy_words(own.answers[is_sent], 0, own.board.answers[loop.slot], 0, size // WORD)
        answer(own.system, own.board, loop.slot, loop.posted, size)
        return 0
    address = loop.answers + is_sent * WORD * own.answers.shape[1]
    return send(own.system, loop.socket, address, size, 0)


@kernel
def has_news(own):
    """
    Return whether a tick has a message that is published in any case, and must be now.

    A command that took effect is kept meanwhile, where it came without a link, as far as there
    is room.
    """
    loop, sample = own.loop[0], own.observed[0]
    t_ns = own.clock[0] * PLANT_STEP_NS
    is_due = is_status_due(sample.state_since, sample.age, sample.is_stale, t_ns,
                           t_ns - own.clock[1] * PLANT_STEP_NS)
    if not (own.applied[0].kinds or own.sent[0].kinds):
        return is_due
    if not loop.keeps:
        return True
    own.kept[loop.kept] = own.applied[0]
    own.kept_at[loop.kept] = own.clock[0]
    loop.kept += 1
    return is_due or loop.kept == len(own.kept)


@kernel
def answer_ticks(own):
    """Receive steps, advance and answer; return how it `Ended`. ``own`` is an `Answering`."""
    loop = own.loop[0]
    loop.done = 0
    while loop.done < loop.most:
        if loop.received == 0:
            found = next_message(own)
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
        if give_answer(is_sent, own) < 0:
            return Ended.UNSENT.value
        if has_news(own):
            return Ended.ANSWERED.value
    return Ended.ANSWERED.value
