"""The emergency stop as a user calls it on real nodes: what stops, what holds it, the way back."""

from isa_ros.bag.reader import Bag
from isa_ros.replay.replay import replay
import pytest
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from std_srvs.srv import SetBool, Trigger
from tests.ros.started import rig_until_stopped
from tests.ros.test_device import Operator

pytestmark = pytest.mark.ros
GROUP = (
    '--set', 'supply.dump={kind: lag, time_constant_ms: 5.0}',
    '--set', 'actuators.rotor.parameters={plant: {block_valve: {kind: poppet}}}',
    '--set', 'emergency_stops={cell: {}}')
LOST = 'plant.sensors.force.lost'


class Caller(Operator):
    """An operator of one actuator, who may also stop all, and sees the simulated time."""

    def __init__(self, node: Node, name: str) -> None:
        super().__init__(node, name)
        self._clients['stop'] = node.create_client(SetBool, '/emergency_stop')
        self._t_s = 0.0
        node.create_subscription(Clock, '/clock', self._take_time, 10)

    def _take_time(self, message: Clock) -> None:
        self._t_s = message.clock.sec + message.clock.nanosec * 1e-9

    def stop(self, is_open: bool) -> SetBool.Response:
        """Return the answer to the call of the service."""
        return self.call('stop', SetBool.Request(data=is_open))

    def tune(self, value: float) -> None:
        """Break the load cell's wire (1), or mend it (0)."""
        own = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=value)
        result = self.call('set_parameters', SetParameters.Request(
            parameters=[Parameter(name=LOST, value=own)])).results[0]
        assert result.successful, result.reason

    def pass_time(self) -> None:
        """Wait until 50 ms of simulated time are over, ten time constants of the dump."""
        begun = self._t_s
        self._spinning.wait_for(lambda: self._t_s > begun + 0.05, 'the time')


@pytest.mark.parametrize('options', [(), ('--in-process',)], ids=['processes', 'one process'])
def test_all_stop_by_the_service_and_come_back_in_a_run_that_replays(observer, tmp_path, options):
    """Twice: by the call, and by a trip that keeps the line open until it is cleared."""
    bag = tmp_path / 'bag'
    with rig_until_stopped(bag, *GROUP, *options):
        user = Caller(observer, 'rotor')
        user.connect()
        user.wait_for('enabled', 'impedance')
        answer = user.stop(True)
        assert answer.success and answer.message.startswith('emergency stop from t = ')
        user.wait_for('disabled', 'impedance')
        refused = user.call('enable', SetBool.Request(data=True))
        assert (refused.success, refused.message) == (False, 'the emergency stop is not released')
        answer = user.stop(False)
        assert answer.success and answer.message.startswith('emergency stop released at t = ')
        user.pass_time()
        assert user.call('enable', SetBool.Request(data=True)).success
        user.wait_for('enabled', 'impedance')
        user.tune(1.0)
        user.wait_for('fault', 'impedance')
        answer = user.stop(False)
        assert not answer.success
        assert answer.message.startswith('emergency_stop.cell.opened stays open: rotor ')
        user.tune(0.0)
        user.pass_time()
        assert user.call('clear_fault', Trigger.Request()).success
        user.wait_for('disabled', 'impedance')
        assert user.stop(False).success
        user.pass_time()
        assert user.call('enable', SetBool.Request(data=True)).success
        user.wait_for('enabled', 'impedance')
    assert replay(Bag(bag)).is_equal
