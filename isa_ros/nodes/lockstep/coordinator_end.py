"""The coordinator's end of the private wire, to participants in other processes."""

from collections.abc import Callable, Collection, Mapping, Sequence
import secrets
import time
from typing import Any

from isa_ros.core.signals import COMMAND
from isa_ros.errors import ConfigError, RunError
from isa_ros.nodes.lockstep.answer_checks import AnswerChecks, Awaited
from isa_ros.nodes.lockstep.expected import Limits, Participants
from isa_ros.nodes.lockstep.hellos import HELLO_PERIOD_S, Hellos
from isa_ros.nodes.lockstep.socket_rounds import SocketRounds
from isa_ros.nodes.lockstep.sockets import LocalWires
from isa_ros.nodes.middleware.domain import refuse_other_coordinator
from isa_ros.nodes.middleware.mailboxes import open_mailbox, SLICE_S, TOPIC_CHECK_S
from isa_ros.nodes.middleware.qos import LOCKSTEP
from isa_ros.requests import merge_requests
from isa_ros.run.coordinator import Interrupted
from isa_ros.run.wire.answers import ACKNOWLEDGEMENT_TOPIC, Answer, AnswerKind, FIRST
from isa_ros.run.wire.parts import Parts, take_actuator_parts
from isa_ros.run.wire.steps import (
    encode_begin, encode_change, encode_end, encode_hello, encode_restore, encode_save,
    encode_tick, STEP_TOPIC)
from isa_ros.tick.exchange import Ends, IDLE_S, Rows
import numpy as np
from rclpy.duration import Duration
from rclpy.node import Node
from std_msgs.msg import UInt8MultiArray

STOP_GRACE_S = 1.0  # longest duration of a tick after a stop was requested
REPEAT_S = 1.0  # time until an unanswered step is sent again: a message may have been lost


class LockstepTransport:
    """
    A `Transport` with one broadcast step and one answer per participant and tick.

    They use topics; once a run has begun whose participants are all on this host, they use
    sockets, until one of the sockets closes. Meanwhile the topics announce the run to nodes that
    are not part of it, and repeat steps that a stopped participant may have missed.

    ``watch`` is called while nothing arrives; it returns a text that names a lost participant.
    """

    group = None

    def __init__(
            self, node: Node, participants: Participants, limits: Limits, *,
            watch: Callable[[], str | None], should_stop: Callable[[], bool]) -> None:
        self._node, self._run = node, participants
        self._participants = participants.expected
        self._remote = participants.remote
        self._limits = limits
        self._watch, self._should_stop = watch, should_stop
        self._run_id = self._tick = self._requests = 0
        self._answers = AnswerChecks(node, participants)
        self._begin_due = 0.0
        self._awaited, self._step = Awaited(0, 0, 'tick 0'), b''
        self._publisher = node.create_publisher(UInt8MultiArray, STEP_TOPIC, LOCKSTEP)
        self._wires = LocalWires()
        self._rounds = SocketRounds(self._wires, participants)
        self._next_check = 0.0
        handle: Any = self._publisher.handle
        self._send: Callable[[bytes], None] = handle.publish_raw
        self._mailbox = open_mailbox(node, ACKNOWLEDGEMENT_TOPIC)
        self._hellos = Hellos(self._mailbox, self._answers, len(self._remote))

    @property
    def is_quiet(self) -> bool:
        """Return whether the topics of the wire need no look yet."""
        return time.monotonic() < self._next_check

    @property
    def ends(self) -> Ends | None:
        """Return what carries out quiet ticks by socket; None: not yet, or with controllers."""
        return self._rounds.ends(self._run_id, self._end_quiet)

    def _end_quiet(self, tick: int, is_unsent: bool) -> None:
        """Note the last tick by socket; one that has not reached all is sent on the topic."""
        self._tick = tick
        self._send_step(f'tick {tick}', tick, b'')
        if is_unsent:
            self._wires.close()
            self._repeat_step()

    def join(self, rows: Rows) -> None:
        """
        Send hellos until all participants have answered the same one.

        Then one more hello is sent, and answers are received for its whole period, to detect a
        second node of the same name or another coordinator that is discovered a little later. A
        second node that answers even later is detected by `receive`.

        Raises
        ------
        ConfigError
            A participant has other parameters, two nodes have the same name, or there is another
            coordinator.
        RunError
            A participant did not answer in time, or failed.
        Interrupted
            A stop was requested.

        """
        if self._run_id:
            self._end()
            self._hellos.past_runs.add(self._run_id)
        self._run_id = secrets.randbits(63) + 1
        self._awaited = self._awaited._replace(run_id=self._run_id)
        self._wires.listen(self._run_id)
        start = time.monotonic()
        complete: dict[int, Answer] = {}
        count = 0
        while True:
            count += 1
            self._send(encode_hello(
                self._run_id, count, self._run.step_ns, self._run.starts, self._run.roster))
            answers = self._hellos.answers(self._run_id, count, is_last=bool(complete))
            refuse_other_coordinator(self._node)
            if complete:
                self._fill(rows, {k: answer.parts[FIRST:] for k, answer in complete.items()})
                return
            if len(answers) == len(self._remote):
                complete = answers
                continue
            self._refuse_lost('before tick 0')
            if self._should_stop():
                raise Interrupted('stopped before tick 0')
            if time.monotonic() - start > self._limits.join_s:
                raise self._answers.none_of(
                    [k for k in sorted(self._remote) if k not in answers], self._limits.join_s)

    def _refuse_lost(self, when: str) -> None:
        lost = self._watch()
        if lost is not None:
            raise RunError(f'{lost} {when}')

    def begin(self) -> None:
        """Make every participant publish its first messages."""
        self._wires.connect(self._answers.identities)
        self._rounds.begin()
        self._announce()

    def _announce(self) -> None:
        """Tell nodes that are not part of the run, and second nodes of a name, that it goes on."""
        self._send(encode_begin(self._run_id, [
            self._answers.identities.get(k) for k in range(len(self._participants))]))

    def send(self, tick: int, rows: Rows) -> None:
        """Broadcast the changes of parameters, if there are any, and the step of a tick."""
        self._tick = tick
        if rows.changes and self._run.first_remote == 0:
            self._change(rows.changes)
        is_sent = self._rounds.send(self._run_id, tick, rows)
        self._send_step(f'tick {tick}', tick, b'' if is_sent else encode_tick(
            self._run_id, tick, rows, self._run.has_controllers))

    def _change(self, changes: Mapping[int, Mapping[str, float]]) -> None:
        number = self._next_request()
        self._send_step('the change of parameters', number, encode_change(
            self._run_id, number, changes, len(self._participants)))
        self._gather(AnswerKind.CHANGED)

    def _send_step(self, what: str, number: int, step: bytes) -> None:
        """Send a step and note what is awaited; an empty one is that of the rounds, and sent."""
        self._awaited, self._step = Awaited(self._run_id, number, what), step
        if step and not self._wires.send(step):
            self._send(step)

    def _repeat_step(self) -> None:
        """Send the last step again, on the topic."""
        self._send(self._step or self._rounds.step())

    def _next_request(self) -> int:
        """Return a number below 0 that is different for each request."""
        self._requests += 1
        return -self._requests

    def receive(self, rows: Rows) -> None:
        """Wait for every participant; see `Transport`."""
        begin = time.monotonic()
        arrived: list[bytes] | None = self._rounds.left()
        if not arrived and begin < self._next_check:
            arrived = self._rounds.receive()
        if arrived is None:
            requested = self._gather(
                AnswerKind.DONE, [k for k in self._remote if k >= len(rows.replies)])
            self._rounds.take()
            self._fill(rows, requested)
        else:
            waited = min(time.monotonic() - begin, 2.0 * SLICE_S)
            self._fill(rows, self._gather(AnswerKind.DONE, self._remote, arrived, waited))

    def idle(self, seconds: float = IDLE_S) -> None:
        """Announce that the run continues, and check for lost participants and second nodes."""
        if time.monotonic() >= self._begin_due:
            self._begin_due = time.monotonic() + REPEAT_S
            self._announce()
        self._refuse_lost(f'while waiting before tick {self._tick}')
        data = self._mailbox.wait(seconds)
        if data is not None:
            answer = self._answers.decoded(data, self._run_id)
            if answer is not None:
                self._answers.is_awaited(answer, self._awaited, AnswerKind.DONE, set())

    def snapshots(self) -> list[bytes]:
        """Return the state of every participant."""
        number = self._next_request()
        self._send_step('the request to save its state', number, encode_save(self._run_id, number))
        parts = self._gather(AnswerKind.SAVED)
        return [parts[k][0] or b'' for k in sorted(parts)]

    def restore(self, tick: int, snapshots: Sequence[bytes], rows: Rows) -> None:
        """Restore every participant from its snapshot."""
        if len(snapshots) != len(self._participants):
            raise ConfigError(
                f'the saved state has {len(snapshots)} participants, the run has '
                f'{len(self._participants)}')
        self._tick = tick
        number = self._next_request()
        self._send_step('the request to restore its state', number,
                        encode_restore(self._run_id, number, tick, snapshots))
        self._fill(rows, self._gather(AnswerKind.RESTORED))

    def _fill(self, rows: Rows, parts: dict[int, Parts]) -> None:
        """Fill the rows from the answers of actuators and controllers."""
        n_actuators = len(rows.replies)
        if self._run.first_remote == 0:
            rows.tuned = {}
        for k in sorted(parts):
            if k < n_actuators:
                take_actuator_parts(parts[k], k, rows)
            else:
                merge_requests(np.frombuffer(parts[k][0] or b'', COMMAND), rows.requests)

    def _gather(
            self, kind: AnswerKind, participants: Collection[int] | None = None,
            arrived: Sequence[bytes] = (), waited: float = 0.0) -> dict[int, Parts]:
        """
        Wait until participants, None: all, have answered; return the parts of each.

        ``arrived`` are messages that have already, and ``waited`` is the time spent so far, s.
        """
        parts: dict[int, Parts] = {}
        missing = set(self._remote if participants is None else participants)
        messages, repeat_at = iter(arrived), REPEAT_S
        while missing:
            begin = time.monotonic()
            data = next(messages, None) or self._next_answer()
            if data is None and self._watch() is not None:
                data = self._next_answer()  # may have been sent before it was lost
            if data is None:
                self._refuse_lost(f'in tick {self._tick}')
                # The time in which the host was stopped or suspended does not count.
                waited += min(time.monotonic() - begin, 2.0 * SLICE_S)
                self._check_waited(waited, missing)
                if waited >= repeat_at:
                    repeat_at += REPEAT_S
                    self._repeat_step()
                continue
            answer = self._answers.decoded(data, self._run_id)
            if answer is not None and self._answers.is_awaited(
                    answer, self._awaited, kind, missing):
                parts[answer.participant] = answer.parts
                missing.discard(answer.participant)
                self._rounds.note(answer.participant)
        return parts

    def _next_answer(self) -> bytes | None:
        """Return the next message, or None if none arrives within `SLICE_S`."""
        if not self._wires.is_open:
            return self._mailbox.wait(SLICE_S)
        if time.monotonic() >= self._next_check:
            if (data := self._mailbox.take()) is not None:
                return data
            self._next_check = time.monotonic() + TOPIC_CHECK_S
            self._announce()
        data = self._rounds.wait(SLICE_S)
        if not self._wires.is_open:
            self._repeat_step()  # other answers may have been lost with sockets and board
        return data

    def _check_waited(self, waited: float, missing: set[int]) -> None:
        names = ', '.join(self._participants[k].name for k in sorted(missing))
        if self._should_stop() and waited >= STOP_GRACE_S:
            raise Interrupted(f'stopped in tick {self._tick}, which {names} did not end')
        if waited >= self._limits.tick_s:
            raise RunError(
                f'{names}: no answer to {self._awaited.step} after {waited:.1f} s, must come '
                f'within {self._limits.tick_s:g} s')

    def close(self) -> None:
        """Send the end of the run to the participants."""
        self._end()
        self._publisher.wait_for_all_acked(Duration(seconds=HELLO_PERIOD_S))

    def _end(self) -> None:
        self._send(encode_end(self._run_id))
        self._wires.close()
