"""Ticks, first messages and saved states between a coordinator and its participants."""

from isa_ros.core.signals import HAS_ENABLE, HAS_SETPOINT
from isa_ros.errors import RunError
from isa_ros.nodes.middleware import mailboxes, servers
import pytest
from tests.ros.lockstep.participants import (
    applied, begin, Follower, make_transport, rows_of_two, Scripted, spinning, tick)
from tests.ros.started import wait_for

pytestmark = pytest.mark.ros


@pytest.mark.parametrize('has_handles', [True, False], ids=['wait set', 'executor'])
def test_every_participant_answers_every_tick(observer, monkeypatch, has_handles):
    """Rows go to their actuator, answers come back in the order of the configuration."""
    for module in (mailboxes, servers):
        monkeypatch.setattr(module, 'has_handles', lambda: has_handles)
    steppers = {'kfe': Scripted(), 'haa': Scripted()}
    with spinning(observer.context, steppers):
        transport = make_transport(observer)
        rows = begin(transport)
        assert rows.samples['position'].tolist() == [0.25, 0.5]
        first = HAS_SETPOINT | HAS_ENABLE
        assert applied(rows) == [(first, 0.25), (first, 0.5)]
        assert rows.tuned == {}
        assert tick(transport, 0, rows) == [1.0, 2.0]
        assert rows.samples['position'].tolist() == [1.25, 1.5]
        assert [kinds for kinds, _ in applied(rows)] == [0, 0] and rows.tuned == {}
        assert tick(transport, 1, rows) == [2.0, 3.0]
        assert applied(rows) == [(HAS_SETPOINT, 2.25), (HAS_SETPOINT, 2.5)]
        assert rows.tuned == {0: {'force.kp': 1e-7}, 1: {'force.kp': 1e-7}}
        tick(transport, 2, rows)
        assert [kinds for kinds, _ in applied(rows)] == [0, 0] and rows.tuned == {}
        transport.close()
    assert steppers['haa'].ticks == 3
    assert steppers['haa'].starts == 1


def test_nothing_is_published_before_the_clock(observer):
    """The first messages are held until `begin`, when `/clock` has been published."""
    stepper = Scripted()
    with spinning(observer.context, {'haa': stepper, 'kfe': Scripted()}):
        transport = make_transport(observer)
        transport.join(rows_of_two())
        assert stepper.published == []
        transport.begin()
        tick(transport, 0)
        wait_for(lambda: len(stepper.published) == 2, 'both messages')
    assert stepper.published == [0.25, 1.25]


def test_a_saved_state_is_restored(observer):
    """Every participant saves and restores its own state; the tick number continues too."""
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted()}):
        transport = make_transport(observer)
        begin(transport)
        tick(transport, 0)
        tick(transport, 1)
        states = transport.snapshots()
        assert states == [b'after 2', b'after 2']
        rows = rows_of_two()
        transport.join(rows)
        transport.restore(2, [b'after 2', b'after 7'], rows)
        assert rows.samples['position'].tolist() == [102.0, 107.0]
        assert applied(rows) == [(HAS_ENABLE, 102.0), (HAS_ENABLE, 107.0)]
        assert rows.tuned == {0: {'force.kf': 2.0}, 1: {'force.kf': 7.0}}
        transport.begin()
        tick(transport, 2, rows)
        assert rows.samples['position'].tolist() == [103.0, 108.0]
        assert rows.tuned == {}


def test_only_those_in_other_processes_are_called(observer):
    """Actuators in the coordinator's own process answer it directly."""
    with spinning(observer.context, {'follower': Follower()}):
        transport = make_transport(observer, ['follower'], first_remote=2)
        rows = rows_of_two()
        rows.samples['position'], rows.tuned = (0.75, 0.5), {0: {'force.kp': 1e-7}}
        rows.applied['kinds'] = HAS_ENABLE
        begin(transport, rows)
        tick(transport, 0, rows)
        assert rows.requests['kinds'].tolist() == [HAS_SETPOINT, 0]
        assert rows.requests['position'][0] == 0.5
        # What the actuators have said themselves stays.
        assert rows.samples['position'].tolist() == [0.75, 0.5]
        assert rows.tuned == {0: {'force.kp': 1e-7}}
        assert rows.applied['kinds'].tolist() == [HAS_ENABLE, HAS_ENABLE]


def test_a_skipped_tick_is_refused(observer):
    with spinning(observer.context, {'haa': Scripted(), 'kfe': Scripted()}):
        transport = make_transport(observer)
        begin(transport)
        with pytest.raises(RunError, match='refused tick 1: tick = 1, must be 0'):
            tick(transport, 1)


def test_a_participant_serves_one_run_after_the_other(observer):
    stepper = Scripted()
    with spinning(observer.context, {'haa': stepper, 'kfe': Scripted()}):
        for _ in range(2):
            transport = make_transport(observer)
            begin(transport)
            assert tick(transport, 0) == [1.0, 2.0]
            transport.close()
    assert stepper.starts == 2
    assert stepper.ticks == 1
