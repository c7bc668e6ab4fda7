"""Two legs in namespaces on real nodes: the same bytes, and names of their nodes and topics."""

from pathlib import Path
from xml.etree import ElementTree

import isa_ros
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.runs.body_control import control_tag
from isa_ros.config.text.yaml_text import dump
import pytest
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool, Trigger
from tests.ros.bags import mcap_file
from tests.ros.faults import assert_replays
from tests.ros.spinning import Spinning
from tests.ros.started import bringup, started, wait_for
from tests.scripting.test_robots import HOP, PAIR

pytestmark = [pytest.mark.ros, pytest.mark.slow]
KP = 'reu.force.kp'
SUPPLY = 'r2/supply.pressure_mpa'


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    """Return the files of a run of two legs, and of their scenario."""
    paths = tmp_path / 'pair.yaml', tmp_path / 'hop.yaml'
    for path, tree in zip(paths, (PAIR, HOP)):
        path.write_text(dump(tree))
    return paths


@pytest.mark.parametrize('how', [('--namespace', 'lab'), ('--in-process',)])
def test_the_bag_has_the_bytes_of_the_run_in_memory(domain, tmp_path, files, how):
    config, scenario = files
    with bringup(tmp_path / 'bag', '--scenario', str(scenario), *how, config=config) as run:
        assert run.exit_code() == 0, run.errors
    saved = isa_ros.load(config, scenario).simulate().save(tmp_path / 'saved')
    assert mcap_file(tmp_path / 'bag').read_bytes() == mcap_file(saved).read_bytes()


@pytest.mark.parametrize('how', [(), ('--in-process',)])
def test_nodes_take_setpoints_parameters_and_requests_in_their_namespaces(
        observer, tmp_path, files, how):
    """Below the run's own; each changes its robot alone, and all of it replays."""
    config, _ = files
    kept = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    applied, joints = [], {}
    for robot in ('r1', 'r2'):
        observer.create_subscription(
            JointState, f'/lab/{robot}/{"kfe" if robot == "r1" else "hfe"}/applied_setpoint',
            lambda message: applied.append((message.name[0], message.position[0])), kept)
        observer.create_subscription(
            JointState, f'/lab/{robot}/joint_states',
            lambda message, robot=robot: joints.update({robot: list(message.name)}), kept.depth)
    commands = [observer.create_publisher(JointState, f'/lab/{topic}', 1) for topic in (
        'r1/kfe/setpoint', 'r2/joint_command')]
    bag = tmp_path / 'bag'
    spinning = Spinning(observer)
    with bringup(
            bag, '--namespace', 'lab', '--paused', '--join-timeout', '100', *how,
            config=config) as run:
        def called(kind, name, **values):
            client = observer.create_client(kind, name)
            spinning.wait_for(client.service_is_ready, name)
            future = client.call_async(kind.Request(**values))
            spinning.wait_for(future.done, name)
            return future.result()

        def steps(count=1):
            for _ in range(count):
                assert called(Trigger, '/lab/coordinator/step').success
        steps()
        nodes = set(observer.get_node_names_and_namespaces())
        assert {('kfe', '/lab/r1'), ('kfe', '/lab/r2'), ('coordinator', '/lab')} <= nodes
        spinning.wait_for(lambda: all(
            own.get_subscription_count() for own in commands), 'subscriptions')

        def have_arrived():
            commands[0].publish(JointState(name=['r1/kfe'], position=[0.05]))
            commands[1].publish(JointState(name=['hfe_joint'], position=[0.7]))
            steps()
            return {'r1/kfe', 'r2/hfe'} <= {name for name, *_ in applied}
        wait_for(have_arrived, 'the setpoints')
        value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=1e-9)
        answer = called(SetParameters, '/lab/r2/kfe/set_parameters',
                        parameters=[Parameter(name=KP, value=value)])
        assert answer.results[0].successful, answer.results[0].reason
        value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=19.0)
        answer = called(SetParameters, '/lab/coordinator/set_parameters',
                        parameters=[Parameter(name=SUPPLY, value=value)])
        assert answer.results[0].successful, answer.results[0].reason
        assert called(SetBool, '/lab/r2/haa/enable', data=False).success
        steps(3)
        for robot, expected in (('r1', False), ('r2', True)):
            found = called(GetParameters, f'/lab/{robot}/kfe/get_parameters', names=[KP])
            assert (found.values[0].double_value == 1e-9) == expected
        assert called(SetBool, '/lab/coordinator/pause', data=False).success
        assert called(SetBool, '/lab/emergency_stop', data=True).success
        run.signal(15)
        assert run.exit_code() == 130, run.errors
    result = isa_ros.read(bag)
    assert result['r2/hfe.position_reference'][-1] != result['r2/hfe.position_reference'][0]
    assert result['r2/supply.pressure'][-1] == 19e6 != result['r1/supply.pressure'][-1]
    assert joints == {robot: ['haa_joint', 'hfe_joint', 'kfe_joint', 'slider_joint']
                      for robot in ('r1', 'r2')}
    assert ('r1/kfe', 0.05) in applied
    assert assert_replays(bag) > 0


def test_an_actuator_of_a_robot_elsewhere_takes_part(domain, tmp_path, files):
    """By its name in the run."""
    config, scenario = files
    bag = tmp_path / 'bag'
    with started(tmp_path / 'host.log', 'isa_ros', 'actuators', str(config), 'r2/kfe',
                 '--scenario', str(scenario), '--namespace', 'lab'):
        with bringup(bag, '--scenario', str(scenario), '--elsewhere', 'r2/kfe', '--namespace',
                     'lab', '--join-timeout', '60', config=config) as run:
            assert run.exit_code() == 0, run.errors
    assert assert_replays(bag) > 0


def test_the_tag_of_ros2_control_names_topics_and_joints_of_a_running_robot(observer, tmp_path):
    """What its hardware subscribes to is published with all joints, what it publishes is taken."""
    body, = isa_ros.load('quadruped').configuration.bodies
    tag = ElementTree.fromstringlist(control_tag(body, ('effort',), 'lab'))
    commands, states = (tag.findtext(f'hardware/param[@name="joint_{what}_topic"]')
                        for what in ('commands', 'states'))
    spinning, found = Spinning(observer), []
    observer.create_subscription(JointState, states, found.append, 10)
    with bringup(tmp_path / 'bag', '--in-process', '--namespace', 'lab', '--duration', '1000',
                 config=find('quadruped', CONFIG)) as run:
        spinning.wait_for(lambda: found or not run.is_running(), 'the states')
        assert observer.count_subscribers(commands) == observer.count_publishers(states) == 1
        run.signal(15)
        assert run.exit_code() == 130, run.errors
    joints = {joint.get('name') for joint in tag.iterfind('joint')}
    assert joints == set(found[0].name) and len(joints) == 12
