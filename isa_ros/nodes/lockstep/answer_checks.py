"""What arrives from participants: discard what is not of the run, refuse what prevents it."""

from collections.abc import Sequence, Set
from typing import NamedTuple

from isa_ros.errors import ConfigError, RunError, SimulationDiverged
from isa_ros.nodes.lockstep.expected import Participants
from isa_ros.nodes.middleware.domain import another_coordinator_of
from isa_ros.processes.domain_id import DOMAIN_VARIABLE
from isa_ros.run.wire.answers import (
    ACKNOWLEDGEMENT_TOPIC, Answer, AnswerKind, decode_answer, DIGEST, DIVERGENCE, FIRST, IDENTITY)
from isa_ros.run.wire.header import WireError
from isa_ros.run.wire.parts import refuse_actuator_parts, refuse_requests
from rclpy.node import Node

WARNING_PERIOD_S = 10.0
_WITH_PARTS = {AnswerKind.READY: FIRST, AnswerKind.DONE: 0, AnswerKind.RESTORED: 0}
"""Kinds of answers with the parts of a role, and the first of these."""


class Awaited(NamedTuple):
    """The step that answers are waited for."""

    run_id: int
    number: int
    """Of the tick or of the request."""
    step: str
    """In words."""


class AnswerChecks:
    """Checks the answers that arrive at the coordinator ``node``."""

    def __init__(self, node: Node, participants: Participants) -> None:
        self._node = node
        self._run = participants
        self._participants = participants.expected
        self._remote = participants.remote
        self._unreported = {participant.name for participant in self._participants}
        self.identities: dict[int, bytes] = {}
        """Identity of the node of each participant that has answered."""

    def decoded(self, data: bytes, run_id: int) -> Answer | None:
        """Return an answer; None: the bytes are none of this run, and are discarded."""
        try:
            answer = decode_answer(data)
            if answer.run_id == run_id:
                self._refuse_misfit(answer)
        except WireError as error:
            self._node.get_logger().warning(
                f'a message on {self._node.resolve_topic_name(ACKNOWLEDGEMENT_TOPIC)} is '
                f'discarded: {error}',
                throttle_duration_sec=WARNING_PERIOD_S)
            return None
        return answer

    def _refuse_misfit(self, answer: Answer) -> None:
        """Refuse an answer of a participant that the run does not have, or with other parts."""
        if answer.participant >= len(self._participants):
            raise WireError(f'an answer of participant {answer.participant}')
        first = _WITH_PARTS.get(answer.kind)
        if first is None:
            return
        n_actuators = len(self._run.starts)
        if answer.participant < n_actuators:
            refuse_actuator_parts(answer.parts[first:])
        else:
            refuse_requests(answer.parts[first:], n_actuators)

    def is_ready(self, answer: Answer, run_id: int) -> bool:
        """Return whether an answer to a hello is ready; refuse those that prevent the run."""
        if answer.run_id != run_id or answer.kind is AnswerKind.BUSY:
            raise another_coordinator_of(self._node)
        self.refuse_failure(answer, 'to begin')
        if answer.kind is not AnswerKind.READY:
            return False
        name, expected = self._participants[answer.participant]
        identity, digest = answer.parts[IDENTITY] or b'', answer.parts[DIGEST] or b''
        if self.identities.setdefault(answer.participant, identity) != identity or (
                answer.participant not in self._remote):
            raise self.two_nodes(answer.participant)
        if expected and digest.decode() != expected:
            raise ConfigError(
                f'{name}: digest of its parameters = {digest.decode()}, must be {expected} as '
                'configured; start both with the same file')
        return True

    def is_awaited(
            self, answer: Answer, awaited: Awaited, kind: AnswerKind, missing: Set[int]) -> bool:
        """
        Return whether an answer is of a kind that is waited for; refuse what prevents the run.

        ``missing`` are the participants that have not answered yet. Raises as `refuse_failure`.
        """
        if answer.run_id != awaited.run_id or answer.kind is AnswerKind.BUSY:
            return False
        if answer.kind is AnswerKind.READY:
            self.is_ready(answer, awaited.run_id)
            return False
        if answer.kind is AnswerKind.UNBOUND:
            self.report_unbound(answer)
            return False
        if answer.tick != awaited.number or answer.participant not in missing:
            if answer.is_repeated:
                return False
            # A participant answers each step once.
            raise self.two_nodes(answer.participant)
        self.refuse_failure(answer, awaited.step)
        return answer.kind is kind

    def report_unbound(self, answer: Answer) -> None:
        """Log once a node outside the run with the name of a participant; the run goes on."""
        name = (answer.parts[0] or b'').decode()
        if name in self._unreported:
            self._unreported.remove(name)
            self._node.get_logger().warning(
                f'{name}: a second node of this name waits in {self._where()}; the run goes on '
                'with the first')

    def _where(self) -> str:
        domain = self._node.context.get_domain_id()
        return f'{DOMAIN_VARIABLE} {domain}, namespace {self._node.get_namespace()}'

    def refuse_failure(self, answer: Answer, step: str) -> None:
        """
        Raise the failure that an answer to a step reports.

        Raises
        ------
        SimulationDiverged
            A state of the participant is no longer finite.
        RunError
            The participant refused the step.

        """
        if answer.kind is AnswerKind.DIVERGED:
            t_ns, value = DIVERGENCE.unpack(answer.parts[0] or b'')
            raise SimulationDiverged(t_ns, (answer.parts[1] or b'').decode(), value)
        if answer.kind is AnswerKind.REFUSED:
            name, reason = self._participants[answer.participant].name, answer.parts[0] or b''
            raise RunError(f'{name}: refused {step}: {reason.decode()}')

    def two_nodes(self, participant: int) -> ConfigError:
        return ConfigError(
            f'{self._participants[participant].name}: two nodes of this name answer in '
            f'{self._where()}, must be one')

    def none_of(self, missing: Sequence[int], join_s: float) -> RunError:
        names = ', '.join(self._participants[k].name for k in missing)
        # A controller's node always joins; an actuator's may run alone instead.
        how = ' with lockstep:=true' if missing[0] < len(self._run.starts) else ''
        return RunError(
            f'{names}: no answer before tick 0 after {join_s:g} s; start it{how} in '
            f'this ROS_DOMAIN_ID and namespace, {self._node.get_namespace()}')
