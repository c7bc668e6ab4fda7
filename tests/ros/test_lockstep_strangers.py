"""
Steps and answers that do not belong into a tick, handed to each end of the wire one by one.

Both ends have a real node but no partner: what arrives is put into their mailbox in the order
of the test, so that no race of the middleware decides.
"""


from isa_ros.core.signals import COMMAND, LOAD_REPLY, SAMPLE, START
from isa_ros.errors import ConfigError
from isa_ros.nodes.lockstep.coordinator_end import LockstepTransport
from isa_ros.nodes.lockstep.expected import Expected, Limits, Participants
from isa_ros.run.wire.answers import AnswerKind, encode_answer
from isa_ros.run.wire.parts import actuator_parts
from isa_ros.run.wire.roster import Roster
from isa_ros.run.wire.steps import (
    encode_begin, encode_change, encode_end, encode_hello, encode_restore, encode_save,
    encode_tick)
from isa_ros.tick.exchange import Rows
import numpy as np
import pytest
from rclpy.node import Node
from tests.ros.lockstep.participants import Outside, rows_of_two
from tests.ros.lone_participant import done, NAMES, Post, ROSTER, RUN, tick
from tests.ros.started import DEADLINE_S

pytestmark = pytest.mark.ros

LIMITS = Limits(join_s=DEADLINE_S, tick_s=0.05)


def test_a_repeat_of_the_last_step_is_answered_again_without_another_tick(member):
    assert member.answers_to(tick(0), tick(0)) == [done(0), done(0, is_repeated=True)]
    assert member.answers[-1].parts == member.answers[-2].parts
    assert member.role.ticks == 1


def test_a_repeat_that_a_newer_tick_has_overtaken_is_dropped(member):
    """It is a copy on the slower topic: an answer, or a refusal, would end the run."""
    assert member.answers_to(tick(0), tick(1), tick(0)) == [done(0), done(1)]
    assert member.role.ticks == 2
    assert member.answers_to(tick(2)) == [done(2)]


def test_an_overtaken_request_to_save_is_dropped(member):
    """Requests count down: -1 again after -2 or after a tick is an old one."""
    saved = [encode_save(RUN, number) for number in (-1, -2)]
    assert member.answers_to(tick(0), *saved, saved[0]) == [
        done(0), (AnswerKind.SAVED, -1, False), (AnswerKind.SAVED, -2, False)]
    assert member.answers_to(tick(1), saved[1]) == [done(1)]
    assert member.role.snapshots == 2


def test_an_overtaken_request_to_restore_is_dropped(member):
    """Else a run that went on after it would be put back."""
    restore = encode_restore(RUN, -1, 5, [b'after 5', b'after 5'])
    assert member.answers_to(restore, tick(5), restore) == [
        (AnswerKind.RESTORED, -1, False), done(5)]
    assert member.role.ticks == 6


def test_a_tick_of_another_run_moves_no_actuator(member):
    assert member.answers_to(tick(0, run=RUN + 1), encode_end(RUN + 1)) == []
    assert member.role.ticks == 0
    assert member.answers_to(tick(0)) == [done(0)]


def altered(message: bytes, at: int, value: bytes) -> bytes:
    """Return a message with other bytes at one place."""
    return message[:at] + value + message[at + len(value):]


KIND, BODY_OF_A_STEP, INDEX, N_PARTS, BODY_OF_AN_ANSWER = 18, 40, 20, 24, 48
NAN = np.float64('nan').tobytes()
ODD_STEPS = {
    'sixteen bytes': bytes(16), 'nothing': b'', 'kind 99': altered(tick(0), KIND, b'\x63'),
    'cut': tick(0)[:-1], 'not finite': altered(tick(0), BODY_OF_A_STEP + 80, NAN),
    'another version': altered(tick(0), KIND - 2, b'\x63'),
    'a hello without names': encode_hello(RUN + 1, 1, 1_000_000, np.zeros(2, START), ROSTER)[:-9],
    'a begin of others': encode_begin(RUN, [b'another']),
    'a change of others': encode_change(RUN, -1, {}, 1),
    'a save of others': encode_restore(RUN, -1, 5, [b'after 5']),
    'a tick of one actuator': encode_tick(RUN, 0, Rows(1, Outside(False)), has_controllers=False)}


@pytest.mark.parametrize('odd', ODD_STEPS)
def test_an_odd_step_is_discarded_and_the_run_goes_on(member, odd):
    assert member.answers_to(ODD_STEPS[odd], tick(0), ODD_STEPS[odd], tick(1)) == [
        done(0), done(1)]
    assert member.role.ticks == 2


def test_the_first_messages_are_published_once_however_often_a_run_begins(member):
    """A begin comes again while a run has no ticks on the topic."""
    again = encode_begin(RUN, [None, member.identity])
    assert member.answers_to(again, again) == [] and member.role.published == 1
    assert member.answers_to(tick(0), again, tick(1)) == [done(0), done(1)]
    assert member.role.published == 3   # and those of two ticks


def test_a_second_node_of_a_name_leaves_the_run_that_begins_with_the_first(member):
    """Its answer to the hello was lost or late; it gives its name, and advances with no tick."""
    assert member.answers_to(
        encode_end(RUN), encode_hello(RUN + 1, 1, 1_000_000, np.zeros(2, START), ROSTER),
        encode_begin(RUN + 1, [None, b'the first'])) == [
            (AnswerKind.READY, 1, False), (AnswerKind.UNBOUND, 0, False)]
    assert member.answers[-1].parts == [b'kfe']
    assert member.answers_to(tick(0, RUN + 1)) == []    # it has said so a moment ago
    assert member.role.ticks == 0


def test_a_run_with_this_node_in_another_role_is_not_joined(member):
    """Its row would be read beyond those of the actuators."""
    others = Roster(['haa', 'hfe', 'kfe'], ['supply'], {})
    assert member.answers_to(
        encode_end(RUN), encode_hello(RUN + 1, 1, 1_000_000, np.zeros(2, START), others)) == []


def answer(
        participant: int, number: int, force: float, run: int = RUN,
        kind: AnswerKind = AnswerKind.DONE, is_repeated: bool = False) -> bytes:
    """Return the answer of an actuator to a tick."""
    reply = np.zeros(1, LOAD_REPLY)
    reply['force'] = force
    parts = actuator_parts(reply, np.zeros(1, SAMPLE), np.zeros(1, COMMAND), {})
    return encode_answer(kind, run, number, participant, parts, is_repeated)


class Coordination:
    """A coordinator's end in the middle of a run, whose participants are the test."""

    def __init__(self, node: Node, monkeypatch: pytest.MonkeyPatch) -> None:
        self._transport = LockstepTransport(
            node, Participants([Expected(name, 'same') for name in NAMES], ROSTER,
                               np.zeros(2, START), 1_000_000),
            LIMITS, watch=lambda: None, should_stop=lambda: False)
        self._post = Post()
        monkeypatch.setattr(self._transport, '_mailbox', self._post)
        monkeypatch.setattr(self._transport, '_run_id', RUN)

    def forces(self, number: int, *answers: bytes) -> list[float]:
        """Return the forces of tick ``number`` when these answers arrive in this order."""
        rows: Rows = rows_of_two()
        self._transport.send(number, rows)
        self._post.messages.extend(answers)
        self._transport.receive(rows)
        assert not self._post.messages
        forces: list[float] = rows.replies['force'].tolist()
        return forces


@pytest.fixture
def coordination(observer: Node, monkeypatch: pytest.MonkeyPatch) -> Coordination:
    """Return a coordinator's end."""
    return Coordination(observer, monkeypatch)


def odd_answers() -> dict[str, bytes]:
    """Return what no participant answers to tick 3."""
    good = answer(0, 3, 1.0)
    return {
        'sixteen bytes': bytes(16), 'nothing': b'', 'kind 99': altered(good, KIND, b'\x63'),
        'a million parts': altered(good, N_PARTS, (10**6).to_bytes(4, 'little')),
        'participant 7': altered(good, INDEX, b'\x07'), 'cut': good[:-1],
        'another version': altered(good, KIND - 2, b'\x63'),
        'not finite': altered(good, BODY_OF_AN_ANSWER + 8, NAN),
        'no rows': encode_answer(AnswerKind.DONE, RUN, 3, 0, [b'', None]),
        'no identity': encode_answer(AnswerKind.READY, RUN, 3, 0, [None, b'same']),
        'no text': encode_answer(AnswerKind.REFUSED, RUN, 3, 0, [b'\xff']),
        'a divergence without time': encode_answer(AnswerKind.DIVERGED, RUN, 3, 0, [b'', b'x']),
        'a state': encode_answer(AnswerKind.SAVED, RUN, 3, 0, [b''])}


@pytest.mark.parametrize('odd', odd_answers())
def test_an_odd_answer_is_discarded_and_the_run_goes_on(coordination, odd):
    """The true answer of the participant is still waited for."""
    message = odd_answers()[odd]
    assert coordination.forces(
        3, message, answer(1, 3, 2.0), message, answer(0, 3, 1.0)) == [1.0, 2.0]


def test_the_answer_of_another_run_is_not_taken_for_this_ones(coordination):
    """Same tick, same participant: the run's id alone tells them apart."""
    assert coordination.forces(
        3, answer(0, 3, -99.0, run=RUN + 1), answer(1, 3, 2.0), answer(0, 3, 1.0)) == [1.0, 2.0]


def test_the_answer_of_another_run_is_not_a_second_node(coordination):
    """Also where this run's own answer came first."""
    assert coordination.forces(
        3, answer(0, 3, 1.0), answer(0, 3, -99.0, run=RUN + 1), answer(1, 3, 2.0)) == [1.0, 2.0]


def test_two_nodes_that_answer_one_step_are_refused(coordination):
    """Both bound, of one name: the run has two states of one actuator."""
    with pytest.raises(ConfigError, match='haa: two nodes of this name answer'):
        coordination.forces(3, answer(0, 3, 1.0), answer(0, 3, 1.5), answer(1, 3, 2.0))


def test_an_answer_to_a_step_that_is_not_awaited_is_refused(coordination):
    """One node answers each step once, and only when asked."""
    with pytest.raises(ConfigError, match='kfe: two nodes of this name answer'):
        coordination.forces(3, answer(1, 2, 2.0), answer(0, 3, 1.0), answer(1, 3, 2.0))


def test_an_answer_given_again_is_not_a_second_node(coordination):
    """A repeat is marked as one: the first may have been lost, or not."""
    assert coordination.forces(
        3, answer(0, 2, 7.0, is_repeated=True), answer(0, 3, 1.0),
        answer(0, 3, 1.0, is_repeated=True), answer(1, 3, 2.0, is_repeated=True)) == [1.0, 2.0]
