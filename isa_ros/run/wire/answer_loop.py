"""The compiled loop of an actuator's end, with its memory; see `isa_ros.run.wire.answering`."""

from isa_ros.actuator.ticking import Ticked
from isa_ros.core.bound import Bound
from isa_ros.core.record import float_columns, row_record
from isa_ros.core.signals import COMMAND, Records
from isa_ros.core.system_calls import system_calls
from isa_ros.core.timebase import PLANT_STEP_NS
from isa_ros.run.wire import steps
from isa_ros.run.wire.answering import (
    answer_ticks, Answering, COMMAND_ROW, Ended, FEED, LOOP, PORT)
from isa_ros.run.wire.answers import AnswerKind, encode_answer
from isa_ros.run.wire.board import bell_of, Board, no_board, ring
from isa_ros.run.wire.parts import actuator_parts, PARTS
from isa_ros.run.wire.steps import Step
from isa_ros.run.wire.words import ANSWER_HEAD, STEP_HEAD, WORD, words_of
import numpy as np

_SOCKET, _TICK, _UNTIL, _MOST, _DONE, _BROKEN, _RECEIVED, _EXPECTED, _KEEPS, _KEPT = (
    float_columns(LOOP)[name] for name in (
        'socket', 'tick', 'until_ns', 'most', 'done', 'broken', 'received', 'expected', 'keeps',
        'kept'))
MOST_KEPT = 256
"""Applied commands that the loop keeps."""

# Calling an enumeration takes about a microsecond; a dictionary a twentieth of it.
_ENDED = {int(ended): ended for ended in Ended}


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
            np.zeros(1, LOOP), system_calls(), no_board(), step, step.view(np.float64),
            np.zeros(STEP_HEAD, np.uint32), np.zeros((2, longest // WORD), np.uint32),
            _words(ticked.ports), _words(ticked.commands), _words(memory.feeds),
            _words(memory.replies), _words(memory.observed), _words(memory.applied),
            _words(memory.sent), _words(memory.fed),
            ticked.commands, memory.observed, memory.applied, memory.sent, ticked.clock,
            np.zeros(MOST_KEPT, COMMAND), np.zeros(MOST_KEPT, np.int64))
        self._own, self._loop = own, row_record(own.loop)
        self._loop.step, self._loop.answers = step.ctypes.data, own.answers.ctypes.data
        self._loop.advance, self._loop.table = advance.address, advance.table.ctypes.data
        self._values = own.loop.view(np.int64).data    # faster than a record's fields
        self._form: object = None   # of the steps that are expected
        self.stand_at(own.board)

    def stand_at(self, board: Board, slot: int = 0) -> None:
        """Wait at a board from now on if it has such a slot, or else at the socket."""
        if slot >= len(board.slots):
            board, slot = no_board(), 0
        self._own = self._own._replace(board=board)
        self._loop.slot, self._loop.posted, self._loop.heard = slot, 0, 0
        self._bound = Bound(answer_ticks, self._own)
        self._ring = bell_of(ring, board)
        board.slots['is_there'][slot] = 1

    def ring(self) -> None:
        """Wake a coordinator at the board: a message was sent to its socket."""
        self._ring()

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
        loop.port = STEP_HEAD + index * PORT
        loop.command = STEP_HEAD + rows * PORT + index * COMMAND_ROW
        loop.feed = STEP_HEAD + rows * (PORT + COMMAND_ROW) + index * FEED if has_feed else 0
        loop.rows = ANSWER_HEAD + (PARTS + has_feed)
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

    def run(self, socket: int, tick: int, until_ns: int, most: int, keeps: bool) -> Ended:
        """
        Answer at most so many ticks from ``tick`` on; a step that was `Ended.DUE` is the first.

        A step is due from ``until_ns`` on, on the host's monotonic clock. ``keeps``: a tick with
        a command does not end the loop as long as there is room for it, see `take_kept`.
        """
        values = self._values
        values[_KEEPS] = keeps
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
    def n_kept(self) -> int:
        """Return the number of commands that are kept; `MOST_KEPT` have to be taken."""
        return self._values[_KEPT]

    def take_kept(self) -> list[tuple[int, np.void]]:
        """Return ends, ns, and commands of the ticks that had one; they are no longer kept."""
        n, own = self._values[_KEPT], self._own
        self._values[_KEPT] = 0
        return [(int(step) * PLANT_STEP_NS, command)
                for step, command in zip(own.kept_at[:n], own.kept[:n])]

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
