"""The coordinator's ticks over sockets and the board, compiled as far as nothing is unusual."""

from collections.abc import Callable
from contextlib import suppress
import os

from isa_ros.core.bound import nothing, Part
from isa_ros.core.kernel import IS_COMPILED
from isa_ros.nodes.lockstep import sockets
from isa_ros.nodes.lockstep.expected import Participants
from isa_ros.nodes.lockstep.sockets import LocalWires
from isa_ros.run.wire.board import are_possible, bell_of, new_board, no_board, ring_all
from isa_ros.run.wire.coordinating import TickRound
from isa_ros.tick.exchange import Rows


_SEND, _RECEIVE = 0, 1     # places of the parts of `RoundEnds`


class RoundEnds:
    """
    The actuators of other processes in quiet ticks: a step to all, an answer from each.

    ``end`` is called with the tick that has begun and is not answered, or with the last one that
    is, and whether its step could not be sent to all.
    """

    def __init__(self, round_: TickRound, end: Callable[[int, bool], None]) -> None:
        self._round, self._end = round_, end
        self.parts = tuple(Part(bound, nothing) for bound in round_.bounds)
        self.left: list[bytes] = []
        """Messages that have arrived in a tick that was not answered by all, or not as usual."""

    @property
    def is_settled(self) -> bool:
        """Return whether no parameter changed at the last tick."""
        return not self._round.rows.tuned

    def begin_quiet(self, tick: int) -> None:
        """Let a tick be the next one."""
        self._round.begin(tick)

    def end_quiet(self, tick: int, n_ticks: int, place: int) -> bool:
        """Note the last tick; return whether it waits for answers."""
        has_begun = place in (_SEND, _RECEIVE)
        if place == _RECEIVE:
            self.left = self._round.received()
        last = tick + n_ticks - (not (has_begun or place > _RECEIVE))
        if last >= tick:
            self._end(last, place == _SEND)
        return has_begun


class SocketRounds:
    """
    Sends the ticks of a run on ``wires`` and receives the answers of its actuators.

    It does where all of them are in other processes; controllers get the step from here too, and
    answer to ``wires``.
    """

    def __init__(self, wires: LocalWires, participants: Participants) -> None:
        self._wires = wires
        self._has_controllers = participants.has_controllers
        self._n_actuators = len(participants.starts)
        self._are_possible = IS_COMPILED and (
            participants.first_remote == 0 < len(participants.starts))
        self._run_id = 0
        self._round: TickRound | None = None
        self._ends: RoundEnds | None = None
        self._is_sent = False
        self._board = no_board()
        self._late: list[bytes] = []

    def begin(self) -> None:
        """Offer a board to the participants of a run that are connected."""
        self._board, file, self._late, self._is_sent = no_board(), None, [], False
        if self._are_possible and self._wires.is_open and are_possible():
            with suppress(OSError):     # as of too many files: the sockets do as well
                self._board, file = new_board(self._n_actuators, sockets.LARGEST)
                self._wires.ring = bell_of(ring_all, self._board)
        self._wires.welcome(file)
        if file is not None:
            os.close(file)

    def ends(self, run_id: int, end: Callable[[int, bool], None]) -> RoundEnds | None:
        """Return what carries out quiet ticks, once a round of the run was sent to all."""
        if self._has_controllers or self._run_id != run_id or not (
                self._is_sent and self._wires.is_open and self._round is not None):
            return None
        if self._ends is None:
            self._ends = RoundEnds(self._round, end)
        return self._ends

    def left(self) -> list[bytes]:
        """Return the messages that quiet ticks have left, once."""
        if self._ends is None:
            return []
        left, self._ends.left = self._ends.left, []
        return left

    def send(self, run_id: int, tick: int, rows: Rows) -> bool:
        """Send the step of a tick; False: not sent, or not to all, and then the wires closed."""
        self._is_sent = False
        if not (self._are_possible and self._wires.is_open):
            return False
        this = self._round
        if this is None or this.rows is not rows or self._run_id != run_id:
            this = self._round = TickRound(
                rows, run_id, self._wires.numbers(), self._has_controllers, sockets.LARGEST,
                self._board)
            self._run_id, self._ends = run_id, None
        if this.is_too_large:
            return False
        self._is_sent = this.send(tick)
        if not self._is_sent:
            self._wires.close()
        return self._is_sent

    def receive(self) -> list[bytes] | None:
        """
        Wait for the answers to a step that was sent.

        Returns None if `take` can take them, or else the messages that have arrived.
        """
        if not (self._is_sent and self._wires.is_open) or self._round is None:
            return []
        return None if self._round.receive() else self._round.received()

    def wait(self, timeout_s: float) -> bytes | None:
        """Return the next answer at the board or by socket; None: none came, as `wires.wait`."""
        this = self._round
        if not self._late:
            if this is None or not (self._is_sent and this.is_awaiting):
                return self._wires.wait(timeout_s)
            this.listen()
            if (data := self._wires.wait(0.0)) is not None:
                return data
            self._late = this.late()
        return self._late.pop() if self._late else self._wires.wait(0.0)

    def note(self, participant: int) -> None:
        """Note that a participant has answered, at the board or not: no ring is to come."""
        if self._round is not None and participant < self._n_actuators:
            self._round.note(participant)

    def take(self) -> None:
        """Fill the rows from the answers."""
        if self._round is not None:
            self._round.take()

    def step(self) -> bytes:
        """Return the step that was sent last."""
        return b'' if self._round is None else self._round.step()


def warm_up_rounds(rows: Rows) -> None:
    """Compile the rounds over such rows, or load them from the cache."""
    if IS_COMPILED and sockets.is_possible():
        TickRound(rows, 1, [], False, sockets.LARGEST, no_board())
        bell_of(ring_all, no_board())
