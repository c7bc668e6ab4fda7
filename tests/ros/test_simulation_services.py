"""The standard services of simulators, on a run that stands in and on running nodes."""

from collections.abc import Iterator
import signal
from typing import Any

from isa_ros.bag.reader import Bag
from isa_ros.config.runs.acceptance import ACCEPT_ALL, ACCEPT_SCENARIO
from isa_ros.errors import ConfigError, RunError
from isa_ros.nodes.coordinator.attempts import LARGEST_STEP
from isa_ros.replay.replay import recorded_events, replay
import pytest
from rclpy.node import Node
from tests.ros.spinning import Spinning
from tests.ros.started import bringup, RIG

pytest.importorskip('simulation_interfaces.srv')

from isa_ros.nodes.coordinator.simulation_services import SimulationServices  # noqa: E402, I100
from isa_ros.nodes.middleware.acceptance import Acceptance  # noqa: E402
from simulation_interfaces.msg import Result, SimulationState  # noqa: E402
from simulation_interfaces.srv import (  # noqa: E402
    GetSimulationState, GetSimulatorFeatures, ResetSimulation, SetSimulationState, StepSimulation)

pytestmark = pytest.mark.ros
STOPPED, PLAYING, PAUSED = 0, 1, 2
KINDS = {
    'get_simulator_features': GetSimulatorFeatures, 'get_simulation_state': GetSimulationState,
    'set_simulation_state': SetSimulationState, 'step_simulation': StepSimulation,
    'reset_simulation': ResetSimulation}


class Run:
    """Stands in for a `Coordinator` of 7 ticks."""

    step_ns = 2_000_000

    def __init__(self) -> None:
        self.ticks, self.is_paused = 0, True
        self.reset_to: list[bool | None] = []
        self.error: Exception | None = None

    def pause(self, is_paused: bool) -> None:
        self.is_paused = is_paused

    def step(self, n_ticks: int) -> None:
        if self.error is not None:
            raise self.error
        if not self.is_paused:
            raise ConfigError('step: the run is not paused, pause it first')
        self.ticks = min(7, self.ticks + n_ticks)

    def reset(self, is_paused: bool | None = None) -> None:
        self.reset_to.append(is_paused)


class Standard:
    """The services on a node, called without a middleware."""

    def __init__(self, node: Node, accept: str) -> None:
        self.run = Run()
        acted_on: Any = lambda: self.run    # noqa: E731
        self.own = SimulationServices(node, acted_on, Acceptance(node, accept))

    def call(self, name: str, **values: Any) -> Any:
        kind = KINDS[name]
        service = next(own for own in self.own.services if own.srv_name == name)
        return service.callback(kind.Request(**values), kind.Response())

    def to(self, state: int) -> tuple[int, str]:
        result = self.call('set_simulation_state', state=SimulationState(state=state)).result
        return result.result, result.error_message

    @property
    def state(self) -> int:
        answer = self.call('get_simulation_state')
        assert answer.result.result == Result.RESULT_OK
        return int(answer.state.state)


@pytest.fixture
def node(observer: Node) -> Iterator[Node]:
    node = Node('coordinator', context=observer.context, enable_rosout=False)
    yield node
    node.destroy_node()


@pytest.fixture
def standard(node: Node) -> Standard:
    return Standard(node, ACCEPT_ALL)


@pytest.fixture
def closed(node: Node) -> Standard:
    return Standard(node, ACCEPT_SCENARIO)


def test_names_are_those_of_the_standard_in_the_namespace_of_the_run(standard, observer):
    left = Node('coordinator', namespace='left', context=observer.context, enable_rosout=False)
    own = SimulationServices(left, lambda: standard.run, None)
    assert {left.resolve_service_name(service.srv_name): service.srv_type
            for service in own.services} == {
        f'/left/{name}': kind for name, kind in KINDS.items()}
    left.destroy_node()


def test_the_state_is_that_of_the_run(standard):
    assert standard.state == STOPPED
    standard.run.ticks = 1
    assert standard.state == PAUSED
    standard.run.is_paused = False
    assert standard.state == PLAYING
    standard.run.ticks = 0
    assert standard.state == PLAYING


def test_a_stopped_run_may_be_paused_without_a_tick(standard):
    assert standard.to(PAUSED) == (Result.RESULT_OK, '')
    assert (standard.state, standard.run.ticks, standard.run.is_paused) == (PAUSED, 0, True)
    standard.run = Run()    # of a reset: another run, that nobody has paused
    assert standard.state == STOPPED


def test_play_and_pause(standard):
    assert standard.to(PLAYING) == (Result.RESULT_OK, '')
    assert not standard.run.is_paused
    assert standard.to(PAUSED) == (Result.RESULT_OK, '')
    assert standard.run.is_paused and not standard.run.reset_to


@pytest.mark.parametrize('state', [STOPPED, PLAYING, PAUSED])
def test_a_state_that_it_has_already_is_answered_so(standard, state):
    standard.run.ticks = 5 if state == PAUSED else 0
    standard.run.is_paused = state != PLAYING
    assert standard.state == state
    assert standard.to(state)[0] == SetSimulationState.Response.ALREADY_IN_TARGET_STATE == 101
    assert not standard.run.reset_to


def test_to_stop_is_a_reset_to_a_run_that_waits(standard):
    standard.run.is_paused = False
    assert standard.to(STOPPED) == (Result.RESULT_OK, '')
    assert standard.run.reset_to == [True]


@pytest.mark.parametrize('state', [3, 4, 5, 77])
def test_other_states_are_not_supported(standard, state):
    result, line = standard.to(state)
    assert result == Result.RESULT_FEATURE_UNSUPPORTED
    assert line.startswith(f'state = {state}, must be 0 (stopped), 1 ')


def test_a_step_is_exactly_so_many_ticks(standard):
    assert standard.call('step_simulation', steps=4).result == Result(result=Result.RESULT_OK)
    assert (standard.run.ticks, standard.state) == (4, PAUSED)


@pytest.mark.parametrize(('steps', 'line'), [
    (0, f'steps = 0, must be >= 1 and <= {LARGEST_STEP}'),
    (LARGEST_STEP + 1, f'steps = {LARGEST_STEP + 1}, must be >= 1 and <= {LARGEST_STEP}'),
    (9, 'the run has ended after 7 of 9 steps')])
def test_steps_that_cannot_be_made_are_answered_so(standard, steps, line):
    answer = standard.call('step_simulation', steps=steps).result
    assert (answer.result, answer.error_message) == (Result.RESULT_OPERATION_FAILED, line)


def test_a_running_simulation_is_not_stepped(standard):
    standard.run.is_paused = False
    answer = standard.call('step_simulation', steps=1).result
    assert (answer.result, answer.error_message) == (
        Result.RESULT_OPERATION_FAILED, 'step: the run is not paused, pause it first')
    assert standard.run.ticks == 0


def test_what_ends_the_run_is_no_answer(standard):
    standard.run.error = RunError('kfe: no answer to tick 3 after 5.0 s')
    with pytest.raises(RunError):
        standard.call('step_simulation', steps=1)


@pytest.mark.parametrize('scope', [0, 3, 7, 255])
def test_a_reset_of_time_and_state_begins_as_the_options_say(standard, scope):
    assert standard.call('reset_simulation', scope=scope).result.result == Result.RESULT_OK
    assert standard.run.reset_to == [None]


@pytest.mark.parametrize('scope', [1, 2, 4, 5, 6])
def test_a_reset_of_one_of_them_is_not_supported(standard, scope):
    answer = standard.call('reset_simulation', scope=scope).result
    assert answer.result == Result.RESULT_FEATURE_UNSUPPORTED
    assert answer.error_message.startswith(f'scope = {scope}, must be 0 or have time and state, 3')
    assert not standard.run.reset_to


def test_features_are_those_that_are_true(standard):
    features = standard.call('get_simulator_features').features
    assert list(features.features) == [20, 24, 25, 26, 31, 32]
    assert 'a step is 0.002 s' in features.custom_info
    assert not features.spawn_formats


def test_a_run_of_its_scenario_alone_is_paused_and_stepped_but_not_reset(closed):
    assert list(closed.call('get_simulator_features').features.features) == [24, 25, 26, 31, 32]
    closed.run.ticks = 2
    assert closed.to(STOPPED) == (
        SetSimulationState.Response.STATE_TRANSITION_ERROR, 'the run has accept: scenario')
    answer = closed.call('reset_simulation').result
    assert (answer.result, answer.error_message) == (
        Result.RESULT_FEATURE_UNSUPPORTED, 'the run has accept: scenario')
    assert not closed.run.reset_to
    assert closed.to(PLAYING)[0] == closed.to(PAUSED)[0] == Result.RESULT_OK
    assert closed.call('step_simulation', steps=1).result.result == Result.RESULT_OK


class User:
    """A user of the standard services."""

    def __init__(self, node: Node) -> None:
        self._node, self._spinning = node, Spinning(node)

    def call(self, name: str, **values: Any) -> Any:
        client = self._node.create_client(KINDS[name], f'/{name}')
        self._spinning.wait_for(client.service_is_ready, name)
        future = client.call_async(KINDS[name].Request(**values))
        self._spinning.wait_for(future.done, name)
        return future.result()

    def to(self, state: int) -> int:
        return int(self.call(
            'set_simulation_state', state=SimulationState(state=state)).result.result)

    @property
    def state(self) -> int:
        return int(self.call('get_simulation_state').state.state)

    def step(self, steps: int) -> int:
        return int(self.call('step_simulation', steps=steps).result.result)


@pytest.mark.slow
@pytest.mark.parametrize('options', [(), ('--in-process',)], ids=['processes', 'one process'])
def test_a_run_by_standard_services_replays_with_the_same_bytes(observer, tmp_path, options):
    """Stopped, stepped, played, paused, stopped again and reset: three bags."""
    bags = [tmp_path / name for name in ('bag', 'bag_2', 'bag_3')]
    with bringup(bags[0], '--paused', *options, config=RIG) as run:
        user = User(observer)
        assert user.state == STOPPED
        assert user.step(25) == Result.RESULT_OK
        assert user.state == PAUSED
        assert user.to(PLAYING) == Result.RESULT_OK
        assert user.step(1) == Result.RESULT_OPERATION_FAILED
        assert user.to(PAUSED) == Result.RESULT_OK
        assert user.to(STOPPED) == Result.RESULT_OK
        assert user.step(11) == Result.RESULT_OK
        assert user.call('reset_simulation').result.result == Result.RESULT_OK
        assert user.step(3) == Result.RESULT_OK
        run.signal(signal.SIGTERM)
        assert run.exit_code() == 130, run.errors
    first, second, third = (Bag(own) for own in bags)
    events = recorded_events(first)
    assert events[0] == ['step 25'] and 'resume' in events[25] and 'reset' in events[max(events)]
    assert recorded_events(second) == {0: ['step 11'], 11: ['reset']}
    assert recorded_events(third) == {0: ['step 3']}
    assert [tick.sequence for tick in second.ticks()] == list(range(12))
    for own in (first, second, third):
        assert replay(own).is_equal
    assert replay_of_stops(first, second)


def replay_of_stops(first: Bag, second: Bag) -> bool:
    """Return whether both begin with the same bytes, events left out."""
    def states(bag: Bag) -> list[Any]:
        return [(m.t_ns, m.topic, m.data) for m in bag.messages()
                if 'events' not in m.topic and m.t_ns <= 10_000_000]
    return states(first) == states(second)


def test_a_run_that_waits_only_after_it_was_stopped(observer, tmp_path):
    """Without --paused: a reset begins to run at once, stopped it waits."""
    with bringup(tmp_path / 'bag', '--real-time-factor', '1', '--in-process', config=RIG) as run:
        user = User(observer)
        assert user.state == PLAYING
        assert user.to(STOPPED) == Result.RESULT_OK
        assert user.state == STOPPED
        assert user.call('reset_simulation').result.result == Result.RESULT_OK
        assert user.state == PLAYING
        run.signal(signal.SIGTERM)
        assert run.exit_code() == 130, run.errors
