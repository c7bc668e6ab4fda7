"""The one way to join a lockstep run."""

from collections.abc import Callable
import secrets
from typing import Any

from isa_ros.coordinator import Messages
from isa_ros.errors import SimulationDiverged
from isa_ros.nodes.qos import LOCKSTEP
from isa_ros.nodes.waiting import open_mailbox, SLICE_S
from isa_ros.nodes.wire import (
    ACKNOWLEDGEMENT_TOPIC, AnswerKind, decode_step, DIVERGENCE, encode_answer, Step, STEP_TOPIC,
    StepKind)
from isa_ros.stepping import Stepper
from rclpy.node import Node
from std_msgs.msg import UInt8MultiArray


class Participant:
    """
    Tick ``stepper`` whenever the coordinator asks, and answer.

    The coordinator knows a participant by the name of its node, and waits for it at every
    tick. A participant that is bound to a run answers no other coordinator until that run
    ends or its coordinator is gone.
    """

    def __init__(self, node: Node, stepper: Stepper) -> None:
        self._name = node.get_name()
        self._log = node.get_logger()
        self._stepper = stepper
        self._identity = secrets.token_bytes(8)
        self._mailbox = open_mailbox(node, STEP_TOPIC)
        self._publisher = node.create_publisher(UInt8MultiArray, ACKNOWLEDGEMENT_TOPIC, LOCKSTEP)
        handle: Any = self._publisher.handle
        self._send: Callable[[bytes], None] = handle.publish_raw
        self._strangers: set[int] = set()
        self._release()

    def _release(self) -> None:
        self._run_id = 0  # 0: bound to no run
        self._index = 0
        self._next_tick = 0
        self._is_actuator = False
        self._first: Messages = ()

    def spin(self, should_stop: Callable[[], bool]) -> None:
        """Take part in one run after the other until ``should_stop``."""
        while not should_stop():
            data = self._mailbox.wait(SLICE_S)
            if data is not None:
                self._handle(decode_step(data))
                continue
            self._stepper.serve()
            if self._run_id and not self._mailbox.count_senders():
                self._log.warning(
                    f'the coordinator is gone after {self._next_tick} ticks; waiting for another')
                self._release()

    def _handle(self, step: Step) -> None:
        if step.kind is StepKind.HELLO:
            self._answer_hello(step)
        elif step.run_id != self._run_id:
            self._answer_strange(step)
        elif step.kind is StepKind.TICK:
            self._answer_tick(step)
        else:
            self._release()

    def _answer_hello(self, step: Step) -> None:
        if step.run_id != self._run_id:
            if self._run_id and self._mailbox.count_senders() > 1:
                self._send(encode_answer(AnswerKind.BUSY, step.run_id, step.tick, 0, ()))
                return
            if not self._bind(step):
                return
        elif self._next_tick:
            return
        self._send(encode_answer(
            AnswerKind.READY, step.run_id, step.tick, self._index,
            (self._identity, self._stepper.digest.encode(), *self._first)))

    def _answer_strange(self, step: Step) -> None:
        """Give this name once to a run that goes on without it: another node may have it."""
        if step.kind is StepKind.TICK and not self._run_id and (
                step.run_id not in self._strangers):
            self._strangers.add(step.run_id)
            self._send(encode_answer(
                AnswerKind.UNBOUND, step.run_id, step.tick, 0, (self._name.encode(),)))

    def _bind(self, step: Step) -> bool:
        """Join the run of a hello; return whether it calls this participant."""
        self._release()
        names = step.names()
        if self._name not in names:
            if step.run_id not in self._strangers:
                self._strangers.add(step.run_id)
                self._log.warning(
                    f'a coordinator calls {", ".join(names)}, not {self._name!r}: '
                    'declare it in the configuration')
            return False
        self._run_id = step.run_id
        self._index = names.index(self._name)
        self._is_actuator = self._index < step.rows
        self._stepper.serve()
        self._first = self._stepper.start(
            step.start(self._index) if self._is_actuator else None)
        self._stepper.publish(self._first)
        return True

    def _answer_tick(self, step: Step) -> None:
        if step.tick != self._next_tick:
            self._answer(AnswerKind.REFUSED, step.tick, (
                f'tick {step.tick} came, {self._next_tick} was due'.encode(),))
            return
        self._next_tick += 1
        self._stepper.serve()
        port = command = None
        if self._is_actuator:
            port, command = step.port(self._index), step.command(self._index)
        try:
            messages = self._stepper.advance(step.tick, port, command)
        except SimulationDiverged as error:
            self._answer(AnswerKind.DIVERGED, step.tick, (
                DIVERGENCE.pack(error.t_ns, error.value), error.field.encode()))
            return
        reply = self._stepper.reply.tobytes() if self._is_actuator else None
        # The answer first: publishing goes on while the coordinator works.
        self._answer(AnswerKind.DONE, step.tick, (reply, *messages))
        self._stepper.publish(messages)

    def _answer(self, kind: AnswerKind, tick: int, parts: Messages) -> None:
        self._send(encode_answer(kind, self._run_id, tick, self._index, parts))
