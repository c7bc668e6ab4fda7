"""The private wire: altered steps at a participant's end, altered answers at the coordinator's."""

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
import random
from types import SimpleNamespace
from typing import Any
from unittest.mock import patch

from isa_ros.actuator.rows import memory_of
from isa_ros.controller import Controller, Setpoint, State
from isa_ros.core.device import MODES
from isa_ros.core.signals import (
    COMMAND, EVERY_KIND, HAS_GAINS, HAS_MODE, HAS_REFERENCE, HAS_SETPOINT, LOAD_REPLY, SAMPLE,
    START)
from isa_ros.nodes.lockstep import participant_end
from isa_ros.nodes.lockstep.answer_checks import AnswerChecks
from isa_ros.nodes.lockstep.expected import Expected, Participants
from isa_ros.nodes.lockstep.participant_end import ParticipantEnd
from isa_ros.nodes.lockstep.roles import ActuatorRole, ControllerRole
from isa_ros.requests import merge_requests
from isa_ros.run.wire.answers import AnswerKind, encode_answer, FIRST
from isa_ros.run.wire.parts import actuator_parts, take_actuator_parts
from isa_ros.run.wire.roster import Roster
from isa_ros.run.wire.steps import (
    encode_begin, encode_change, encode_end, encode_hello, encode_restore, encode_save,
    encode_tick)
from isa_ros.surroundings.bodies.leg.port_kernel import LEG_SAMPLE
from isa_ros.surroundings.supply_sample import SUPPLY_SAMPLE
from isa_ros.tick.exchange import Rows
import numpy as np
from tests.fuzz.bytes_of import altered
from tests.fuzz.property import refused

RUN = 4711
NAMES = ['haa', 'kfe', 'sway']
ROSTER = Roster(NAMES, ['supply'], {'body': LEG_SAMPLE})
N_ACTUATORS = 2


class Outside:
    """Surroundings of which only what they show matters."""

    def __init__(self) -> None:
        self.supplies = np.zeros(1, SUPPLY_SAMPLE)
        self.has_supply_ports = False
        self.bodies = {'body': SimpleNamespace(sample=np.zeros(1, LEG_SAMPLE))}


class StrictActuator:
    """An actuator, and its node, that accepts finite numbers only."""

    digest = 'same'
    applied_parameters = {'force.kp': 1e-7}

    def __init__(self) -> None:
        self.actuator, self.memory = self, memory_of(1)

    def tune(self, values: Mapping[str, float]) -> None:
        """Take new values."""
        assert_finite(list(values.values()))

    def start(self, *start: float) -> None:
        """Take a start."""
        assert_finite(start)

    def accept(self, command: np.void) -> None:
        """Take a command."""
        assert_command(command)

    def tick(self, port: np.void) -> None:
        """Take a tick."""
        assert_finite(port.item())

    def publish(self) -> None:
        """Publish nothing."""

    def serve(self) -> None:
        """Take nothing."""

    def snapshot(self) -> bytes:
        """Return any state."""
        return b'state'

    def restore(self, snapshot: bytes) -> None:
        """Take any state: the actuator checks its own."""


class Sway(Controller):
    """A controller that accepts finite numbers only."""

    def step(self, state: State) -> dict[str, Setpoint]:
        """Take a state."""
        for sample in (*state.actuators.values(), *state.supplies.values()):
            assert_finite(sample.item())
        for body in state.bodies.values():
            assert_finite(body['height'].item())
            assert np.isfinite(body['position']).all()
        return {'kfe': Setpoint(0.05)}

    def snapshot(self) -> bytes:
        """Return any state."""
        return b'state'

    def restore(self, snapshot: bytes) -> None:
        """Take any state."""


def assert_finite(values: Sequence[float]) -> None:
    """Assert that no number is infinite or NaN."""
    assert np.isfinite(values).all(), values


def assert_command(command: np.void) -> None:
    """Assert that a command is one that an actuator can execute."""
    kinds = int(command['kinds'])
    assert kinds <= EVERY_KIND
    if kinds & (HAS_MODE | HAS_REFERENCE):
        assert 0 < command['mode'] < len(MODES)
    if kinds & HAS_REFERENCE:
        assert_finite([command['reference']])
    if kinds & 1:
        assert_finite([command[name] for name in ('position', 'velocity', 'effort')])
    if kinds & (HAS_SETPOINT | HAS_GAINS):
        assert not any(command[name] < 0.0 or np.isinf(command[name])
                       for name in ('stiffness', 'damping'))


def _rows() -> Rows:
    return Rows(N_ACTUATORS, Outside())  # type: ignore[arg-type]


def steps() -> list[bytes]:
    """Return every kind of step."""
    starts, rows = np.zeros(N_ACTUATORS, START), _rows()
    rows.commands['kinds'] = 7
    return [
        encode_hello(RUN, 2, 1_000_000, starts, ROSTER),
        encode_hello(RUN + 1, 1, 1_000_000, starts, ROSTER),
        encode_begin(RUN, [b'one', None, b'three']),
        encode_tick(RUN, 0, rows, True), encode_tick(RUN, 1, rows, True),
        encode_tick(RUN, 1, rows, True), encode_save(RUN, -1),
        encode_restore(RUN, -2, 5, [b'one', b'two', b'three']),
        encode_change(RUN, -3, {0: {'plant.spool.stuck': 1.0}, 1: {'force.kp': 1e-7}}, 3),
        encode_tick(RUN, 5, rows, True), encode_end(RUN)]


def answers() -> list[bytes]:
    """Return every kind of answer."""
    applied = np.zeros(1, COMMAND)
    applied['kinds'] = 3
    own = actuator_parts(
        np.zeros(1, LOAD_REPLY), np.zeros(1, SAMPLE), applied, {'force.kp': 1e-7})
    requests = [np.repeat(applied, N_ACTUATORS).tobytes()]
    of = {AnswerKind.READY: [b'identity', b'same', *own], AnswerKind.BUSY: [],
          AnswerKind.DIVERGED: [bytes(16), b'plant'], AnswerKind.REFUSED: [b'why'],
          AnswerKind.UNBOUND: [b'knee'], AnswerKind.SAVED: [b'state'],
          AnswerKind.CHANGED: []}
    found = [encode_answer(kind, RUN, 3, 1, parts) for kind, parts in of.items()]
    for kind in (AnswerKind.DONE, AnswerKind.DONE, AnswerKind.RESTORED):
        found += [encode_answer(kind, RUN, 3, 1, own), encode_answer(kind, RUN, 3, 2, requests)]
    return found


LOG = SimpleNamespace(warning=lambda text, **_: assert_line(text))


def assert_line(text: str) -> None:
    """Assert that a warning is one short line."""
    assert text.isprintable() and len(text) < 2000, text


class Node:
    """A node of which only the log and the domain matter."""

    context = SimpleNamespace(get_domain_id=lambda: 0)

    def __init__(self, name: str) -> None:
        self.get_name = lambda: name
        self.get_namespace = lambda: '/'
        self.resolve_topic_name = lambda topic: f'/{topic}'

    def get_logger(self) -> Any:
        """Return a log that accepts short lines."""
        return LOG

    def create_publisher(self, *_: Any) -> Any:
        """Return a publisher that discards everything."""
        return SimpleNamespace(handle=SimpleNamespace(publish_raw=lambda data: None))


MAILBOX = SimpleNamespace(count_senders=lambda: 1)
PARTICIPANTS = Participants(
    [Expected(name, '') for name in NAMES], ROSTER, np.zeros(N_ACTUATORS, START), 1_000_000)


def participant(dice: random.Random) -> ParticipantEnd:
    """Return an actuator or a controller that has executed one tick of a run."""
    is_actuator = dice.random() < 0.6
    end = ParticipantEnd(
        Node('kfe' if is_actuator else 'sway'),  # type: ignore[arg-type]
        ActuatorRole(StrictActuator()) if is_actuator else ControllerRole(Sway()))
    end._receive(encode_hello(RUN, 1, 1_000_000, np.zeros(N_ACTUATORS, START), ROSTER))
    end._receive(encode_tick(RUN, 0, _rows(), True))
    return end


def take(data: bytes) -> None:
    """Take an answer as the coordinator does."""
    node: Any = Node('coordinator')
    checks, rows = AnswerChecks(node, PARTICIPANTS), _rows()
    answer = checks.decoded(data, RUN)
    if answer is None or answer.run_id != RUN:
        return
    checks.is_ready(answer, RUN)
    first = {AnswerKind.READY: FIRST, AnswerKind.DONE: 0, AnswerKind.RESTORED: 0}.get(answer.kind)
    if first is None:
        return
    if answer.participant < N_ACTUATORS:
        take_actuator_parts(answer.parts[first:], answer.participant, rows)
        assert_finite(rows.reply_values.ravel())
        assert_finite(rows.sample_values.ravel())
        assert_command(rows.applied[answer.participant])
        assert_finite(list(rows.tuned.get(answer.participant, {}).values()))
    else:
        merge_requests(np.frombuffer(answer.parts[first] or b'', COMMAND), rows.requests)
        for command in rows.requests:
            assert_command(command)


def fuzz(cases: int, seed: int) -> int:
    """Hand over that many altered messages; return how many ended with an error of a user."""
    dice, n_refused = random.Random(seed), 0
    all_steps, all_answers = steps(), answers()
    with ExitStack() as stack:
        stack.enter_context(patch.object(participant_end, 'open_mailbox', lambda *_: MAILBOX))
        stack.enter_context(patch.object(participant_end.LocalWire, 'to_run', lambda *_: None))
        for k in range(cases):
            case = f'case {k} of seed {seed}'
            if k % 2:
                step, end = altered(dice.choice(all_steps), dice), participant(dice)
                n_refused += refused(lambda: end._receive(step), f'{case}, step {step!r}')
            else:
                answer = altered(dice.choice(all_answers), dice)
                n_refused += refused(lambda: take(answer), f'{case}, answer {answer!r}')
    return n_refused
