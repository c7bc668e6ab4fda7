"""Parameters on the command line with a wrong type or a wrong name: one line, exit code 2."""

from collections.abc import Mapping

from isa_ros.errors import ConfigError
from isa_ros.nodes.actuator.node import ActuatorNode
from isa_ros.nodes.actuator.process import _resolve, run as run_actuator
from isa_ros.nodes.coordinator.node import CoordinatorNode
from isa_ros.nodes.coordinator.process import main as run_coordinator
from isa_ros.nodes.coordinator.services import RunServices
from isa_ros.nodes.middleware.parameter_services import open_parameter_services
import pytest
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.node import Node
from rclpy.parameter import Parameter as RosParameter
from tests.ros.spinning import Spinning
from tests.ros.started import actuator, RIG, without_compilation

pytestmark = pytest.mark.ros


def arguments(name: str, parameters: Mapping[str, object]) -> list[str]:
    """Return the command line of an executable."""
    given = [f'{key}:={value}' for key, value in parameters.items()]
    return [name, '--ros-args', '-r', f'__node:={name}',
            *(text for one in given for text in ('-p', one))]


def assert_one_line(errors: str, start: str) -> None:
    line, = without_compilation(errors)
    assert line.startswith(start)


@pytest.mark.parametrize(('parameters', 'message'), [
    ({'model': 5}, 'knee: parameter model = 5, must be a text (one of cylinder, '),
    ({'model': 'isa_v5', 'real_time_factor': 'fast'},
     "knee: parameter real_time_factor = 'fast', must be a number (simulated over host time, "),
    ({'model': 'isa_v5', 'real_time_factor': 2.0, 'ros_time': True},
     'knee: real_time_factor = 2, must be 1 with ros_time'),
    ({'model': 'isa_v5', 'lockstep': 1}, 'knee: parameter lockstep = 1, must be true or false ('),
    ({'model': 'isa_v5', 'force.kp': 'stiff'},
     "knee: force.kp = 'stiff', must be a number in m/N"),
    ({'model': 'isa_v5', 'use_sim_time': 5}, "middleware: Trying to set parameter 'use_sim_time'"),
    ({'model': 'isa_v5', 'force_kp': 1e-7},
     'knee: parameter force_kp is unknown; did you mean force.kp'),
    ({'model': 'isa_v5', 'nosuch': 1}, 'knee: parameter nosuch is unknown; valid: lockstep, '),
    ({'modell': 'isa_v5'}, 'knee: parameter modell is unknown; did you mean model?'),
])
def test_an_actuator_refuses_it(observer, capfd, parameters, message):
    assert run_actuator(arguments('knee', parameters), '') == 2
    assert_one_line(capfd.readouterr().err, f'actuator: {message}')


@pytest.mark.parametrize(('parameters', 'message'), [
    ({'config_file': RIG, 'duration': 'long'},
     "coordinator: parameter duration = 'long', must be a number (simulated time, s; "),
    ({'config_file': RIG, 'in_process': 'maybe'},
     "coordinator: parameter in_process = 'maybe', must be true or false ("),
    ({'config_file': RIG, 'controllers': 'sway'},
     "coordinator: parameter controllers = 'sway', must be a list of names, as ['a', 'b'] ("),
    ({'config_file': RIG, 'durationn': 1.0},
     'coordinator: parameter durationn is unknown; did you mean duration?'),
    ({'config_fil': RIG}, 'coordinator: parameter config_fil is unknown; did you mean config_fil'),
])
def test_a_coordinator_refuses_it(observer, capfd, parameters, message):
    assert run_coordinator(arguments('coordinator', parameters)) == 2
    assert_one_line(capfd.readouterr().err, f'coordinator: {message}')


def test_a_step_count_out_of_its_range_is_refused(observer):
    """It is declared with the services of the run."""
    node = Node('coordinator', context=observer.context, start_parameter_services=False,
                parameter_overrides=[RosParameter('step_count', value=0)])
    try:
        with pytest.raises(ConfigError, match='^coordinator: parameter step_count: .*range'):
            RunServices(node, 1.0, lambda _: '')
    finally:
        node.destroy_node()


def test_an_integer_is_accepted_for_a_number_at_the_start_and_later(observer, tmp_path):
    """YAML reads 2 as an integer; so does `ros2 param set`."""
    with actuator(tmp_path / 'log', 'knee', model='isa_v5', real_time_factor=2):
        client = observer.create_client(SetParameters, '/knee/set_parameters')
        user = Spinning(observer)
        user.wait_for(client.service_is_ready, 'the service')
        future = client.call_async(SetParameters.Request(parameters=[
            Parameter(name='position.stiffness', value=ParameterValue(
                type=ParameterType.PARAMETER_INTEGER, integer_value=50_000))]))
        user.wait_for(future.done, 'the answer')
        assert [result.successful for result in future.result().results] == [True]


@pytest.mark.parametrize('of_run', [False, True])
def test_a_request_for_all_parameters_is_answered_with_each(observer, of_run):
    """As `ros2 param dump` asks; a list that is not set is empty, also for rclpy."""
    given = [RosParameter('config_file', value=str(RIG))]
    common = {'context': observer.context, 'parameter_overrides': given}
    node = CoordinatorNode(**common) if of_run else ActuatorNode(
        lambda node: _resolve(node, ''), 'rotor', has_mailbox=False, **common)
    if of_run:
        assert node.request().changes == ()
        open_parameter_services(node)
    service, = (own for own in node.services if own.srv_type is GetParameters)
    names = sorted(node.get_parameters_by_prefix(''))
    answer = service.callback(GetParameters.Request(names=names), GetParameters.Response())
    values = dict(zip(names, answer.values, strict=True))
    assert values['set'] == ParameterValue(type=ParameterType.PARAMETER_STRING_ARRAY)
    assert values['config_file'].string_value == str(RIG)
    if not of_run:   # the node knows that its actuator is rotary
        described = node.describe_parameter('plant.friction.coulomb').description
        assert described.endswith(', Nm') and '|' not in described
    node.destroy_node()
