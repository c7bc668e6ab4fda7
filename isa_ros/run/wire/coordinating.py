"""The coordinator's exchange of a tick, by socket or board; see `isa_ros.run.wire.rounds`."""

from collections.abc import Sequence

from isa_ros.core.bound import Bound
from isa_ros.core.record import float_columns, row_record
from isa_ros.core.signals import COMMAND, LOAD_REPLY, Records, SAMPLE, SUPPLY_REPLY
from isa_ros.core.system_calls import system_calls
from isa_ros.run.wire import steps
from isa_ros.run.wire.answers import AnswerKind, encode_answer
from isa_ros.run.wire.board import Board
from isa_ros.run.wire.parts import actuator_parts, PARTS
from isa_ros.run.wire.rounds import (
    hear, listen, receive_answers, ROUND, Round, send_step, take_answers)
from isa_ros.run.wire.steps import encode_tick, parts_of_tick
from isa_ros.run.wire.words import ANSWER_HEAD, words_of
from isa_ros.tick.exchange import Rows
import numpy as np

_APART = 1024   # bytes between two messages, so that they do not share lines of a cache
_TICK = float_columns(ROUND)['tick']


class TickRound:
    """
    Exchange of the ticks of a run, over sockets, those of its actuators first, and its board.

    ``largest`` is how many bytes a message on them can have. Answers go to ``rows``.
    """

    def __init__(
            self, rows: Rows, run_id: int, sockets: Sequence[int], has_controllers: bool,
            largest: int, board: Board) -> None:
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
            np.zeros(1, ROUND), system_calls(), board, step,
            _sources(step.ctypes.data, parts_of_tick(rows, has_controllers)),
            np.array(sockets, np.int64),
            np.array([[form[:at] for form in both] for both in forms]),
            received, received.view(np.float64), np.zeros(n, np.int64),
            np.zeros(n, np.int64), checked, _words(checked), _words(rows.replies),
            _words(rows.samples), _words(rows.applied), _words(rows.sent), _words(rows.fed))
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
        self._listen, self._hear = Bound(listen, own), Bound(hear, own)

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

    @property
    def is_awaiting(self) -> bool:
        """Return whether an answer to a posted step was not received yet."""
        own = self._own
        return bool(self._this.is_posted and (own.collected != own.board.head['posted']).any())

    def note(self, k: int) -> None:
        """Note that actuator ``k`` has answered the last step, perhaps not at the board."""
        self._own.collected[k] = self._own.board.head['posted'][0]

    def listen(self) -> None:
        """Let the next `late` end at a ring from now on."""
        self._listen.run()

    def late(self) -> list[bytes]:
        """Wait a moment for answers at the board, or a ring; return them as they came."""
        self._hear.run()
        return self.received()

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
