"""The device over ROS: its topic, services and mode, in a run that replays."""

import math
import time

from diagnostic_msgs.msg import DiagnosticStatus
from isa_ros.bag.reader import Bag
from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.nodes.actuator.node import ActuatorNode, NodeSetup
from isa_ros.nodes.middleware.qos import KEPT
from isa_ros.nodes.middleware.throttled import BURST
from isa_ros.replay.replay import replay
from msg_adapters.cdr_reader import decode
import pytest
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool, Trigger
from tests.ros.spinning import Spinning
from tests.ros.started import rig_until_stopped

pytestmark = pytest.mark.ros
MANY = 10_000


class Operator:
    """A user's node for the device of one actuator."""

    def __init__(self, node: Node, name: str) -> None:
        self.status: list[DiagnosticStatus] = []
        node.create_subscription(DiagnosticStatus, f'/{name}/device', self.status.append, KEPT)
        self._clients = {
            suffix: node.create_client(type_, f'/{name}/{suffix}') for suffix, type_ in (
                ('enable', SetBool), ('clear_fault', Trigger), ('quick_stop', Trigger),
                ('set_parameters', SetParameters), ('get_parameters', GetParameters))}
        self._spinning = Spinning(node)

    def connect(self) -> None:
        """Wait for the last status, which a later subscription receives too, and all services."""
        self._spinning.wait_for(
            lambda: self.status and all(
                client.service_is_ready() for client in self._clients.values()), 'connection')

    def call(self, suffix: str, request: object) -> object:
        """Return the answer to a request."""
        future = self._clients[suffix].call_async(request)
        self._spinning.wait_for(future.done, 'the answer')
        return future.result()

    def set_mode(self, mode: str) -> object:
        """Set the parameter and return the result."""
        value = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=mode)
        return self.call('set_parameters', SetParameters.Request(
            parameters=[Parameter(name='mode', value=value)])).results[0]

    def mode(self) -> str:
        """Return the parameter."""
        return self.call(
            'get_parameters', GetParameters.Request(names=['mode'])).values[0].string_value

    def wait_for(self, state: str, mode: str) -> DiagnosticStatus:
        """Wait until the device is in a state and mode, and return what it says."""
        def is_there() -> bool:
            values = {entry.key: entry.value for entry in self.status[-1].values}
            return (values['state'], values['mode']) == (state, mode)
        self._spinning.wait_for(is_there, f'{state}, {mode}')
        return self.status[-1]


@pytest.mark.parametrize('options', [(), ('--in-process',)])
def test_it_is_operated_during_a_run_that_replays(observer, tmp_path, options):
    """Mode, refusals with their reason, quick stop, enable; the bag replays byte for byte."""
    bag = tmp_path / 'bag'
    with rig_until_stopped(bag, *options):
        user = Operator(observer, 'rotor')
        user.connect()
        assert user.wait_for('enabled', 'impedance').level == DiagnosticStatus.OK
        assert user.set_mode('force').successful
        assert user.wait_for('enabled', 'force').message == (
            'enabled, mode force: the mode was changed')
        assert user.mode() == 'force'
        refused = user.set_mode('spool')
        assert not refused.successful
        assert refused.reason == (
            'mode = spool: reu.spool.kind = off; possible: current, force, impedance')
        answer = user.call('clear_fault', Trigger.Request())
        assert (answer.success, answer.message) == (
            False, 'the state is enabled, clear_fault needs fault')
        answer = user.call('quick_stop', Trigger.Request())
        assert answer.success and answer.message.startswith('quick stop from t = ')
        status = user.wait_for('disabled', 'force')
        assert status.message == 'disabled, mode force: the quick stop has ended'
        assert not user.call('quick_stop', Trigger.Request()).success
        assert user.call('enable', SetBool.Request(data=True)).success
        user.wait_for('enabled', 'force')
    states = [decode(message.data, DiagnosticStatus).message.partition(',')[0]
              for message in Bag(bag).messages() if message.topic == '/rotor/device']
    changes = [state for k, state in enumerate(states) if k == 0 or state != states[k - 1]]
    assert changes == ['initialising', 'enabled', 'quick stop', 'disabled', 'enabled']
    assert replay(Bag(bag)).is_equal


def test_ten_thousand_bad_setpoints_leave_its_state_and_a_line_a_second(observer, capfd):
    """NaN, wrong names and lengths, beyond the range, of another mode: warnings are throttled."""
    node = ActuatorNode(
        lambda _: NodeSetup(default_actuator('isa_v5', 'knee'), DEFAULT_TIMING), 'knee',
        has_mailbox=False, context=observer.context)
    bad = [
        JointState(name=['knee'], position=[math.nan]),
        JointState(name=['knee'], position=[math.inf]),
        JointState(name=['hip'], position=[0.0]), JointState(name=['knee'] * 2, position=[0.0]),
        JointState(name=['knee'], position=[50.0]), JointState(name=['knee'] * 9000),
        JointState(name=['knee/spool'], position=[1e-5])]
    try:
        node.actuator.tick()
        before, began = node.actuator.memory.applied.tobytes(), time.monotonic()
        for k in range(MANY):
            node._on_setpoint(bad[k % len(bad)])
        seconds = time.monotonic() - began
        node.actuator.tick()
        assert node.actuator.memory.applied['kinds'] == 0
        assert node.actuator.memory.applied.tobytes() == before
        assert node.actuator.memory.observed['device_state'] == 2
    finally:
        node.destroy_node()
    lines = capfd.readouterr().err.count('setpoint rejected')
    assert BURST <= lines <= BURST + seconds
