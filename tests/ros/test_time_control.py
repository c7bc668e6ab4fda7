"""Pause, exactly N steps, save and reset of a running bring-up, as a user calls them."""

from pathlib import Path
import signal
from typing import Any

from isa_ros.bag.reader import Bag
from isa_ros.core.saved_state import FORMAT
from isa_ros.replay.replay import recorded_events, replay
import pytest
from rcl_interfaces.srv import SetParameters
from rclpy.node import Node
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock
from std_srvs.srv import SetBool, Trigger
from tests.ros.spinning import Spinning
from tests.ros.started import bringup, RIG, started

pytestmark = pytest.mark.ros


class User:
    """Services of the coordinator, and `/clock`."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self.clocks: list[int] = []
        node.create_subscription(Clock, '/clock', self._on_clock, 100)
        self._spinning = Spinning(node)
        self.wait_for = self._spinning.wait_for

    def _on_clock(self, message: Clock) -> None:
        self.clocks.append(message.clock.sec * 10**9 + message.clock.nanosec)

    def call(self, kind: Any, name: str, request: Any) -> Any:
        client = self._node.create_client(kind, f'/coordinator/{name}')
        self.wait_for(client.service_is_ready, name)
        future = client.call_async(request)
        self.wait_for(future.done, name)
        return future.result()

    def pause(self, is_paused: bool) -> str:
        return self.call(SetBool, 'pause', SetBool.Request(data=is_paused)).message

    def trigger(self, name: str) -> Trigger.Response:
        return self.call(Trigger, name, Trigger.Request())

    def set_parameter(self, name: str, value: Any) -> Any:
        request = SetParameters.Request(
            parameters=[Parameter(name, value=value).to_parameter_msg()])
        return self.call(SetParameters, 'set_parameters', request).results[0]


@pytest.mark.slow
@pytest.mark.parametrize('options', [(), ('--in-process',)], ids=['processes', 'one process'])
def test_a_paused_run_goes_exactly_as_far_as_it_is_told(observer, tmp_path, options):
    """Steps from t = 0, a state saved and a reset on the way; both bags replay."""
    bag = tmp_path / 'bag'
    with bringup(bag, '--paused', *options, config=RIG) as run:
        user = User(observer)
        user.wait_for(lambda: observer.count_publishers('/clock'), '/clock')
        assert user.trigger('step').message == '1 ticks to t = 0.001000 s'
        assert user.set_parameter('step_count', 24).successful
        assert user.trigger('step').message == '24 ticks to t = 0.025000 s'
        assert user.trigger('save').message == f'saved to {bag}/state_25.json'
        assert user.trigger('step').message == '24 ticks to t = 0.049000 s'
        user.wait_for(lambda: user.clocks and user.clocks[-1] == 49_000_000, 'the time')
        assert user.trigger('reset').message == 'reset at t = 0.049000 s, starts again at t = 0'
        assert user.trigger('step').message == '24 ticks to t = 0.024000 s'
        assert user.pause(False) == 'running from t = 0.024000 s'
        user.wait_for(lambda: user.clocks[-1] > 100_000_000, 'the time')
        response = user.trigger('step')
        assert not response.success
        assert response.message == 'step: the run is not paused, pause it first'
        assert user.pause(True).startswith('paused from t = ')
        run.signal(signal.SIGTERM)
        assert run.exit_code() == 130
    first, second = Bag(bag), Bag(tmp_path / 'bag_2')
    assert [tick.sequence for tick in first.ticks()] == list(range(50))
    events = recorded_events(first)
    assert events == {0: ['step 1'], 1: ['step 24'], 25: ['step 24'], 49: ['reset']}
    assert recorded_events(second).keys() > {0, 24}
    for recorded in (first, second):
        assert replay(recorded).is_equal
    rest = continued(tmp_path / 'rest', bag / 'state_25.json')
    whole = [own for own in states(bag) if own[0] >= 25_000_000]
    told = [own for own in states(rest) if own not in whole]    # the state that it begins in
    assert {(t_ns, topic.rpartition('/')[2]) for t_ns, topic, _ in told} == {
        (25_000_000, 'device'), (25_000_000, 'diagnostics')}
    assert [own for own in states(rest) if own not in told] == whole


def states(bag: Path) -> list[tuple[int, str, bytes]]:
    """Return all messages except the run's events."""
    return [(m.t_ns, m.topic, m.data) for m in Bag(bag).messages() if 'events' not in m.topic]


def continued(out: Path, state: Path) -> Path:
    """Continue from a saved state up to the reset of the first run, in one process."""
    with bringup(out, '--restore', str(state), '--duration', '0.049', '--in-process',
                 config=RIG) as run:
        assert run.exit_code() == 0, run.errors
    return out


def test_the_pace_may_be_changed_while_it_runs(observer, tmp_path):
    """From slow to as fast as possible; invalid factors are refused with the reason."""
    bag = tmp_path / 'bag'
    with bringup(bag, '--real-time-factor', '0.01', '--duration', '2', '--in-process',
                 config=RIG) as run:
        user = User(observer)
        user.wait_for(lambda: user.clocks, 'the time')
        refused = user.set_parameter('real_time_factor', -1.0)
        assert not refused.successful
        assert refused.reason.startswith('real_time_factor = -1, must be finite and >= 0')
        assert user.set_parameter('real_time_factor', 0.0).successful
        assert run.exit_code() == 0
    assert Bag(bag).end_ns == 2_000_000_000


def test_a_state_of_another_configuration_is_refused(domain, tmp_path):
    state = tmp_path / 'state.json'
    with bringup(tmp_path / 'bag', '--duration', '0.01', '--in-process', '--save', str(state),
                 config=RIG) as run:
        assert run.exit_code() == 0, run.errors
    with bringup(tmp_path / 'leg', '--restore', str(state)) as run:
        assert run.exit_code() == 2
    assert f'{state}: saved from the configuration ' in run.errors
    assert not (tmp_path / 'leg').exists()


@pytest.mark.parametrize(('text', 'message'), [
    ('', 'is no saved state of a run'),
    ('[]', 'is no saved state of a run'),
    ('{"format": 9}', f'format 9, must be {FORMAT}')])
def test_what_is_no_state_is_refused(domain, tmp_path, text, message):
    state = tmp_path / 'state.json'
    state.write_text(text)
    with started(tmp_path / 'log', 'isa_ros', 'bringup', str(RIG), '--restore', str(state),
                 '--out', str(tmp_path / 'bag')) as run:
        assert run.exit_code() == 2
    assert message in run.errors
    assert len(run.errors.splitlines()) == 1
