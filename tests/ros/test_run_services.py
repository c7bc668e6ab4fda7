"""What a service of the coordinator answers, and which errors it must not keep to itself."""

from collections.abc import Iterator
from typing import Any

from isa_ros.errors import ConfigError, IsaError, RunError, SimulationDiverged
from isa_ros.nodes.coordinator.services import RunServices
from isa_ros.run.coordinator import Interrupted
import pytest
from rclpy.node import Node
from std_srvs.srv import Trigger
from tests.ros.spinning import Spinning

pytestmark = pytest.mark.ros


class Run:
    """Stands in for a `Coordinator` between two ticks; each request may raise."""

    t_ns = ticks = 0
    is_paused = is_reset = False
    error: IsaError | None = None

    def _maybe_raise(self, *_: object) -> None:
        if self.error is not None:
            raise self.error

    step = reset = save = _maybe_raise


class Services:
    """The services of a coordinator's node, and a user's calls of them."""

    def __init__(self, node: Node, user: Node) -> None:
        self.run = Run()
        self._user, self._spinning = user, Spinning(user)
        self._services = RunServices(node, 0.0, self._save)

    def _save(self, run: Any) -> str:
        run.save()
        return 'bag/state_0.json'

    def call(self, name: str) -> Trigger.Response:
        """Return the answer to a call; what ends the run is raised, as the run would."""
        called = self.request(name)
        self.wait_for(called, name)
        return called.result()

    def request(self, name: str) -> Any:
        """Send a request and return its future."""
        client = self._user.create_client(Trigger, f'/coordinator/{name}')
        self._spinning.wait_for(client.service_is_ready, name)
        return client.call_async(Trigger.Request())

    def serve(self) -> None:
        """Look once at what has arrived, after the time between two looks at services."""
        self._spinning.spin_once()
        self._services.serve(self.run)

    def wait_for(self, called: Any, name: str) -> None:
        """Serve until a request is answered."""
        def is_answered() -> bool:
            self._services.serve(self.run)
            return called.done()
        self._spinning.wait_for(is_answered, f'the answer of {name}')


@pytest.fixture
def services(observer: Node) -> Iterator[Services]:
    """Return services in a domain of their own."""
    node = Node('coordinator', context=observer.context, enable_rosout=False,
                start_parameter_services=False)
    yield Services(node, observer)
    node.destroy_node()


@pytest.mark.parametrize('name', ['step', 'save', 'reset'])
def test_what_was_done_is_answered(services, name):
    answer = services.call(name)
    assert answer.success and answer.message


@pytest.mark.parametrize('name', ['step', 'save', 'reset'])
def test_a_request_that_cannot_be_done_is_answered_and_the_run_goes_on(services, name):
    """Wrong input is the caller's: one line, and the next request is served."""
    services.run.error = ConfigError('step: the run is not paused, pause it first')
    answer = services.call(name)
    assert not answer.success and answer.message == str(services.run.error)
    services.run.error = None
    assert services.call(name).success


@pytest.mark.parametrize('name', ['step', 'save', 'reset'])
@pytest.mark.parametrize('error', [
    RunError('kfe: no answer to tick 3 after 5.0 s'),
    SimulationDiverged(3_000_000, 'kfe: plant.spool.position', float('nan')),
    Interrupted('stopped at t = 0.003 s')], ids=lambda error: type(error).__name__)
def test_an_error_that_ends_the_run_ends_it(services, name, error):
    """A service that answered it would leave a run without its participant going on."""
    services.run.error = error
    with pytest.raises(type(error)) as raised:
        services.call(name)
    assert raised.value is error


def test_requests_behind_a_reset_are_those_of_the_next_run(services):
    """The run that has ended would answer them, and none of it would come true."""
    done: list[str] = []
    services.run.reset = lambda: setattr(services.run, 'is_reset', True)
    services.run.step = lambda count: done.append('a step of the run before')
    assert services.call('reset').success
    client = services.request('step')
    for _ in range(20):
        services.serve()
    assert not done and not client.done()
    services.run = Run()
    services.wait_for(client, 'step')
    assert client.result().success and not done


def test_without_the_package_the_standard_services_are_missing(observer, monkeypatch):
    """It is never required: the others are there, and nothing of it is imported."""
    from isa_ros.nodes.coordinator import services as module
    monkeypatch.setattr(module, 'is_installed', lambda package: False)
    node = Node('coordinator', context=observer.context, enable_rosout=False,
                start_parameter_services=False)
    RunServices(node, 0.0, lambda run: '')
    names = {own.srv_name for own in node.services}
    assert {'~/pause', '~/step', '~/reset', '~/save', 'emergency_stop'} <= names
    assert not any('simulation' in name or 'simulator' in name for name in names)
    node.destroy_node()
