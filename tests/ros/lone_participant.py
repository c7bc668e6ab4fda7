"""A participant with a node but without a partner: steps are put into its mailbox one by one."""

from collections import deque
from collections.abc import Iterable

from isa_ros.core.signals import START
from isa_ros.nodes.lockstep.participant_end import ParticipantEnd
from isa_ros.run.wire.answers import Answer, AnswerKind, decode_answer
from isa_ros.run.wire.parts import Parts
from isa_ros.run.wire.roster import Roster
from isa_ros.run.wire.steps import encode_begin, encode_hello, encode_tick, Step
import numpy as np
from rclpy.node import Node
from tests.ros.lockstep.participants import rows_of_two

RUN = 4711
NAMES = ('haa', 'kfe')
ROSTER = Roster(NAMES, ['supply'], {})


class Post:
    """A mailbox that holds what a test puts into it, and nothing else ever arrives."""

    def __init__(self, messages: Iterable[bytes] = ()) -> None:
        self.messages = deque(messages)

    def wait(self, timeout_s: float) -> bytes | None:
        """Return the next message at once."""
        return self.messages.popleft() if self.messages else None

    take = wait

    def count_senders(self) -> int:
        """Return 1, a coordinator."""
        return 1


class Counting:
    """A role that counts what it has to do."""

    digest = b'same'
    is_actuator = True

    def __init__(self) -> None:
        self.ticks = self.snapshots = self.published = 0

    def check(self, step: Step) -> None:
        """Refuse what no actuator of the run can execute."""
        step.refuse_tick(len(NAMES), NAMES.index('kfe'))

    def start(self, step: Step, index: int) -> Parts:
        """Begin anew."""
        self.ticks = 0
        return [b'start']

    def advance(self, step: Step) -> Parts:
        """Count a tick."""
        self.ticks += 1
        return [b'tick %d' % self.ticks]

    def publish(self) -> None:
        """Count the first messages."""
        self.published += 1

    def serve(self) -> None:
        """Take nothing."""

    def snapshot(self) -> bytes:
        """Count a snapshot."""
        self.snapshots += 1
        return b'after %d' % self.ticks

    def restore(self, snapshot: bytes) -> Parts:
        """Go on from where it was taken."""
        self.ticks = int(snapshot.split()[1])
        return [b'restored']


class Participant:
    """A participant without a thread, bound to `RUN`, and its answers."""

    def __init__(self, node: Node) -> None:
        self.role = Counting()
        self._end = ParticipantEnd(node, self.role)
        self.answers: list[Answer] = []
        self._end._send = lambda data: self.answers.append(decode_answer(data))
        starts = np.zeros(2, START)
        self.answers_to(
            encode_hello(RUN, 1, 1_000_000, starts, ROSTER),
            encode_begin(RUN, [None, self.identity]))

    @property
    def identity(self) -> bytes:
        """Return what names this node."""
        return self._end._identity

    def answers_to(self, *steps: bytes) -> list[tuple[AnswerKind, int, bool]]:
        """Hand steps over; return (kind, tick, is repeated) of the answers to them."""
        before = len(self.answers)
        for step in steps:
            self._end._receive(step)
        return [(one.kind, one.tick, one.is_repeated) for one in self.answers[before:]]


def tick(number: int, run: int = RUN) -> bytes:
    return encode_tick(run, number, rows_of_two(), has_controllers=False)


def done(number: int, is_repeated: bool = False) -> tuple[AnswerKind, int, bool]:
    return AnswerKind.DONE, number, is_repeated
