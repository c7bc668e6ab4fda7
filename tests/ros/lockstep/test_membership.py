"""Which nodes take part in a run: names, parameters, other coordinators."""

import time

from isa_ros.errors import ConfigError
from isa_ros.nodes.lockstep import coordinator_end as lockstep, participant_end
from isa_ros.nodes.lockstep.coordinator_end import LockstepTransport
from isa_ros.run.wire.steps import encode_tick
import pytest
from tests.ros.lockstep.participants import (
    begin, DEADLINE_S, Follower, make_transport, rows_of_two, Scripted, spinning, tick)
from tests.ros.started import wait_for

pytestmark = pytest.mark.ros


def test_a_node_with_the_name_of_one_in_this_process_is_refused(observer):
    with spinning(observer.context, {'follower': Follower(), 'haa': Scripted()}):
        with pytest.raises(ConfigError, match='haa: two nodes of this name answer'):
            make_transport(observer, ['follower'], first_remote=2).join(rows_of_two())


def test_other_digest_is_refused(observer):
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted('other')}):
        with pytest.raises(ConfigError, match='kfe: digest of its parameters = other, must be'):
            make_transport(observer).join(rows_of_two())


def test_busy_participant_refuses_another_coordinator(observer):
    """A participant bound to a run accepts steps of that run only and refuses the other."""
    steppers = {'haa': Scripted(), 'kfe': Scripted()}
    with spinning(observer.context, steppers):
        first = make_transport(observer)
        begin(first)
        tick(first, 0)
        with pytest.raises(ConfigError, match='another coordinator runs in ROS_DOMAIN_ID'):
            make_transport(observer).join(rows_of_two())
        assert tick(first, 1) == [2.0, 3.0]
    assert steppers['haa'].starts == 1


def is_followed(transport: LockstepTransport) -> bool:
    """Try to begin a run; return whether the participants take part."""
    try:
        begin(transport)
    except ConfigError:
        return False
    return True


def test_participants_of_a_silent_coordinator_follow_another(observer, monkeypatch):
    """A killed coordinator stays in the middleware's graph for a while."""
    monkeypatch.setattr(participant_end, 'SILENCE_S', 0.2)
    steppers = {'haa': Scripted(), 'kfe': Scripted()}
    with spinning(observer.context, steppers):
        first, second = make_transport(observer), make_transport(observer)
        begin(first)
        tick(first, 0)
        wait_for(lambda: is_followed(second), 'the silence')
        assert tick(second, 0) == [1.0, 2.0]
    assert steppers['haa'].starts >= 2  # again where the other had still refused


def test_a_paused_coordinator_is_not_silent(observer, ends, monkeypatch):
    """It is heard again and again, which is what the silence is measured from."""
    monkeypatch.setattr(participant_end, 'SILENCE_S', DEADLINE_S)
    monkeypatch.setattr(lockstep, 'REPEAT_S', 0.02)
    steppers = {'haa': Scripted(), 'kfe': Scripted()}
    with spinning(observer.context, steppers):
        first, second = make_transport(observer), make_transport(observer)
        begin(first)
        assert len(ends) == 2
        for _ in range(5):
            before = time.monotonic()
            while not all(end._last_message > before for end in ends):
                first.idle()
                assert time.monotonic() < before + DEADLINE_S
        assert not is_followed(second)
        assert tick(first, 0) == [1.0, 2.0]
    assert steppers['haa'].starts == 1


def test_steps_of_a_strange_run_are_ignored(observer):
    """A step with another run's id neither moves nor unbinds a participant."""
    stepper = Scripted()
    with spinning(observer.context, {'haa': stepper, 'kfe': Scripted()}):
        transport = make_transport(observer)
        begin(transport)
        stranger = make_transport(observer)
        wait_for(lambda: stranger._publisher.get_subscription_count() >= 2, 'the match')
        stranger._send(encode_tick(7, 0, rows_of_two(), False))
        stranger.close()
        assert tick(transport, 0) == [1.0, 2.0]
    assert stepper.ticks == 1


def test_a_second_node_of_a_name_is_reported_during_the_run(observer, monkeypatch):
    """A node discovered too late for any hello gives its name at its first tick."""
    lines = []
    monkeypatch.setattr(observer.get_logger(), 'warning', lambda line, **_: lines.append(line))
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted()}):
        transport = make_transport(observer)
        begin(transport)
        tick(transport, 0)
        with spinning(observer.context, {'kfe': Scripted()}):
            wait_for(lambda: transport._publisher.get_subscription_count() >= 3, 'the match')

            for number in range(1, 100_000):
                tick(transport, number)
                if lines:
                    break
            line, = lines
            assert line.startswith('kfe: a second node of this name waits in ROS_DOMAIN_ID')
            assert tick(transport, number + 1) == [number + 2.0, number + 3.0]


def test_a_node_of_another_name_does_not_disturb(observer):
    """It gives its name too, which is not a name of the run."""
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted(), 'hfe': Scripted()}):
        transport = make_transport(observer)
        begin(transport)
        wait_for(lambda: transport._publisher.get_subscription_count() >= 3, 'the match')
        for number in range(200):
            tick(transport, number)
