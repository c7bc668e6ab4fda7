"""A run that only its scenario commands: topics, services and parameters change no signal."""

import time

from isa_ros.config.assembly import surroundings_of
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.acceptance import ACCEPT_ALL, ACCEPT_SCENARIO
from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.config.runs.run_file import load_run
from isa_ros.nodes.actuator.node import ActuatorNode, NodeSetup
from isa_ros.nodes.coordinator.joint_commands import JointCommands
from isa_ros.nodes.coordinator.parameters import SupplyParameters
from isa_ros.nodes.coordinator.services import RunServices
from isa_ros.nodes.middleware.acceptance import Acceptance
from isa_ros.nodes.middleware.throttled import BURST
import pytest
from rclpy.node import Node
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool, Trigger
from tests.ros.test_joint_command import Run as StandingLeg

pytestmark = pytest.mark.ros
REASON = 'the run has accept: scenario'


@pytest.fixture(params=[ACCEPT_ALL, ACCEPT_SCENARIO])
def accept(request):
    return request.param


@pytest.fixture
def knee(observer, accept):
    node = ActuatorNode(
        lambda _: NodeSetup(default_actuator('isa_v5', 'knee'), DEFAULT_TIMING, accept=accept),
        'knee', has_mailbox=False, context=observer.context, enable_rosout=False)
    node.actuator.tick()
    yield node
    node.destroy_node()


def test_setpoints_of_topics_are_refused_in_a_few_lines_and_one_a_second(knee, accept, capfd):
    is_open, began = accept == ACCEPT_ALL, time.monotonic()
    for _ in range(1000):
        knee._on_setpoint(JointState(name=['knee'], position=[0.05]))
    seconds = time.monotonic() - began
    knee.actuator.tick()
    assert bool(knee.actuator.memory.applied['kinds'][0]) is is_open
    lines = capfd.readouterr().err.count(f'setpoint rejected: {REASON}\n')
    assert lines == 0 if is_open else BURST <= lines <= BURST + seconds


def test_requests_are_answered_with_the_reason(knee, accept):
    answers = [
        knee._on_enable(SetBool.Request(data=False), SetBool.Response()),
        knee._on_quick_stop(Trigger.Request(), Trigger.Response()),
        knee._on_clear_fault(Trigger.Request(), Trigger.Response())]
    if accept == ACCEPT_SCENARIO:
        assert [(own.success, own.message) for own in answers] == [(False, REASON)] * 3
    else:
        assert answers[0].success and REASON not in [own.message for own in answers]
    knee.actuator.tick()
    assert bool(knee.actuator.memory.applied['kinds'][0]) is (accept == ACCEPT_ALL)


def test_parameters_keep_their_values_and_the_key_is_readable(knee, accept):
    name, is_open = 'reu.force.kp', accept == ACCEPT_ALL
    before = knee.get_parameter(name).value
    for change in (Parameter(name, value=2.0 * before), Parameter('mode', value='force')):
        result, = knee.set_parameters([change])
        assert result.successful is is_open and result.reason == ('' if is_open else REASON)
    assert knee.get_parameter(name).value == before * (2.0 if is_open else 1.0)
    assert knee.get_parameter('accept').value == accept
    result, = knee.set_parameters([Parameter('accept', value=ACCEPT_ALL)])
    assert not result.successful


def test_joints_are_not_commanded(observer, accept):
    leg = StandingLeg()
    run = load_run(find('leg', CONFIG))
    commands = JointCommands(observer, run, Acceptance(observer, accept))
    commands.bind(leg)
    commands._on_message(JointState(name=['kfe_joint'], position=[-1.5]), run.leg)
    assert leg.rows.requests['kinds'].any() == (accept == ACCEPT_ALL)


def test_the_supply_and_a_reset_are_refused_while_time_stays_free(observer, accept):
    """Steps and pauses change no signal."""
    node = Node('coordinator', context=observer.context, enable_rosout=False,
                start_parameter_services=False)
    try:
        surroundings = surroundings_of(load_run(find('leg', CONFIG)))
        services = RunServices(node, 0.0, lambda _: '', SupplyParameters(node, surroundings),
                               acceptance=Acceptance(node, accept))
        pressure, count = node.set_parameters([
            Parameter('supply.pressure_mpa', value=15.0), Parameter('step_count', value=7)])
        is_open = accept == ACCEPT_ALL
        assert pressure.successful is is_open and count.successful
        assert surroundings.tuned_value('supply.pressure_mpa') == (15.0 if is_open else 20.7)
        calls, stops = [], []

        class Run:
            t_ns = ticks = 0
            is_paused = True

            def reset(self):
                calls.append('reset')

            def step(self, n_ticks):
                calls.append(n_ticks)

            def emergency_stop(self, is_open):
                stops.append(is_open)
        services._coordinator = Run()
        answer = services._on_reset(Trigger.Request(), Trigger.Response())
        assert answer.success is is_open and (is_open or answer.message == REASON)
        assert services._on_step(Trigger.Request(), Trigger.Response()).success
        assert calls == (['reset', 7] if is_open else [7])
        for wanted in (True, False):    # whoever sees a machine go wrong may stop it
            assert services._on_emergency_stop(
                SetBool.Request(data=wanted), SetBool.Response()).success
        assert stops == [True, False]
    finally:
        node.destroy_node()
