"""Whose run an actuator takes part in, and what it looks at before a tick."""

from types import SimpleNamespace

from isa_ros.core.signals import START
from isa_ros.errors import SetpointError
from isa_ros.run.wire.answers import AnswerKind
from isa_ros.run.wire.steps import encode_hello
import numpy as np
import pytest
from tests.ros.lone_participant import done, Post, ROSTER, RUN, tick

pytestmark = pytest.mark.ros


@pytest.mark.parametrize(('n_coordinators', 'expected'), [
    (1, AnswerKind.READY), (2, AnswerKind.BUSY)])
def test_a_run_whose_coordinator_is_gone_is_left_for_another(
        member, monkeypatch, n_coordinators, expected):
    """The one that says hello is not counted; the other has sent just before."""
    post = Post()
    monkeypatch.setattr(post, 'count_senders', lambda: n_coordinators)
    monkeypatch.setattr(member._end, '_mailbox', post)
    hello = encode_hello(RUN + 1, 1, 1_000_000, np.zeros(2, START), ROSTER)
    (kind, _, is_repeated), = member.answers_to(hello)
    assert (kind, is_repeated) == (expected, False)
    assert member.answers_to(tick(0)) == ([done(0)] if expected is AnswerKind.BUSY else [])


def test_one_that_refuses_to_start_is_not_in_the_run(member, monkeypatch):
    """It answers each hello with the reason, and none with the parts of a start."""
    def refused(*_: object) -> None:
        raise SetpointError('no such leg')
    monkeypatch.setattr(member.role, 'start', refused)
    monkeypatch.setattr(member._end, '_mailbox', Post())
    hellos = [encode_hello(RUN + 1, k, 1_000_000, np.zeros(2, START), ROSTER) for k in (1, 2)]
    assert member.answers_to(*hellos) == [
        (AnswerKind.REFUSED, 1, False), (AnswerKind.REFUSED, 2, False)]
    assert [answer.parts for answer in member.answers[-2:]] == [[b'no such leg']] * 2


def test_what_has_arrived_is_taken_before_each_tick(member, monkeypatch):
    """A setpoint takes effect at the next tick; a repeated step looks at nothing."""
    served: list[int] = []
    monkeypatch.setattr(member.role, 'serve', lambda: served.append(member.role.ticks))
    assert member.answers_to(tick(0), tick(0), tick(1)) == [
        done(0), done(0, is_repeated=True), done(1)]
    assert served == [0, 1]


def test_only_a_tick_that_was_executed_is_left_to_the_loop(member, monkeypatch):
    """After one that was refused, the next is checked by Python again."""
    learned: list[object] = []
    monkeypatch.setattr(member._end, '_ticks', SimpleNamespace(
        publish_kept=lambda: None, forget=lambda: learned.append('forgotten'),
        expect=lambda step, index: learned.append((step.tick, index))))
    assert member.answers_to(tick(0), tick(7), tick(1)) == [
        done(0), (AnswerKind.REFUSED, 7, False), done(1)]
    assert learned == [(0, 1), 'forgotten', (1, 1)]
