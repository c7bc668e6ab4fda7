"""Requests to the parameter services of actuator and coordinator: answered, whatever they hold."""

import math
import random
from types import SimpleNamespace

from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.nodes.actuator.node import ActuatorNode, NodeSetup
from isa_ros.nodes.coordinator.services import RunServices
from isa_ros.nodes.middleware import parameter_services
from isa_ros.run.pacing import Pace
import pytest
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import (
    DescribeParameters, GetParameters, GetParameterTypes, ListParameters, SetParameters,
    SetParametersAtomically)
from rclpy.node import Node
from tests.fuzz.property import Broken, refused
from tests.ros.conftest import domain, observer  # noqa: F401

pytestmark = pytest.mark.ros
CASES, MANY = 1500, 100_000
NAMES = ('force.kp', 'force.limit', 'position.stiffness', 'force.kf', 'spool.kp', 'step_count',
         'real_time_factor', 'use_sim_time', 'model', 'none', '', '.', 'é', 'x' * 3000, 'a b',
         'force', '\x1b[2J')
NUMBERS = (0.0, -0.0, 1e-7, 1.0, -1.0, 1e308, 5e-324, math.nan, math.inf, -math.inf)
TYPES = (*range(10), 3, 3, 3, 10, 99, 255)


def value(dice: random.Random) -> ParameterValue:
    """Return a value of any type, or of none."""
    return ParameterValue(
        type=dice.choice(TYPES), bool_value=dice.random() < 0.5,
        integer_value=dice.choice((0, 1, -1, 2**63 - 1, -2**63)),
        double_value=dice.choice(NUMBERS),
        string_value=dice.choice(NAMES), double_array_value=dice.choices(NUMBERS, k=2),
        string_array_value=dice.choices(NAMES, k=2), byte_array_value=[b'x'])


def requests(dice: random.Random):
    """Return a request of each kind."""
    names = dice.choices(NAMES, k=dice.randrange(4))
    parameters = [Parameter(name=name, value=value(dice)) for name in names]
    return {
        SetParameters: SetParameters.Request(parameters=parameters),
        SetParametersAtomically: SetParametersAtomically.Request(parameters=parameters),
        GetParameters: GetParameters.Request(names=names),
        GetParameterTypes: GetParameterTypes.Request(names=names),
        DescribeParameters: DescribeParameters.Request(names=names),
        ListParameters: ListParameters.Request(
            prefixes=names, depth=dice.choice((0, 1, 2, 2**64 - 1)))}


def fuzz(nodes: list[Node], cases: int, seed: int) -> None:
    """Hand that many requests to the services of the nodes."""
    dice = random.Random(seed)
    doors = [service for node in nodes for service in node.services
             if service.srv_type in requests(dice)]
    assert len(doors) == 6 * len(nodes)
    for k in range(cases):
        service = dice.choice(doors)
        request = requests(dice)[service.srv_type]

        def answered() -> None:
            response = service.callback(request, service.srv_type.Response())
            assert type(response) is service.srv_type.Response
            if service.srv_type is SetParameters:
                assert len(response.results) == len(request.parameters)
            for node in nodes:
                if isinstance(node, ActuatorNode):
                    assert_finite(node)
        refused(answered, f'case {k} of seed {seed}, {service.srv_name}: {request}')


def assert_finite(node: ActuatorNode) -> None:
    """Assert that no parameter of an actuator is infinite or NaN."""
    assert math.isfinite(node.get_parameter('force.kp').value)
    assert math.isfinite(node.get_parameter('force.limit').value)
    assert math.isfinite(node.get_parameter('position.stiffness').value)


@pytest.fixture
def nodes(observer):  # noqa: F811
    """Return the nodes of an actuator and of a coordinator."""
    setup = NodeSetup(default_actuator('isa_v5', 'knee'), DEFAULT_TIMING)
    knee = ActuatorNode(
        lambda _: setup, 'knee', has_mailbox=False, context=observer.context,
        enable_rosout=False)
    other = Node('coordinator', context=observer.context, enable_rosout=False,
                 start_parameter_services=False)
    services = RunServices(other, 1.0, lambda coordinator: '')
    pace = Pace(1.0)
    services._coordinator = SimpleNamespace(set_real_time_factor=pace.set_factor)
    yield [knee, other]
    assert math.isfinite(pace.factor) and pace.factor >= 0.0
    knee.destroy_node()
    other.destroy_node()


def test_every_request_is_answered(nodes):
    fuzz(nodes, CASES, 1)


@pytest.mark.long
def test_every_one_of_many_requests_is_answered(nodes):
    fuzz(nodes, MANY, 2)


def test_a_guard_that_is_missing_is_found(observer, monkeypatch):  # noqa: F811
    """Without it a value of type 99 raises in rclpy."""
    monkeypatch.setattr(parameter_services, 'checked', lambda node, type_, callback: callback)
    other = Node('coordinator', context=observer.context, enable_rosout=False,
                 start_parameter_services=False)
    RunServices(other, 1.0, lambda coordinator: '')
    with pytest.raises(Broken, match='ValueError: 10 is not a valid'):
        fuzz([other], CASES, 1)
    other.destroy_node()
