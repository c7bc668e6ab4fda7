"""Requests and messages that no tool sends: each is answered or discarded, and the run goes on."""

from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.nodes.actuator.node import ActuatorNode, NodeSetup
from isa_ros.nodes.middleware import servers, throttled
import pytest
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters, SetParametersAtomically
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool
from tests.ros.started import wait_for

pytestmark = pytest.mark.ros
UNKNOWN_TYPE = ParameterValue(type=99)


@pytest.fixture
def knee(observer, monkeypatch):
    """Return an actuator whose services are served at every call."""
    monkeypatch.setattr(servers, 'SELDOM_PERIOD_S', 0.0)
    monkeypatch.setattr(servers, 'SERVICE_PERIOD_S', 0.0)
    setup = NodeSetup(default_actuator('isa_v5', 'knee'), DEFAULT_TIMING)
    node = ActuatorNode(
        lambda _: setup, 'knee', has_mailbox=False, context=observer.context,
        enable_rosout=False)
    yield node
    node.destroy_node()


def answered(observer: Node, knee: ActuatorNode, type_: type, name: str, request):
    """Return the response of a service of the actuator."""
    client = observer.create_client(type_, f'/knee/{name}')
    wait_for(client.service_is_ready, name)
    future = client.call_async(request)

    def is_served():
        knee.serve()
        response = client.handle.take_response(type_.Response)[1]
        if response is not None:
            future.set_result(response)
        return future.done()
    wait_for(is_served, 'the response')
    observer.destroy_client(client)
    return future.result()


def double(name, value):
    return Parameter(name=name, value=ParameterValue(type=3, double_value=value))


def test_a_value_of_an_unknown_type_is_refused_and_the_others_are_set(observer, knee):
    """Each parameter of one request has its own result."""
    results = answered(observer, knee, SetParameters, 'set_parameters', SetParameters.Request(
        parameters=[Parameter(name='force.kp', value=UNKNOWN_TYPE), double('force.kf', 1e-3),
                    Parameter(name='', value=UNKNOWN_TYPE)])).results
    assert [result.successful for result in results] == [False, True, False]
    assert '99' in results[0].reason
    assert knee.get_parameter('force.kf').value == 1e-3


def test_an_unknown_type_among_several_sets_none(observer, knee):
    before = knee.get_parameter('force.kf').value
    result = answered(
        observer, knee, SetParametersAtomically, 'set_parameters_atomically',
        SetParametersAtomically.Request(parameters=[
            double('force.kf', 1e-3), Parameter(name='force.kp', value=UNKNOWN_TYPE)])).result
    assert not result.successful and '99' in result.reason
    assert knee.get_parameter('force.kf').value == before


def test_a_setpoint_that_is_none_is_discarded(observer, knee):
    """Bytes of a publisher of serialised messages; a true setpoint after them is accepted."""
    publisher = observer.create_publisher(JointState, '/knee/setpoint', 1)
    wait_for(lambda: publisher.get_subscription_count() == 1, 'the match')

    def accepted(message) -> bool:
        publisher.publish(message)
        knee.serve()
        knee.actuator.tick()
        return bool(knee.actuator.memory.applied['kinds'][0])
    assert not any(accepted(bytes(k)) for k in (1, 4, 16, 400))
    wait_for(lambda: accepted(JointState(name=['knee'], position=[0.04])), 'the setpoint')


def test_a_setpoint_of_many_names_is_one_short_line(knee, monkeypatch):
    """100,000 names were a line of a megabyte."""
    lines = []
    monkeypatch.setattr(throttled, 'WARNING_PERIOD_S', 0.0)
    monkeypatch.setattr(
        type(knee.get_logger()), 'warning', lambda self, text, **_: lines.append(text))
    names = [f'stranger\x1b[2J{k}' for k in range(100_000)]
    knee._on_setpoint(JointState(name=names, position=[0.0] * len(names)))
    knee._on_setpoint(JointState(name=['knee', *names], position=[0.0] * (len(names) + 1)))
    knee._on_setpoint(JointState(name=['knee', 'x' * 100_000], position=[0.0, 0.0]))
    assert len(lines) == 3
    assert all(len(line) < 1000 and line.isprintable() for line in lines)
    assert '(100000 in all)' in lines[0]


def test_the_services_still_serve(observer, knee):
    """After a request without any name too."""
    got = answered(observer, knee, GetParameters, 'get_parameters', GetParameters.Request(
        names=['', 'none', '\x00']))
    assert list(got.values) == []
    assert answered(observer, knee, SetBool, 'enable', SetBool.Request(data=False)).success
