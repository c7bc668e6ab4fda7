"""Controllers among the participants."""

from isa_ros.controller import Setpoint
from isa_ros.core.signals import HAS_SETPOINT
from isa_ros.errors import RunError
import pytest
from tests.ros.lockstep.participants import (
    begin, Follower, make_transport, rows_of_two, Scripted, spinning, tick)

pytestmark = pytest.mark.ros


def test_a_controller_sees_tick_k_and_speaks_for_tick_k_plus_1(observer):
    """It receives the samples before the tick, and the run waits for its answer."""
    controller, rows = Follower(), rows_of_two()
    steppers = {'haa': Scripted(), 'kfe': Scripted(), 'follower': controller}
    with spinning(observer.context, steppers):
        transport = make_transport(observer, ['follower'])
        begin(transport, rows)
        assert rows.requests['kinds'].tolist() == [0, 0]
        assert rows.samples['position'].tolist() == [0.25, 0.5]
        tick(transport, 0, rows)
        assert rows.samples['position'].tolist() == [1.25, 1.5]
        assert rows.requests['kinds'].tolist() == [HAS_SETPOINT, 0]
        assert rows.requests['position'][0] == 0.5
        tick(transport, 1, rows)
        assert rows.requests['position'][0] == 1.5
    assert controller.names == ['haa', 'kfe']
    assert controller.shown == [(0, [0.25, 0.5]), (1_000_000, [1.25, 1.5])]


@pytest.mark.parametrize('has_body', [False, True])
def test_a_controller_receives_supplies_and_body(observer, has_body):
    """As they are before the tick; the body by the fields of its own record type."""
    controller, rows = Follower(), rows_of_two(has_body)
    steppers = {'haa': Scripted(), 'kfe': Scripted(), 'follower': controller}
    with spinning(observer.context, steppers):
        transport = make_transport(observer, ['follower'], has_body=has_body)
        begin(transport, rows)
        for number in range(2):
            rows.supplies['pressure'] = 20e6 - number
            for body in rows.bodies.values():
                body['height'] = 0.5 + number
            tick(transport, number, rows)
    assert controller.supplies == [{'supply': 20e6}, {'supply': 20e6 - 1.0}]
    assert controller.heights == ([0.5, 1.5] if has_body else [None, None])


def test_a_setpoint_for_an_unknown_actuator_ends_the_run(observer):
    controller = Follower()
    controller.setpoints = {'hip': Setpoint(0.1)}
    with spinning(observer.context, {
            'haa': Scripted(), 'kfe': Scripted(), 'follower': controller}):
        transport = make_transport(observer, ['follower'])
        begin(transport)
        with pytest.raises(RunError, match="follower: refused tick 0: 'hip' is not an actuator"):
            tick(transport, 0)


def test_a_controller_without_snapshot_is_named(observer):
    with spinning(observer.context, {
            'haa': Scripted(), 'kfe': Scripted(), 'follower': Follower()}):
        transport = make_transport(observer, ['follower'])
        begin(transport)
        with pytest.raises(RunError, match=(
                r'follower: refused the request to save its state: Follower has no snapshot\(\)')):
            transport.snapshots()
