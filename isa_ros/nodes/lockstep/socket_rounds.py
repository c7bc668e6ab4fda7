"""The coordinator's ticks over sockets, in compiled code as far as nothing is unusual."""

from isa_ros.core.kernel import IS_COMPILED
from isa_ros.nodes.lockstep import sockets
from isa_ros.nodes.lockstep.expected import Participants
from isa_ros.nodes.lockstep.sockets import LocalWires
from isa_ros.run.wire.coordinating import TickRound
from isa_ros.tick.exchange import Rows


class SocketRounds:
    """
    Sends the ticks of a run on ``wires`` and receives the answers of its actuators.

    It does where all of them are in other processes; controllers get the step from here too, and
    answer to ``wires``.
    """

    def __init__(self, wires: LocalWires, participants: Participants) -> None:
        self._wires = wires
        self._has_controllers = participants.has_controllers
        self._are_possible = IS_COMPILED and (
            participants.first_remote == 0 < len(participants.starts))
        self._run_id = 0
        self._round: TickRound | None = None
        self._is_sent = False

    def send(self, run_id: int, tick: int, rows: Rows) -> bool:
        """Send the step of a tick; False: not sent, or not to all, and then the wires closed."""
        self._is_sent = False
        if not (self._are_possible and self._wires.is_open):
            return False
        this = self._round
        if this is None or this.rows is not rows or self._run_id != run_id:
            this = self._round = TickRound(
                rows, run_id, self._wires.numbers(), self._has_controllers, sockets.LARGEST)
            self._run_id = run_id
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
        TickRound(rows, 1, [], False, sockets.LARGEST)
