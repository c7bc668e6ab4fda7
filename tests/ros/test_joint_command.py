"""One topic for the joints of a leg: taken as a whole, converted, recorded and replayed."""

import math
from xml.etree import ElementTree

from isa_ros.bag.reader import Bag
from isa_ros.config.assembly import surroundings_of
from isa_ros.config.paths import CONFIG, CONTROLLERS, find, shipped
from isa_ros.config.runs.acceptance import ACCEPT_ALL
from isa_ros.config.runs.body_control import control_tag, controllers_of, MANAGER
from isa_ros.config.runs.run_file import load_run
from isa_ros.core.device import FORCE, IMPEDANCE
from isa_ros.core.signals import HAS_SETPOINT
from isa_ros.nodes.coordinator.joint_commands import JointCommands
from isa_ros.nodes.middleware import throttled
from isa_ros.nodes.middleware.acceptance import Acceptance
from isa_ros.surroundings.linkage import actuator_coordinate
from isa_ros.tick.exchange import Rows
from msg_adapters.cdr_reader import decode
import pytest
from rcl_interfaces.msg import Log
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool
from std_srvs.srv import SetBool, Trigger
from tests.ros.faults import assert_replays
from tests.ros.spinning import Spinning
from tests.ros.started import bringup, wait_for

pytestmark = pytest.mark.ros
RUN = load_run(find('leg', CONFIG))
JOINTS = RUN.leg.joint_space
TOPICS_OF_CONTROL = [
    one.text for one in ElementTree.fromstringlist(control_tag(RUN.leg, ('position',), ''))
    .iterfind('hardware/param') if one.get('name').endswith('_topic')]
"""Of the tag of ros2_control: commands, states."""


class Run:
    """Stands in for a `Coordinator` between two ticks, with the leg at its start."""

    ticks = 7

    def __init__(self) -> None:
        surroundings = surroundings_of(RUN)
        self.rows = Rows(3, surroundings)
        self.rows.samples['device_mode'] = IMPEDANCE
        self.rows.samples['position'] = surroundings.starts()['position']


@pytest.fixture
def commanded(observer, monkeypatch):
    """Return a run, all warnings about it, and what hands a message over."""
    commands, run, lines = JointCommands(
        observer, RUN, Acceptance(observer, ACCEPT_ALL)), Run(), []
    commands.bind(run)
    monkeypatch.setattr(throttled, 'WARNING_PERIOD_S', 0.0)
    monkeypatch.setattr(observer.get_logger(), 'warning', lambda line, **_: lines.append(line))
    return run, lines, lambda message: commands._on_message(message, RUN.leg)


def test_a_message_moves_the_joints_that_it_names(commanded):
    run, lines, take = commanded
    take(JointState(name=['kfe_joint', 'haa_joint'], position=[-1.5, 0.1], effort=[5.0, -3.0]))
    take(JointState(name=['kfe_joint', 'kfe_joint/stiffness'], position=[-1.6, 200.0]))
    requests = run.rows.requests
    assert requests['kinds'].tolist() == [HAS_SETPOINT, 0, HAS_SETPOINT] and not lines
    for row, name, angle in ((0, 'haa_joint', 0.1), (2, 'kfe_joint', -1.6)):
        assert requests['position'][row] == actuator_coordinate(angle, JOINTS[name].linkage)[0]
    assert math.isnan(requests['stiffness'][0]) and requests['stiffness'][2] > 0.0
    assert requests['effort'][2] == 0.0
    stiffness = float(requests['stiffness'][2])
    take(JointState(name=['kfe_joint', 'kfe_joint/damping'], position=[-1.7, 3.0]))
    assert requests['stiffness'][2] == stiffness and requests['damping'][2] > 0.0
    take(JointState(name=['kfe_joint', 'kfe_joint/stiffness'], position=[-1.7, 100.0]))
    assert 0.0 < requests['stiffness'][2] < stiffness and requests['damping'][2] > 0.0
    run.ticks = 8       # they were taken
    take(JointState(name=['kfe_joint'], position=[-1.5]))
    assert requests['stiffness'][2] == pytest.approx(0.5 * stiffness)   # of a scenario, say


def test_in_mode_force_torques_alone_are_a_setpoint(commanded):
    run, lines, take = commanded
    torques = JointState(name=list(JOINTS), effort=[1.0, 2.0, 3.0])
    take(torques)
    assert not run.rows.requests['kinds'].any()
    assert lines == ['setpoint rejected: haa: setpoint position is missing or NaN, must be given '
                     'in mode impedance']
    run.rows.samples['device_mode'] = FORCE
    take(torques)
    assert run.rows.requests['kinds'].all()
    assert run.rows.requests['position'].tolist() == run.rows.samples['position'].tolist()


def test_joints_without_a_number_are_not_commanded(commanded):
    """As ros2_control sends joints that no controller has claimed: NaN in each array."""
    run, lines, take = commanded
    nan = [math.nan] * 2
    take(JointState(name=list(JOINTS), position=[*nan, -1.5], velocity=[*nan, 0.5]))
    requests = run.rows.requests
    assert requests['kinds'].tolist() == [0, 0, HAS_SETPOINT] and not lines
    position, lever, _ = actuator_coordinate(-1.5, JOINTS['kfe_joint'].linkage)
    assert requests['position'][2] == position
    assert requests['velocity'][2] == 0.5 * lever
    run.rows.samples['device_mode'] = FORCE
    take(JointState(name=list(JOINTS), effort=[math.nan, 2.0, math.nan]))
    assert requests['kinds'].tolist() == [0, HAS_SETPOINT, HAS_SETPOINT] and not lines
    assert requests['effort'][1] != 0.0 and requests['effort'][2] == 0.0
    for ends in ({'position': [math.nan] * 3}, {'effort': [math.nan] * 3}):
        run.rows.requests[:] = 0
        take(JointState(name=list(JOINTS), **ends))
        assert lines.pop() == 'setpoint rejected: setpoint gives no joint a number, all are NaN'
        assert not run.rows.requests['kinds'].any()


def test_a_joint_with_a_gain_or_an_effort_is_not_without_a_number(commanded):
    """In impedance its position has to be there."""
    run, lines, take = commanded
    for message in (
            JointState(name=['kfe_joint', 'kfe_joint/damping'], position=[math.nan, 2.0]),
            JointState(name=['kfe_joint'], position=[math.nan], effort=[1.0]),
            JointState(name=['kfe_joint'], position=[math.nan], velocity=[0.0])):
        take(message)
        assert 'setpoint position is missing or NaN, must be given in mode imp' in lines.pop()
    assert not run.rows.requests['kinds'].any()


@pytest.mark.parametrize('namespace', ['', 'lab'])
@pytest.mark.parametrize('file', shipped(CONTROLLERS))
def test_ros_finds_the_nodes_of_the_shipped_controllers_in_any_namespace(
        observer, file, namespace):
    file, config = shipped(CONTROLLERS)[file], file.partition('_')[0]
    body, = load_run(find(config, CONFIG)).bodies
    controllers = controllers_of(file, body)
    for name in (MANAGER, *controllers.types):
        node = Node(
            name, namespace=namespace, context=observer.context, use_global_arguments=False,
            cli_args=['--ros-args', '--params-file', str(file)],
            automatically_declare_parameters_from_overrides=True)
        value = {key: own.value for key, own in node.get_parameters_by_prefix('').items()}
        node.destroy_node()
        if name == MANAGER:
            assert value['update_rate'] == 500
            assert {own: value[f'{own}.type'] for own in controllers.types} == controllers.types
        elif name == 'joint_state_broadcaster':
            assert value['use_local_topics'] is True
        else:
            assert value['joints'] == list(body.joint_space)
            assert tuple(value.get('command_interfaces', [value.get('interface_name')])
                         ) == controllers.commands


def test_a_controller_of_this_tick_is_not_overwritten(commanded):
    run, lines, take = commanded
    run.rows.requests['kinds'][2], run.rows.requests['position'][2] = HAS_SETPOINT, 0.01
    for angle in (0.1, 0.2):
        take(JointState(name=['haa_joint', 'kfe_joint'], position=[angle, -1.5]))
    assert run.rows.requests['position'][2] == 0.01 and run.rows.requests['kinds'][0]
    run.ticks += 1
    run.rows.requests['position'][0] = 0.01   # of the next tick
    take(JointState(name=['haa_joint'], position=[0.1]))
    assert run.rows.requests['position'][0] == 0.01


@pytest.mark.parametrize(('message', 'refusal'), [
    (JointState(name=['hfe'], position=[0.5]), 'setpoint names hfe, must name joints of haa_'),
    (JointState(), 'setpoint names none, must name joints of'),
    (JointState(name=['hfe_joint', 'kfe_joint'], position=[0.5]),
     'setpoint has 1 values of position for 2 names'),
    (JointState(name=['hfe_joint', 'kfe_joint'], position=[0.5, 3.0]),
     'kfe_joint: setpoint position = 3 rad, must be'),
    (JointState(name=['hfe_joint', 'haa_joint'], position=[0.5, 0.0], effort=[0.0, 1e4]),
     'haa: setpoint effort = 10000 Nm, must be'),
    (JointState(name=['hfe_joint', 'hfe_joint/spol'], position=[0.5, 0.0]),
     'hfe_joint: unknown setpoint entries hfe_joint/spol')])
def test_a_message_with_one_value_that_is_refused_moves_no_joint(commanded, message, refusal):
    run, lines, take = commanded
    take(message)
    line, = lines
    assert line.startswith(f'setpoint rejected: {refusal}')
    assert not run.rows.requests['kinds'].any()


@pytest.mark.slow
def test_a_paused_leg_is_commanded_for_its_next_tick_and_replays(observer, tmp_path):
    """With real nodes; a later subscription reads that the run is paused, until it goes on."""
    bag, spinning, paused = tmp_path / 'bag', Spinning(observer), []
    publisher = observer.create_publisher(JointState, '/joint_command', 1)
    step = observer.create_client(Trigger, '/coordinator/step')
    pause = observer.create_client(SetBool, '/coordinator/pause')
    with bringup(bag, '--in-process', '--paused', '--duration', '0.02',
                 config=find('leg', CONFIG)) as run:
        spinning.wait_for(lambda: step.service_is_ready() and pause.service_is_ready()
                          and publisher.get_subscription_count(), 'the services')
        observer.create_subscription(Bool, '/coordinator/paused', paused.append, QoSProfile(
            depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
        spinning.wait_for(lambda: paused, 'the state')
        applied: list[JointState] = []
        observer.create_subscription(
            JointState, '/hfe/applied_setpoint', applied.append, 10)
        told: list[Log] = []
        observer.create_subscription(Log, '/rosout', told.append, 10)
        spinning.wait_for(lambda: 'coordinator' in {
            own.node_name for own in observer.get_publishers_info_by_topic('/rosout')}, 'its log')
        publisher.publish(JointState(name=['foo'], position=[0.6]))
        spinning.wait_for(lambda: any(
            own.name == 'coordinator' and 'setpoint names foo, must name joints' in own.msg
            for own in told), 'the reason')
        of_leg = dict(observer.get_topic_names_and_types())
        for topic in TOPICS_OF_CONTROL:
            assert of_leg[topic] == ['sensor_msgs/msg/JointState']
        assert observer.count_subscribers(TOPICS_OF_CONTROL[0]) == 1
        assert observer.count_publishers(TOPICS_OF_CONTROL[1]) == 1

        def is_applied() -> bool:
            publisher.publish(JointState(name=['hfe_joint'], position=[0.6]))
            called = step.call_async(Trigger.Request())
            spinning.wait_for(called.done, 'a tick')
            return bool(applied) or not run.is_running()
        wait_for(is_applied, 'the setpoint')
        resumed = pause.call_async(SetBool.Request(data=False))
        spinning.wait_for(resumed.done, 'the answer')
        assert run.exit_code() == 0, run.errors
        spinning.wait_for(lambda: len(paused) == 2, 'the end of the pause')
    assert [message.data for message in paused] == [True, False]
    expected = actuator_coordinate(0.6, JOINTS['hfe_joint'].linkage)[0]
    assert applied[0].position[0] == expected
    recorded = [decode(message.data, JointState).position[0] for message in Bag(bag).messages()
                if message.topic == '/hfe/applied_setpoint']
    assert expected in recorded
    assert assert_replays(bag) == 20
