"""The coordinator's end of the private wire: all participants, in processes of their own."""

from collections.abc import Callable, Sequence
import secrets
import time
from typing import Any, NamedTuple

from isa_ros.coordinator import Interrupted, Messages, Records
from isa_ros.errors import ConfigError, RunError, SimulationDiverged
from isa_ros.nodes.domain import another_coordinator, refuse_other_coordinator
from isa_ros.nodes.qos import LOCKSTEP
from isa_ros.nodes.waiting import open_mailbox, SLICE_S
from isa_ros.nodes.wire import (
    ACKNOWLEDGEMENT_TOPIC, Answer, AnswerKind, decode_answer, DIVERGENCE, encode_end,
    encode_hello, encode_tick, STEP_TOPIC)
from isa_ros.signals import LOAD_REPLY
import numpy as np
from rclpy.duration import Duration
from rclpy.node import Node
from std_msgs.msg import UInt8MultiArray

HELLO_PERIOD_S = 0.05
STOP_GRACE_S = 1.0  # how long a tick may still take once a stop is asked for
_IDENTITY, _DIGEST, _FIRST = 0, 1, 2  # parts of a READY answer


class Expected(NamedTuple):
    """A participant of the configuration; the actuators come first, in file order."""

    name: str
    digest: str
    """Empty: not compared."""


class Limits(NamedTuple):
    """How long participants are waited for, in seconds of the host."""

    join_s: float
    tick_s: float


class LockstepTransport:
    """
    One broadcast step and one answer per participant and tick.

    ``watch`` is called while nothing arrives and says who is lost, if it knows.
    """

    def __init__(
            self, node: Node, participants: Sequence[Expected], starts: Records,
            limits: Limits, publish: Callable[[Messages], None],
            publish_clock: Callable[[bytes], None], *, watch: Callable[[], str | None],
            should_stop: Callable[[], bool]) -> None:
        self._node = node
        self._participants = participants
        self._starts = starts
        self._limits = limits
        self.publish = publish
        self.publish_clock = publish_clock
        self._watch = watch
        self._should_stop = should_stop
        self._run_id = secrets.randbits(63) + 1
        self._identities: dict[int, bytes] = {}
        self._tick = 0
        self._publisher = node.create_publisher(UInt8MultiArray, STEP_TOPIC, LOCKSTEP)
        handle: Any = self._publisher.handle
        self._send: Callable[[bytes], None] = handle.publish_raw
        self._mailbox = open_mailbox(node, ACKNOWLEDGEMENT_TOPIC)

    def join(self) -> Sequence[Messages]:
        """
        Say hello until all participants have answered the same one; return their messages.

        One more hello is left its whole period, in which a second node of a name or another
        coordinator that was discovered a little later makes itself known. A second node that
        answers even later is noticed by `receive`.

        Raises
        ------
        ConfigError
            Other parameters, a name that two nodes have, or another coordinator.
        RunError
            A participant did not answer in time, or was lost.
        Interrupted
            A stop was asked for.

        """
        start = time.monotonic()
        names = [participant.name for participant in self._participants]
        complete: dict[int, Answer] = {}
        count = 0
        while True:
            count += 1
            self._send(encode_hello(self._run_id, count, self._starts, names))
            answers = self._hello_answers(count, is_last=bool(complete))
            refuse_other_coordinator(self._node)
            if complete:
                return [complete[k].parts[_FIRST:] for k in range(len(names))]
            if len(answers) == len(names):
                complete = answers
                continue
            self._refuse_lost('before tick 0')
            if self._should_stop():
                raise Interrupted('stopped before tick 0')
            if time.monotonic() - start > self._limits.join_s:
                missing = [name for k, name in enumerate(names) if k not in answers]
                raise RunError(
                    f'{", ".join(missing)}: no answer before tick 0 after '
                    f'{self._limits.join_s:g} s; start it with lockstep:=true in this '
                    'ROS_DOMAIN_ID')

    def _hello_answers(self, count: int, is_last: bool) -> dict[int, Answer]:
        """Return the answers to the ``count``-th hello; the last one takes its whole period."""
        answers: dict[int, Answer] = {}
        end = time.monotonic() + HELLO_PERIOD_S
        while is_last or len(answers) < len(self._participants):
            left = end - time.monotonic()
            if left <= 0.0:
                break
            data = self._mailbox.wait(left)
            if data is None:
                continue
            answer = decode_answer(data)
            self._check_ready(answer)
            if answer.tick == count:
                answers[answer.participant] = answer
        return answers

    def _check_ready(self, answer: Answer) -> None:
        if answer.run_id != self._run_id or answer.kind is AnswerKind.BUSY:
            raise another_coordinator(self._node.context.get_domain_id())
        name, expected = self._participants[answer.participant]
        identity, digest = answer.parts[_IDENTITY], answer.parts[_DIGEST]
        assert identity is not None and digest is not None
        if self._identities.setdefault(answer.participant, identity) != identity:
            raise self._two_nodes(answer.participant)
        if expected and digest.decode() != expected:
            raise ConfigError(
                f'{name}: digest of its parameters = {digest.decode()}, must be {expected} as '
                'configured; give both the same file')

    def _check_unbound(self, answer: Answer) -> None:
        """Refuse a node outside of the run that has the name of one inside."""
        name = (answer.parts[0] or b'').decode()
        names = [participant.name for participant in self._participants]
        if name in names:
            raise self._two_nodes(names.index(name))

    def _two_nodes(self, participant: int) -> ConfigError:
        return ConfigError(
            f'{self._participants[participant].name}: two nodes of this name answer in '
            f'ROS_DOMAIN_ID {self._node.context.get_domain_id()}, must be one')

    def _refuse_lost(self, when: str) -> None:
        lost = self._watch()
        if lost is not None:
            raise RunError(f'{lost} {when}')

    def send(self, tick: int, ports: Records, commands: Records) -> None:
        """Broadcast the step."""
        self._tick = tick
        self._send(encode_tick(self._run_id, tick, ports, commands))

    def receive(self, replies: Records) -> Sequence[Messages]:
        """Wait for every participant; see `Transport`."""
        n = len(self._participants)
        answers: list[Messages] = [()] * n
        missing = set(range(n))
        waited = 0.0
        while missing:
            begin = time.monotonic()
            data = self._mailbox.wait(SLICE_S)
            if data is None:
                self._refuse_lost(f'in tick {self._tick}')
                # A stopped or suspended host must not look like a late participant.
                waited += min(time.monotonic() - begin, 2.0 * SLICE_S)
                self._check_waited(waited, missing)
                continue
            answer = decode_answer(data)
            if answer.run_id != self._run_id or answer.kind is AnswerKind.BUSY:
                continue
            if answer.kind is AnswerKind.READY:
                self._check_ready(answer)
                continue
            if answer.kind is AnswerKind.UNBOUND:
                self._check_unbound(answer)
                continue
            if answer.tick != self._tick or answer.participant not in missing:
                raise self._two_nodes(answer.participant)  # one answers each tick once
            answers[answer.participant] = self._done(answer, replies)
            missing.discard(answer.participant)
        return answers

    def _done(self, answer: Answer, replies: Records) -> Messages:
        reply, *messages = answer.parts
        if answer.kind is AnswerKind.DONE:
            if reply is not None:
                replies[answer.participant] = np.frombuffer(reply, LOAD_REPLY)[0]
            return messages
        assert reply is not None
        if answer.kind is AnswerKind.DIVERGED:
            t_ns, value = DIVERGENCE.unpack(reply)
            raise SimulationDiverged(t_ns, (messages[0] or b'').decode(), value)
        name = self._participants[answer.participant].name
        raise RunError(f'{name}: refused tick {self._tick}: {reply.decode()}')

    def _check_waited(self, waited: float, missing: set[int]) -> None:
        names = ', '.join(self._participants[k].name for k in sorted(missing))
        if self._should_stop() and waited >= STOP_GRACE_S:
            raise Interrupted(f'stopped in tick {self._tick}, which {names} did not end')
        if waited >= self._limits.tick_s:
            raise RunError(
                f'{names}: no answer to tick {self._tick} after {waited:.1f} s, must come '
                f'within {self._limits.tick_s:g} s')

    def close(self) -> None:
        """Tell the participants that the run is over."""
        self._send(encode_end(self._run_id))
        self._publisher.wait_for_all_acked(Duration(seconds=HELLO_PERIOD_S))
