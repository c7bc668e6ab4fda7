"""Gains as ROS parameters: declared, tuned during a run, recorded and replayed."""

from itertools import cycle
from pathlib import Path

from isa_ros.bag.reader import Bag
from isa_ros.bag.writer import BagWriter
from isa_ros.config.runs.default_actuator import default_actuator, DEFAULT_TIMING
from isa_ros.core.signals import START
from isa_ros.nodes.actuator.node import ActuatorNode, NodeSetup
from isa_ros.replay.replay import replay, Rerun
from isa_ros.run.packing import Messages, Packer
from msg_adapters.applied_parameters import tuned_values
from msg_adapters.cdr_reader import decode
import numpy as np
import pytest
from rcl_interfaces.msg import ParameterEvent, ParameterType
from rcl_interfaces.srv import (
    DescribeParameters, GetParameters, SetParameters, SetParametersAtomically)
from rclpy.parameter import Parameter as RosParameter
from sensor_msgs.msg import JointState
from tests.ros.started import actuator, coordinator, RIG, rig_until_stopped, without_compilation
from tests.ros.tuner import double, nanoseconds, string, Tuner

pytestmark = pytest.mark.ros
TUNED, APPLIED = 0, 1  # places in the sorted topics
KP = 2.5e-5  # A/Nm; the preset has 4e-5


def recorded(bag: Path, name: str) -> list[tuple[int, int, dict[str, float]]]:
    """Return (number of the sample, stamp in ns, values) of the applied parameters."""
    found = []
    for message in Bag(bag).messages():
        if message.topic == f'/{name}/applied_parameters':
            stamp = decode(message.data, ParameterEvent).stamp
            found.append((message.sequence, nanoseconds(stamp), tuned_values(message.data, name)))
    return found


def record_again(bag: Path, out: Path) -> Path:
    """Return the bag of a replay in one process."""
    again = Rerun(Bag(bag))
    with BagWriter(out, again.topics, Bag(bag).provenance) as writer:
        again.simulate(writer)
    return out


def content(bag: Path) -> bytes:
    """Return the content of all message files of a bag."""
    return b''.join(path.read_bytes() for path in sorted(bag.glob('*.mcap')))


def test_every_gain_is_declared_with_unit_meaning_and_range(observer, tmp_path):
    """interface.md: with range and description, in SI; the rest read-only."""
    with actuator(tmp_path / 'log', 'knee', model='isa_v5'):
        tuner = Tuner(observer, 'knee')
        tuner.connect()
        kp, limit, model, old, late, stuck = tuner.call(DescribeParameters.Request(
            names=['reu.force.kp', 'reu.force.limit', 'model', 'force.kp',
                   'plant.sensors.force.delay_ms', 'plant.spool.stuck'])).descriptors
        old.name = kp.name
        assert old == kp
        assert kp.description == (
            'proportional gain K_p; with more, one count of its sensor demands the whole output, '
            'm/N')
        span, = kp.floating_point_range
        # limit over the force sensor's count: 1.78e-4 m / (20 kN / 4096)
        assert span.from_value == 0.0 and not kp.read_only
        assert span.to_value == pytest.approx(1.78e-4 / (20e3 / 4096), rel=1e-9, abs=0.0)
        assert limit.additional_constraints == '> 0'
        # the stop of the spool; a data sheet prints three digits
        assert limit.floating_point_range[0].to_value == 1.78e-4 * 1.001
        assert late.floating_point_range[0].to_value == pytest.approx(12.7, rel=1e-12)
        assert stuck.description and not stuck.description.endswith(', 1')
        assert model.read_only
        words, = tuner.call(DescribeParameters.Request(
            names=['reu.protection.supply_low.reaction'])).descriptors
        assert words.type == ParameterType.PARAMETER_STRING
        assert words.additional_constraints == (
            'one of none, warn, hold, damp, quick_stop, disable, block')
        refused = tuner.call(SetParameters.Request(
            parameters=[string('model', 'isa_v2')])).results[0]
        assert not refused.successful and 'read-only' in refused.reason


def test_a_refused_value_is_answered_with_the_reason_and_changes_nothing(observer, tmp_path):
    """Beyond its range or the spool's stop; of two set atomically one bad, or a bad mode."""
    with actuator(tmp_path / 'log', 'knee', model='isa_v5') as process:
        tuner = Tuner(observer, 'knee')
        tuner.connect()
        before = tuner.get('force.kp', 'force.limit')
        for name, value, reason in (
                ('force.limit', 2e-4, 'force.limit out of range'),   # rclpy's own words
                ('force.limit', 0.0, 'force.limit = 0 m, must be > 0 m'),
                ('force.kp', -1.0, 'force.kp'), ('force.kp', 1e9, 'force.kp'),
                ('force.kq', 1.0, 'knee: parameter force.kq is unknown; did you mean force.k')):
            result = tuner.tune(name, value)
            assert not result.successful and reason in result.reason
        result = tuner.call(SetParametersAtomically.Request(parameters=[
            double('force.kp', 1e-7), double('force.limit', 1.0)])).result
        assert not result.successful
        result = tuner.call(SetParametersAtomically.Request(parameters=[
            double('force.kp', 1e-7), string('mode', 'pressure')])).result
        assert not result.successful and 'pressure' in result.reason
        assert tuner.get('force.kp', 'force.limit') == before
        reaction = 'reu.protection.supply_low.reaction'
        result = tuner.call(SetParameters.Request(parameters=[string(reaction, 'limit')]))
        assert not result.results[0].successful and 'must be one of none' in (
            result.results[0].reason)
        assert not tuner.events
        assert tuner.call(SetParameters.Request(
            parameters=[string(reaction, 'warn')])).results[0].successful
        found, = tuner.call(GetParameters.Request(names=[reaction])).values
        assert found.string_value == 'warn'
    assert 'Traceback' not in process.errors


def test_a_stiffness_is_a_setpoint_that_changes_this_gain_alone(observer, tmp_path):
    """After a setpoint with a gain the parameter has this gain."""
    with actuator(tmp_path / 'log', 'knee', model='isa_v5'):
        tuner = Tuner(observer, 'knee')
        tuner.connect()
        damping, = tuner.get('position.damping')
        tuner.wait_for(  # a match on one side may precede that on the other
            lambda: tuner.tune('position.stiffness', 5e4).successful and any(
                m.position[1] == 5e4 for m in tuner.setpoints), 'the echo')
        assert tuner.setpoints[-1].position[2] == damping
        publisher = observer.create_publisher(JointState, '/knee/setpoint', 1)

        def has_come() -> bool:
            publisher.publish(JointState(
                name=['knee', 'knee/stiffness'], position=[0.05, 7e4]))
            return tuner.setpoints[-1].position[1] == 7e4
        tuner.wait_for(has_come, 'the setpoint')
        assert tuner.get('position.stiffness') == [7e4]
        assert not tuner.events


@pytest.mark.parametrize('options', [(), ('--in-process',)])
def test_a_gain_tuned_in_a_run_is_recorded_with_its_tick_and_replays(
        observer, tmp_path, options):
    """Stamped t_k in sample k + 1; the replay in one process gives the same bytes."""
    bag = tmp_path / 'bag'
    with rig_until_stopped(bag, *options):
        tuner = Tuner(observer, 'rotor')
        tuner.connect()
        for value in (KP, 2.0 * KP):
            assert tuner.tune('reu.force.kp', value).successful
            assert tuner.get('reu.force.kp', 'force.kp') == [value, value]
            tuner.let_run()
        assert tuner.tune('reu.position.damping', 25.0).successful
        tuner.let_run()
    found = recorded(bag, 'rotor')
    assert [values for *_, values in found] == [{'force.kp': KP}, {'force.kp': 2.0 * KP}]
    assert all(stamp == (sample - 1) * 1_000_000 for sample, stamp, _ in found)
    assert replay(Bag(bag)).is_equal
    assert content(record_again(bag, tmp_path / 'again')) == content(bag)


class Kept:
    """An outlet with a subscription for every topic."""

    messages: Messages = ()
    wanted = None

    def has_subscribers(self) -> bool:
        return True

    def publish(self, messages: Messages) -> None:
        self.messages = messages


def published(node: ActuatorNode) -> Messages:
    """Return what a node publishes of this instant where all is subscribed."""
    outlet = Kept()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(node, 'outlet', outlet)
        node.publish()
    return outlet.messages


def test_a_node_packs_nothing_where_nobody_subscribes(observer, monkeypatch):
    setup = NodeSetup(default_actuator('isa_v5', 'knee'), DEFAULT_TIMING)
    node = ActuatorNode(
        lambda _: setup, 'knee', has_mailbox=False, context=observer.context,
        enable_rosout=False)
    try:
        node.actuator.tick()    # the device is ready, which it says
        node.publish()
        node.actuator.tick()
        expected = published(node)
        assert expected[:3] == [None] * 3 and all(expected[3:])

        def pack(*arguments):
            pytest.fail('rows were packed')
        monkeypatch.setattr(Packer, 'pack', pack)
        node.actuator.tick()
        node.publish()
    finally:
        node.destroy_node()


def test_what_was_set_stays_set_when_another_run_begins(observer):
    """It is recorded at the first tick, since the configuration does not contain it."""
    setup = NodeSetup(default_actuator('isa_v5', 'knee'), DEFAULT_TIMING)
    start = np.zeros(1, START)[0]
    start['position'], start['supply_pressure'] = 0.05, 20.7e6
    node = ActuatorNode(
        lambda _: setup, 'knee', has_mailbox=False, context=observer.context,
        enable_rosout=False)
    try:
        for name, value in (('force.kp', 9e-8), ('position.stiffness', 5e4)):
            result, = node.set_parameters([RosParameter(name, value=value)])
            assert result.successful
        for _ in range(2):
            node.actuator.start(*start.item())
            assert published(node)[TUNED] is None and node.actuator.applied_parameters == {}
            node.actuator.tick()
            messages = published(node)
            tuned = tuned_values(messages[TUNED], 'knee')
            assert tuned == node.actuator.applied_parameters == {'force.kp': 9e-8}
            assert decode(messages[APPLIED], JointState).position[1] == 5e4
            assert node.actuator.memory.applied['stiffness'].tolist() == [5e4]
            node.actuator.tick()
            assert published(node)[TUNED] is None and node.actuator.applied_parameters == {}
        gains = node.get_parameters(['force.kp', 'position.stiffness', 'force.kf'])
        assert [gain.value for gain in gains] == [9e-8, 5e4, 0.002]
    finally:
        node.destroy_node()


def test_an_override_on_the_command_line_wins_over_the_file_and_is_recorded_at_tick_0(
        domain, tmp_path):
    """The digest stays that of the file, so the run is not refused; the bag replays."""
    bag = tmp_path / 'bag'
    parameters: dict[str, object] = {
        'config_file': RIG, 'lockstep': True, 'reu.force.kp': KP,
        'position.stiffness': 200.0}
    with actuator(tmp_path / 'log', 'rotor', **parameters):
        with coordinator(tmp_path / 'run', config_file=RIG, out=bag, duration=0.05) as run:
            assert run.exit_code() == 0, run.errors
    assert recorded(bag, 'rotor') == [(1, 0, {'force.kp': KP})]
    assert replay(Bag(bag)).is_equal


@pytest.mark.parametrize(('name', 'value', 'message'), [
    ('force.kq', 1.0, 'knee: parameter force.kq is unknown; did you mean force.k'),
    ('force.kp', -1.0, 'knee: force.kp = -1 m/N, must be >= 0 m/N (proportional gain K_p; '),
    ('force.kp', 1e9, 'knee: force.kp = 1e+09 m/N, must be <= 3.64544e-05 m/N (proportional '),
    ('force.limit', 1, 'knee: force.limit = 1 m, must be <= 0.000178178 m'),  # an integer
])
def test_a_wrong_override_is_refused_in_one_line(domain, tmp_path, name, value, message):
    """Exit code 2."""
    with actuator(tmp_path / 'log', 'knee', model='isa_v5', **{name: value}) as process:
        assert process.exit_code() == 2
    line, = without_compilation(process.errors)
    assert message in line


def test_a_lone_actuator_begins_with_its_override_and_says_what_changed(observer, tmp_path):
    """The two sides match at different times: two values by turns until the echo arrives."""
    with actuator(tmp_path / 'log', 'knee', model='isa_v5', **{'force.kp': 7e-8}):
        tuner = Tuner(observer, 'knee')
        tuner.connect()
        assert tuner.get('force.kp', 'force.kf') == [7e-8, 0.002]
        values = cycle((5e-8, 6e-8))
        tuner.wait_for(
            lambda: tuner.tune('force.kp', next(values)).successful and tuner.events, 'the echo')
    event = tuner.events[-1]
    assert (event.node, nanoseconds(event.stamp) % 1_000_000) == ('/knee', 0)
    changed, = event.changed_parameters
    # 7e-8, in force from tick 0, for subscribers that match by then
    assert changed.name == 'force.kp' and changed.value.double_value in (5e-8, 6e-8, 7e-8)
