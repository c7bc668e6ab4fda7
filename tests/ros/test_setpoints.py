"""Setpoints and requests of a user, to an actuator alone and in a run."""

from dataclasses import replace
import io
from pathlib import Path
import shlex
import signal
import time

from isa_ros.bag.reader import Bag
from isa_ros.config.models.catalogue import model_names
from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.nodes.actuator.alone import ready_text
from isa_ros.nodes.actuator.node import ActuatorNode, NodeSetup
from msg_adapters.cdr_reader import decode
from msg_adapters.setpoint import msg_to_command
import pytest
from rcl_interfaces.msg import ParameterEvent
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from std_srvs.srv import SetBool
from tests.ros.spinning import Spinning
from tests.ros.started import actuator, rig_until_stopped, wait_for
import yaml

pytestmark = pytest.mark.ros
ARRIVAL = 1e-3  # m: a tenth of the way


class User:
    """A user's node for one actuator: its topics and its service."""

    def __init__(self, node: Node, name: str) -> None:
        self.name = name
        self.node = node
        self.state: list[JointState] = []
        self.applied: list[JointState] = []
        node.create_subscription(JointState, f'/{name}/joint_states', self.state.append, 10)
        node.create_subscription(
            JointState, f'/{name}/applied_setpoint', self.applied.append, 10)
        self._setpoints = node.create_publisher(JointState, f'/{name}/setpoint', 1)
        self._enable = node.create_client(SetBool, f'/{name}/enable')
        self._spinning = Spinning(node)
        self.wait_for = self._spinning.wait_for

    def connect(self) -> None:
        """Wait until everything is matched, both ways."""
        self.wait_for(lambda: self.state and self._setpoints.get_subscription_count()
                      and self._enable.service_is_ready(), 'connection')
        self.wait_for(lambda: self.node.count_subscribers(f'/{self.name}/applied_setpoint'), '')

    def command(self, position: float) -> None:
        self._setpoints.publish(JointState(name=[self.name], position=[position]))

    def go_to(self, position: float) -> None:
        """Repeat a setpoint until it is echoed: the two sides match at different times."""
        def repeat() -> bool:
            self.command(position)
            self._spinning.spin_once()
            return bool(self.applied) and self.applied[-1].position[0] == position
        wait_for(repeat, 'the setpoint')

    def enable(self, on: bool) -> SetBool.Response:
        future = self._enable.call_async(SetBool.Request(data=on))
        self.wait_for(future.done, 'the answer')
        return future.result()

    def position(self) -> float:
        return self.state[-1].position[0]


def test_actuator_alone_follows_a_setpoint(observer, tmp_path):
    """One process, 1 kHz topics stamped with the host's time, and motion to a setpoint."""
    began = time.time_ns()
    with actuator(tmp_path / 'log', 'knee', model='isa_v5', ros_time=True) as process:
        user = User(observer, 'knee')
        wait_for(lambda: '[knee]: ready at 1 times real time: ' in process.errors)
        user.connect()
        target = user.position() + 0.01
        user.go_to(target)
        user.wait_for(lambda: abs(user.position() - target) < ARRIVAL, 'the arrival')
        stamps = [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec
                  for m in (*user.state[-5:], user.applied[-1])]
        assert all(stamp % 1_000_000 == 0 for stamp in stamps)
        assert all(began < stamp < time.time_ns() for stamp in stamps)
        response = user.enable(False)
        assert response.success and response.message.startswith('disabled from t = ')
        user.wait_for(lambda: user.applied[-1].position[3] == 0.0, 'the disabling')
        process.signal(signal.SIGTERM)
        assert process.exit_code() == 0
    assert 'Traceback' not in process.errors


def test_nan_is_rejected_and_the_last_setpoint_kept(observer, tmp_path):
    with actuator(tmp_path / 'log', 'knee', model='isa_v5') as process:
        user = User(observer, 'knee')
        user.connect()
        user.go_to(0.03)
        user.command(float('nan'))
        wait_for(lambda: 'rejected: knee: setpoint position is missing or NaN' in process.errors)
        user.go_to(0.031)
    echoes = [message.position[0] for message in user.applied]
    assert set(echoes[echoes.index(0.03):]) == {0.03, 0.031}


def test_incompatible_publisher_is_named(observer, tmp_path):
    """A best-effort publisher cannot serve a reliable subscription."""
    observer.create_publisher(
        JointState, '/knee/setpoint',
        QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT))
    with actuator(tmp_path / 'log', 'knee', model='isa_v5') as process:
        wait_for(lambda: '/observer: its /knee/setpoint cannot be received' in process.errors)


@pytest.fixture
def knee(observer):
    """Return what makes the node of an ISA v5 in this process."""
    context, nodes = rclpy.Context(), []
    rclpy.init(context=context)

    def made(beyond: str | None = None) -> ActuatorNode:
        config = replace(default_actuator('isa_v5', 'knee'), beyond_range=beyond)
        nodes.append(ActuatorNode(
            lambda _: NodeSetup(config, DEFAULT_TIMING), 'knee', has_mailbox=False,
            context=context))
        return nodes[-1]
    yield made
    for node in nodes:
        node.destroy_node()
    rclpy.shutdown(context=context)


@pytest.mark.parametrize('model', model_names())
def test_the_command_that_a_lone_actuator_prints_moves_it(observer, model):
    """It is one line with the topics as they are remapped; its setpoint is accepted as it is."""
    node = ActuatorNode(
        lambda _: NodeSetup(default_actuator(model, 'knee'), DEFAULT_TIMING), 'knee',
        has_mailbox=False, context=observer.context, namespace='lab',
        cli_args=['--ros-args', '-r', '~/setpoint:=/cmd', '-r', '~/joint_states:=states'])
    try:
        text = ready_text(node, 1.0)
        assert text.startswith('ready at 1 times real time: position ') and '\n' not in text
        command = shlex.split(text[text.index('ros2 topic pub'):])
        assert command[:6] == [
            'ros2', 'topic', 'pub', '--once', '/cmd', 'sensor_msgs/msg/JointState']
        assert ' on /lab/states; to move it: ros2' in text    # isa command knows no remaps
        message = JointState(**yaml.safe_load(command[6]))
        assert node.actuator.setpoint_range.admit(msg_to_command(message, 'knee')) == ''
        assert message.position[0] != pytest.approx(
            node.actuator.memory.observed[0]['position'], rel=0.1)
    finally:
        node.destroy_node()


def test_a_lone_actuator_prints_the_command_for_those_without_ros2(knee):
    """With its namespace; a tenth of the stroke beside the position at the start."""
    text = ready_text(knee(), 2.0)
    assert '; to move it: isa command knee 0.06, or ros2 topic pub --once /knee/setpoint' in text


@pytest.mark.parametrize(('beyond', 'message', 'in_force'), [
    (None, 'setpoint rejected: knee: setpoint position = 50 m, must be 0 to 0.1 m', 0.05),
    ('limit', 'knee: setpoint position = 50 m, limited to 0.1 m, the stroke', 0.1)])
def test_a_setpoint_in_mm_is_reported(observer, knee, capfd, beyond, message, in_force):
    node, log = knee(beyond), io.StringIO()
    publisher = observer.create_publisher(JointState, '/knee/setpoint', 1)

    def is_reported() -> bool:
        publisher.publish(JointState(name=['knee'], position=[50.0]))
        node.serve()
        log.write(capfd.readouterr().err)
        return message in log.getvalue()
    wait_for(is_reported, 'the warning')
    node.actuator.tick()
    in_force_now = node.actuator.memory.reu['setpoint']['position'].item()
    assert in_force_now == pytest.approx(in_force, abs=1e-6)  # a count of the encoder


def test_what_was_applied_is_shown_to_a_later_subscription(observer, knee):
    """The state is not: it is at once outdated."""
    node = knee()
    node.publish()
    node.set_parameters([Parameter('force.kp', value=9e-8)])
    node.actuator.tick()
    node.publish()
    setpoints, parameters, state = [], [], []
    kept = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    observer.create_subscription(JointState, '/knee/applied_setpoint', setpoints.append, kept)
    observer.create_subscription(
        ParameterEvent, '/knee/applied_parameters', parameters.append, kept)
    observer.create_subscription(JointState, '/knee/joint_states', state.append, 10)
    Spinning(observer).wait_for(lambda: setpoints and parameters, 'both')
    assert [message.position[0] for message in setpoints] == [
        pytest.approx(0.05, abs=1e-6)]  # a count of the encoder
    assert [change.name for change in parameters[0].changed_parameters] == ['force.kp']
    assert not state


def test_a_publisher_of_another_type_is_named(observer, knee, capfd):
    """DDS does not match it, and neither side has an event."""
    observer.create_publisher(Float64, '/knee/setpoint', 1)
    node, log = knee(), io.StringIO()

    def is_named() -> bool:
        node.check_publishers()
        log.write(capfd.readouterr().err)
        return ('/observer: its /knee/setpoint cannot be received: it is of type '
                'std_msgs/msg/Float64, must be sensor_msgs/msg/JointState') in log.getvalue()
    wait_for(is_named, 'the warning')


def test_unknown_model_is_refused(domain, tmp_path):
    with actuator(tmp_path / 'log', 'knee', model='isa_v9') as process:
        assert process.exit_code() == 2
    assert "model = 'isa_v9'" in process.errors
    assert len(process.errors.splitlines()) == 1


def recorded_setpoints(bag: Path, name: str) -> list[tuple[int, JointState]]:
    """Return (tick of the sample, message) of the applied setpoints."""
    return [
        (tick.sequence, decode(message.data, JointState))
        for tick in Bag(bag).ticks() for message in tick.messages
        if message.topic == f'/{name}/applied_setpoint']


@pytest.mark.parametrize('options', [(), ('--in-process',)])
def test_setpoint_during_a_run_is_applied_and_recorded(observer, tmp_path, options):
    """It takes effect at one tick k, is echoed with stamp t_k and recorded at sample k + 1."""
    bag = tmp_path / 'bag'
    with rig_until_stopped(bag, *options):
        user = User(observer, 'rotor')
        user.connect()
        target = user.position() + 0.01
        user.go_to(target)
        user.enable(False)
        user.wait_for(lambda: user.applied[-1].position[3] == 0.0, 'the disabling')
    first, *later = recorded_setpoints(bag, 'rotor')
    assert first[0] == 0
    for sequence, message in later:
        stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        assert stamp == (sequence - 1) * 1_000_000
        assert message.position[0] == target
    assert later[0][1].position[3] == 1.0
    assert later[-1][1].position[3] == 0.0
