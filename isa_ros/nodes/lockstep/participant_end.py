"""A participant's end of the private wire."""

from collections.abc import Callable, Sequence
import secrets
import time
from typing import Any

from isa_ros.errors import one_line
from isa_ros.nodes.lockstep.foreign_runs import ForeignRuns, WARNING_PERIOD_S
from isa_ros.nodes.lockstep.outcomes import outcome_of
from isa_ros.nodes.lockstep.roles import Role
from isa_ros.nodes.lockstep.sockets import LocalWire
from isa_ros.nodes.lockstep.steady_ticks import SteadyTicks
from isa_ros.nodes.lockstep.step_checks import refuse_misfit
from isa_ros.nodes.middleware.mailboxes import open_mailbox, SLICE_S, TOPIC_CHECK_S
from isa_ros.nodes.middleware.qos import LOCKSTEP
from isa_ros.run.wire.answering import Ended
from isa_ros.run.wire.answers import ACKNOWLEDGEMENT_TOPIC, AnswerKind, encode_answer
from isa_ros.run.wire.header import WireError
from isa_ros.run.wire.parts import Parts
from isa_ros.run.wire.steps import decode_step, Step, STEP_TOPIC, StepKind
from isa_ros.surroundings.kept_ports import has_ports
from rclpy.node import Node
from std_msgs.msg import UInt8MultiArray

SILENCE_S = 5.0
"""Time without a message after which a run counts as abandoned; a coordinator sends at least one
message per second, also while it waits or is paused."""


class ParticipantEnd:
    """
    Receives the steps of a coordinator, executes them with ``role`` and sends the answers.

    The coordinator identifies a participant by ``name``, by default that of its node, and waits
    for it at every tick. An actuator ``r1/kfe`` is the node kfe in r1, below the run's namespace.

    A participant that is bound to a run refuses other coordinators until that run ends or
    its coordinator has sent nothing for `SILENCE_S`; a later message of the same coordinator
    continues the run. The middleware's graph is not enough: it lists a killed node for a lease.

    ``ticks`` answers what comes on the wire and needs nothing else; None: all is done here.
    """

    def __init__(
            self, node: Node, role: Role, name: str = '',
            ticks: SteadyTicks | None = None) -> None:
        self._name = name or node.get_name()
        self._log = node.get_logger()
        self._role, self._ticks = role, ticks
        self._identity = secrets.token_bytes(8)
        path = f'{node.get_namespace().rstrip("/")}/{node.get_name()}'
        of_run = path.removesuffix(f'/{self._name}')
        self._topic = node.resolve_topic_name(f'{of_run}/{STEP_TOPIC}')
        self._mailbox = open_mailbox(node, self._topic)
        self._publisher = node.create_publisher(
            UInt8MultiArray, f'{of_run}/{ACKNOWLEDGEMENT_TOPIC}', LOCKSTEP)
        handle: Any = self._publisher.handle
        self._send: Callable[[bytes], None] = handle.publish_raw
        self._foreign = ForeignRuns(self._name, lambda answer: self._send(answer), self._log)
        self._wire: LocalWire | None = None
        self._next_check = 0.0
        self._unbind()

    def _unbind(self) -> None:
        self._close_wire()
        self._run_id = 0  # 0: bound to no run
        self._external: Sequence[str] = ()  # bodies of the run that any simulator may compute
        self._index = self._n_participants = self._next_tick = self._request = 0
        self._has_begun = self._is_abandoned = False
        self._first: Parts = ()
        self._answered: tuple[StepKind, int] | None = None  # kind and tick of a step
        self._last: tuple[AnswerKind, Parts | None] = AnswerKind.DONE, ()  # None: see ticks
        self._last_message = 0.0  # s, monotonic clock: last message of this run's coordinator

    def spin(self, should_stop: Callable[[], bool]) -> None:
        """Take part in one run after another until ``should_stop``."""
        try:
            self._spin(should_stop)
        finally:
            self._close_wire()

    def _spin(self, should_stop: Callable[[], bool]) -> None:
        while not should_stop():
            first, data = self._next_tick, self._next_step()
            if data is not None:
                self._receive(data)
            if data is not None or self._next_tick != first:
                continue
            self._role.serve()
            is_abandoned = bool(self._run_id) and not self._has_coordinator(
                self._mailbox.count_senders())
            if is_abandoned and not self._is_abandoned:
                computed = ''.join(f', or still computes body {name!r}' for name in self._external)
                self._log.warning(one_line(
                    f'the coordinator has ended or sent nothing for {SILENCE_S:g} s{computed}, '
                    f'after {self._next_tick} ticks; waiting for it or for another one'))
            self._is_abandoned = is_abandoned

    def _next_step(self) -> bytes | None:
        """Return the next message, or None if none arrives within `SLICE_S`."""
        wire, ticks = self._wire_in_use(), self._ticks
        are_next = ticks is not None and wire is not None and ticks.are_next
        if ticks is not None and ticks.has_step and not are_next:
            return ticks.take_step()
        if wire is None:
            return self._mailbox.wait(SLICE_S)
        if time.monotonic() >= self._next_check:
            if (data := self._mailbox.take()) is not None:
                return data
            self._next_check = time.monotonic() + TOPIC_CHECK_S
        data = wire.wait() if ticks is None else (
            self._after_ticks(ticks, wire) if are_next else ticks.wait(wire))
        if not wire.is_open:
            self._close_wire()
        return data

    def _after_ticks(self, ticks: SteadyTicks, wire: LocalWire) -> bytes | None:
        """Answer the ticks that need nothing else; return the message after them, if there is."""
        ended = ticks.run(wire, self._next_tick)
        if ticks.done:
            self._last_message = time.monotonic()
            self._next_tick += ticks.done
            ticks.end()
            last = Step(StepKind.TICK, self._run_id, self._next_tick - 1, 0, b'')
            self._answered, self._last = (last.kind, last.tick), (AnswerKind.DONE, None)
            if ended not in (Ended.UNSENT, Ended.BROKEN) or self._answer_to(
                    last, AnswerKind.DONE, ticks.parts):
                ticks.publish()
        if ended is Ended.NOTHING:
            ticks.publish_kept()
            return wire.take()
        return ticks.take_step() if ended is Ended.OTHER else None

    def _wire_in_use(self) -> LocalWire | None:
        """Return the socket to the coordinator, which uses it once the run has begun."""
        return self._wire if self._has_begun else None

    def _close_wire(self) -> None:
        if self._wire is not None:
            self._wire.close()
            self._wire = None

    def _has_coordinator(self, n_coordinators: int) -> bool:
        """Return whether there are coordinators and the run's own has sent a message recently."""
        return n_coordinators > 0 and time.monotonic() - self._last_message < SILENCE_S

    def _receive(self, data: bytes) -> None:
        """Handle a message; discard one that is not a step, or that does not fit its run."""
        if self._ticks is not None:
            self._ticks.publish_kept()
        try:
            step = decode_step(data)
            if step.run_id == self._run_id:
                refuse_misfit(step, self._role, self._n_participants)
        except WireError as error:
            self._log.warning(
                f'a message on {self._topic} is discarded: {error}',
                throttle_duration_sec=WARNING_PERIOD_S)
            return
        self._handle(step)
        if self._ticks is not None:
            self._learn(self._ticks, step)

    def _learn(self, ticks: SteadyTicks, step: Step) -> None:
        """Leave steps like this one to ``ticks`` if it is a tick that was executed."""
        if step.run_id == self._run_id and self._answered == (step.kind, step.tick) and (
                self._last[0] is AnswerKind.DONE):
            ticks.expect(step, self._index)
        elif step.run_id != self._run_id or step.kind is not StepKind.BEGIN:    # that it goes on
            ticks.forget()

    def _handle(self, step: Step) -> None:
        if step.run_id == self._run_id:
            self._last_message = time.monotonic()
        if step.kind is StepKind.HELLO:
            self._answer_hello(step)
        elif step.run_id != self._run_id:
            if not self._run_id:
                self._foreign.answer(step)
        elif self._answered == (step.kind, step.tick):
            self._repeat(step)
        elif self._is_past(step):
            pass  # a repetition on the topic, older than the last step on the socket
        elif step.kind is StepKind.TICK:
            self._answer_tick(step)
        elif step.kind is StepKind.BEGIN:
            self._begin_with(step)
        elif step.kind is StepKind.SAVE:
            self._answer_to(step, AnswerKind.SAVED, lambda: (self._role.snapshot(),))
        elif step.kind is StepKind.CHANGE:
            self._answer_to(step, AnswerKind.CHANGED, lambda: self._role.change(
                step.changes(self._index)))
        elif step.kind is StepKind.RESTORE:
            self._next_tick = step.restored_tick()
            self._answer_to(step, AnswerKind.RESTORED,
                            lambda: self._role.restore(step.snapshot(self._index)))
        else:
            self._unbind()

    def _is_past(self, step: Step) -> bool:
        if step.kind is StepKind.TICK:
            return step.tick < self._next_tick
        return step.tick >= self._request and step.kind in (
            StepKind.SAVE, StepKind.RESTORE, StepKind.CHANGE)

    def _answer_hello(self, step: Step) -> None:
        if step.run_id != self._run_id:
            if self._run_id and self._has_coordinator(self._mailbox.count_senders() - 1):
                self._send(encode_answer(AnswerKind.BUSY, step.run_id, step.tick, 0, ()))
                return
            if not self._bind(step):
                return
        elif self._has_begun:
            return
        self._send(encode_answer(
            AnswerKind.READY, step.run_id, step.tick, self._index,
            (self._identity, self._role.digest, *self._first)))

    def _bind(self, step: Step) -> bool:
        """Join the run of a hello; return whether it lists this participant, which starts."""
        self._unbind()
        roster = step.roster()
        names = list(roster.names)
        if self._name not in (names[:step.rows] if self._role.is_actuator else names[step.rows:]):
            self._foreign.warn(step, names, self._role.is_actuator)
            return False
        self._run_id, self._last_message = step.run_id, time.monotonic()
        self._index, self._n_participants = names.index(self._name), len(names)
        self._external = [name for name, record in roster.bodies.items() if has_ports(record)]
        self._wire = LocalWire.to_run(self._run_id, self._identity, SLICE_S)
        self._role.serve()
        outcome = outcome_of(AnswerKind.READY, lambda: self._role.start(step, self._index))
        self._first = outcome.parts
        if outcome.kind is AnswerKind.READY:
            return True
        self._send(encode_answer(
            outcome.kind, step.run_id, step.tick, self._index, outcome.parts))
        self._unbind()
        if outcome.error is not None:
            raise outcome.error
        return False

    def _begin_with(self, step: Step) -> None:
        """Begin, or leave the run if another node of this name has answered its hellos first."""
        if step.identity(self._index) == self._identity:
            self._begin()
        else:
            self._unbind()
            self._foreign.answer(step)

    def _begin(self) -> None:
        if not self._has_begun:
            self._has_begun = True
            if self._wire is not None:
                self._wire.welcomed()
            self._role.publish()

    def _repeat(self, step: Step) -> None:
        """Send the last answer again: it, or the first request, may have been lost."""
        kind, parts = self._last
        if parts is None:
            parts = self._ticks.parts() if self._ticks is not None else ()
        self._send_answer(encode_answer(
            kind, self._run_id, step.tick, self._index, parts, is_repeated=True))

    def _answer_tick(self, step: Step) -> None:
        self._begin()
        if step.tick != self._next_tick:
            self._answer(step, AnswerKind.REFUSED, (
                f'tick = {step.tick}, must be {self._next_tick}'.encode(),))
            return
        self._next_tick += 1
        self._role.serve()
        # The answer first: the coordinator computes while this process publishes.
        if self._answer_to(step, AnswerKind.DONE, lambda: self._role.advance(step)):
            self._role.publish()

    def _answer_to(self, step: Step, kind: AnswerKind, work: Callable[[], Parts]) -> bool:
        """
        Answer with the result of ``work``, or with the reason of its failure.

        Exceptions other than `IsaError` are also sent to the coordinator, then end this process.
        """
        outcome = outcome_of(kind, work)
        self._answer(step, outcome.kind, outcome.parts)
        if outcome.error is not None:
            raise outcome.error
        return outcome.kind is kind

    def _answer(self, step: Step, kind: AnswerKind, parts: Parts) -> None:
        self._answered, self._last = (step.kind, step.tick), (kind, parts)
        self._request = min(self._request, step.tick)   # numbers of requests decrease
        self._send_answer(encode_answer(kind, self._run_id, step.tick, self._index, parts))

    def _send_answer(self, answer: bytes) -> None:
        """Send an answer to the coordinator on the socket, or else on the topic."""
        wire = self._wire_in_use()
        if wire is None or not wire.send(answer):
            self._send(answer)
