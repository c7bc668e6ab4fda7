"""A participant's end of the private wire."""

from collections.abc import Callable
import secrets
import time
from typing import Any

from isa_ros.errors import IsaError, SimulationDiverged
from isa_ros.nodes.lockstep.roles import Parts, Role
from isa_ros.nodes.lockstep.sockets import LocalWire
from isa_ros.nodes.middleware.mailboxes import LOOK_S, open_mailbox, SLICE_S
from isa_ros.nodes.middleware.qos import LOCKSTEP
from isa_ros.run.wire import (
    ACKNOWLEDGEMENT_TOPIC, AnswerKind, decode_step, DIVERGENCE, encode_answer, Step, STEP_TOPIC,
    StepKind)
from rclpy.node import Node
from std_msgs.msg import UInt8MultiArray

SILENCE_S = 5.0
"""After it a coordinator counts as gone; one that waits or is paused speaks each second."""


class ParticipantEnd:
    """
    Let ``role`` take part whenever the coordinator asks, and answer.

    The coordinator knows a participant by the name of its node, and waits for it at every tick.
    One that is bound to a run answers no other coordinator until that run ends or its
    coordinator has been silent for `SILENCE_S`; one that only seemed to be gone goes on with
    its run. The middleware knows less: a killed one stays in its graph for a lease.
    """

    def __init__(self, node: Node, role: Role) -> None:
        self._name = node.get_name()
        self._log = node.get_logger()
        self._role = role
        self._identity = secrets.token_bytes(8)
        self._mailbox = open_mailbox(node, STEP_TOPIC)
        self._publisher = node.create_publisher(UInt8MultiArray, ACKNOWLEDGEMENT_TOPIC, LOCKSTEP)
        handle: Any = self._publisher.handle
        self._send: Callable[[bytes], None] = handle.publish_raw
        self._strangers: set[int] = set()
        self._wire: LocalWire | None = None
        self._look_at = 0.0
        self._release()

    def _release(self) -> None:
        self._close_wire()
        self._run_id = 0  # 0: bound to no run
        self._index = 0
        self._next_tick = 0
        self._request = 0  # the last one; their numbers fall
        self._has_begun = False
        self._first: Parts = ()
        self._answered: tuple[StepKind, int] | None = None  # kind and tick of a step
        self._last: tuple[AnswerKind, Parts] = AnswerKind.DONE, ()
        self._heard = 0.0  # when the coordinator of this run spoke, on the host's monotonic clock
        self._is_alone = False

    def spin(self, should_stop: Callable[[], bool]) -> None:
        """Take part in one run after the other until ``should_stop``."""
        try:
            self._spin(should_stop)
        finally:
            self._close_wire()

    def _spin(self, should_stop: Callable[[], bool]) -> None:
        while not should_stop():
            data = self._next_step()
            if data is not None:
                self._handle(decode_step(data))
                continue
            self._role.serve()
            is_alone = bool(self._run_id) and not self._is_led(self._mailbox.count_senders())
            if is_alone and not self._is_alone:
                self._log.warning(
                    f'the coordinator is gone or silent after {self._next_tick} ticks; waiting '
                    'for it or for another')
            self._is_alone = is_alone

    def _next_step(self) -> bytes | None:
        """Return the next message, or None if none arrives within `SLICE_S`."""
        wire = self._wire_in_use()
        if wire is None:
            return self._mailbox.wait(SLICE_S)
        if time.monotonic() >= self._look_at:
            if (data := self._mailbox.take()) is not None:
                return data
            self._look_at = time.monotonic() + LOOK_S
        data = wire.wait()
        if not wire.is_open:
            self._close_wire()
        return data

    def _wire_in_use(self) -> LocalWire | None:
        """Return the socket to the coordinator, which waits at its own end once it has begun."""
        return self._wire if self._has_begun else None

    def _close_wire(self) -> None:
        if self._wire is not None:
            self._wire.close()
            self._wire = None

    def _is_led(self, n_coordinators: int) -> bool:
        """Return whether the coordinator of the run may be there and has spoken not long ago."""
        return n_coordinators > 0 and time.monotonic() - self._heard < SILENCE_S

    def _handle(self, step: Step) -> None:
        if step.run_id == self._run_id:
            self._heard = time.monotonic()
        if step.kind is StepKind.HELLO:
            self._answer_hello(step)
        elif step.run_id != self._run_id:
            self._answer_strange(step)
        elif self._answered == (step.kind, step.tick):
            self._repeat(step)
        elif self._is_past(step):
            pass  # a repeat on the topic that newer steps on the socket have overtaken
        elif step.kind is StepKind.TICK:
            self._answer_tick(step)
        elif step.kind is StepKind.BEGIN:
            self._begin()
        elif step.kind is StepKind.SAVE:
            self._answer_to(step, AnswerKind.SAVED, lambda: (self._role.snapshot(),))
        elif step.kind is StepKind.RESTORE:
            self._next_tick = step.restored_tick()
            self._answer_to(step, AnswerKind.RESTORED,
                            lambda: self._role.restore(step.snapshot(self._index)))
        else:
            self._release()

    def _is_past(self, step: Step) -> bool:
        if step.kind is StepKind.TICK:
            return step.tick < self._next_tick
        if step.kind in (StepKind.SAVE, StepKind.RESTORE):
            return step.tick >= self._request
        return False

    def _answer_hello(self, step: Step) -> None:
        if step.run_id != self._run_id:
            if self._run_id and self._is_led(self._mailbox.count_senders() - 1):
                self._send(encode_answer(AnswerKind.BUSY, step.run_id, step.tick, 0, ()))
                return
            if not self._bind(step):
                return
        elif self._has_begun:
            return
        self._send(encode_answer(
            AnswerKind.READY, step.run_id, step.tick, self._index,
            (self._identity, self._role.digest, *self._first)))

    def _answer_strange(self, step: Step) -> None:
        """Give this name once to a run that goes on without it: another node may have it."""
        if step.kind in (StepKind.TICK, StepKind.BEGIN) and not self._run_id and (
                step.run_id not in self._strangers):
            self._strangers.add(step.run_id)
            self._send(encode_answer(
                AnswerKind.UNBOUND, step.run_id, step.tick, 0, (self._name.encode(),)))

    def _bind(self, step: Step) -> bool:
        """Join the run of a hello; return whether it calls this participant."""
        self._release()
        names = step.cast().names
        if self._name not in names:
            if step.run_id not in self._strangers:
                self._strangers.add(step.run_id)
                self._log.warning(
                    f'a coordinator calls {", ".join(names)}, not {self._name!r}: '
                    'declare it in the configuration')
            return False
        self._run_id, self._heard = step.run_id, time.monotonic()
        self._index = names.index(self._name)
        self._wire = LocalWire.to_run(self._run_id, self._identity, SLICE_S)
        self._role.serve()
        self._first = self._role.start(step, self._index)
        return True

    def _begin(self) -> None:
        if not self._has_begun:
            self._has_begun = True
            self._role.publish()

    def _repeat(self, step: Step) -> None:
        """Say once more what was said: the answer, or the first request, may have been lost."""
        kind, parts = self._last
        self._say(encode_answer(
            kind, self._run_id, step.tick, self._index, parts, is_repeated=True))

    def _answer_tick(self, step: Step) -> None:
        self._begin()
        if step.tick != self._next_tick:
            self._answer(step, AnswerKind.REFUSED, (
                f'tick {step.tick} came, {self._next_tick} was due'.encode(),))
            return
        self._next_tick += 1
        self._role.serve()
        # The answer first: publishing goes on while the coordinator works.
        if self._answer_to(step, AnswerKind.DONE, lambda: self._role.advance(step)):
            self._role.publish()

    def _answer_to(self, step: Step, kind: AnswerKind, work: Callable[[], Parts]) -> bool:
        """
        Answer with what ``work`` gives, or with why it gives nothing.

        Whatever else it raises is told to the coordinator too, and then ends this process.
        """
        try:
            parts = work()
        except SimulationDiverged as error:
            self._answer(step, AnswerKind.DIVERGED, (
                DIVERGENCE.pack(error.t_ns, error.value), error.field.encode()))
            return False
        except IsaError as error:
            self._answer(step, AnswerKind.REFUSED, (str(error).encode(),))
            return False
        except BaseException as error:
            self._answer(step, AnswerKind.REFUSED, (
                f'{type(error).__name__}: {error}'.encode(),))
            raise
        self._answer(step, kind, parts)
        return True

    def _answer(self, step: Step, kind: AnswerKind, parts: Parts) -> None:
        self._answered, self._last = (step.kind, step.tick), (kind, parts)
        self._request = min(self._request, step.tick)
        self._say(encode_answer(kind, self._run_id, step.tick, self._index, parts))

    def _say(self, answer: bytes) -> None:
        """Answer the coordinator of the run where it waits."""
        wire = self._wire_in_use()
        if wire is None or not wire.send(answer):
            self._send(answer)
