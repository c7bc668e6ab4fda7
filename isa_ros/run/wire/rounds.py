"""
Kernels of the coordinator's ticks: a step to all, an answer from each actuator.

Once all actuators wait at the board of the run, steps and answers are there, and by socket a step
goes to controllers only; until then, and without a board, all goes by socket. Answers are taken
if they differ by their numbers only from those that `encode_answer` makes of a tick without
changed parameters. All others, and what has arrived before them, are left to Python.
"""

from typing import NamedTuple

from isa_ros.core.kernel import kernel
from isa_ros.core.pointers import add_at, load_at
from isa_ros.core.signals import COMMAND, EVERY_KIND, WAS_REFUSED
from isa_ros.core.system_calls import (
    AT_ONCE, copy_memory, receive, send, SystemCalls, wait_while)
from isa_ros.run.wire.board import answered_by, are_there, Board, LOUD, post, ring_all
from isa_ros.run.wire.parts import is_valid_command
from isa_ros.run.wire.words import (
    ANSWER_HEAD, are_finite, begins_with, copy_words, STEP_HEAD, WORD, write_tick)
import numpy as np

_COMMAND = COMMAND.itemsize // WORD
_APPLIED_KINDS = EVERY_KIND | WAS_REFUSED

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
    ('is_posted', 'i8'),    # whether the step is one of the board
    ('heard', 'i8'),        # its bell, when Python began to look at all that may have come
])


class Round(NamedTuple):
    """Memory of the exchange of n actuators; messages and rows are words."""

    this: np.ndarray
    """`ROUND`, (1,)."""
    system: SystemCalls
    board: Board
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
    collected: np.ndarray
    """The last step of the board whose answer was copied from there, as its number, (n,)."""
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
    this.is_posted = 1 if are_there(own.board) else 0
    if this.is_posted:
        post(own.system, own.board, this.step, this.step_bytes)
    for k in range(len(own.received) if this.is_posted else 0, len(own.sockets)):
        if send(own.system, own.sockets[k], this.step, this.step_bytes, AT_ONCE) < 0:
            return k + 1
    if not this.is_posted:
        ring_all(own)
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
def collect(own):
    """Copy the answers at the board that were not copied before; return their number."""
    this, board, found = own.this[0], own.board, 0
    posted = board.head[0].posted
    for k in range(len(own.received)):
        own.received[k] = 0
        if answered_by(board, k) == posted and own.collected[k] != posted:
            size = min(board.slots[k].n_bytes, WORD * board.answers.shape[1])
            copy_words(board.answers[k], 0, own.answers[k], this.first, size // WORD)
            own.received[k], own.collected[k] = size, posted
            found += 1
    return found


@kernel
def listen(own):
    """Let each ring wake the coordinator from now on, also before the last answer; return 0."""
    bell = own.board.at[0].rings
    rings = load_at(bell)
    own.this[0].heard = rings if rings >= 0 else add_at(bell, LOUD)
    return 0


@kernel
def hear(own):
    """Wait for a ring after `listen` unless there are new answers; return their number."""
    found = collect(own)
    if found == 0 and wait_while(own.system, own.board.at[0].rings, own.this[0].heard):
        found = collect(own)
    return found


@kernel
def receive_posted(own):
    """Wait for the answers to a posted step; return as `receive_answers`."""
    bell = own.board.at[0].rings
    rings = load_at(bell)
    while rings < 0:
        if not wait_while(own.system, bell, rings):
            return 1
        rings = load_at(bell)
    if collect(own) < len(own.received):
        return 1
    for k in range(len(own.received)):
        if not is_answer(k, own):
            return 1
    return 0


@kernel
def receive_answers(own):
    """
    Receive the answer of each actuator; return 0, or 1 at what is left to Python.

    By socket it waits for the last one first: the others have answered meanwhile, without a
    wake-up each.
    """
    this = own.this[0]
    own.received[:] = 0
    if this.is_posted:
        return receive_posted(own)
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
