"""What an actuator publishes: interface.md's table of topics, value by value."""

from isa_ros.signals import COMMAND, SAMPLE
from msg_adapters.actuator_messages import ActuatorMessages, APPLIED_SETPOINT, STATE_TOPICS
from msg_adapters.cdr_reader import decode, message_class
import numpy as np
import pytest

T_NS = 2_000_000_003


@pytest.fixture
def sample():
    """Return a row whose fields all differ: field k holds k + 1."""
    return np.array([tuple(range(1, len(SAMPLE.names) + 1))], dtype=SAMPLE)[0]


def published(sample, is_rotary):
    """Return the messages by topic suffix."""
    types = dict(STATE_TOPICS)
    state = ActuatorMessages('hip', is_rotary).state(sample, T_NS)
    return {suffix: decode(data, message_class(types[suffix])) for suffix, data in state}


def columns(message):
    """Return the four arrays of a JointState."""
    return (list(message.name), list(message.position), list(message.velocity),
            list(message.effort))


def test_state_topics_come_sorted_and_complete(sample):
    topics = [suffix for suffix, _ in ActuatorMessages('hip', False).state(sample, T_NS)]
    assert topics == sorted(topics) == [suffix for suffix, _ in STATE_TOPICS]


def test_every_header_has_stamp_and_frame(sample):
    for suffix, message in published(sample, False).items():
        assert (message.header.stamp.sec, message.header.stamp.nanosec) == (2, 3), suffix
        assert message.header.frame_id.startswith('hip'), suffix


def test_joint_state_is_encoder_estimate_and_measured_force(sample):
    message = published(sample, False)['joint_states']
    assert columns(message) == (
        ['hip'], [sample['position']], [sample['velocity']], [sample['force']])


def test_valve_is_spool_with_coil_current_and_supply(sample):
    assert columns(published(sample, False)['valve']) == (
        ['hip/spool', 'hip/supply'], [sample['spool'], sample['supply_volume']],
        [sample['spool_velocity'], sample['supply_flow']], [sample['current'], 0.0])


def test_references_come_outermost_first(sample):
    names, positions, velocities, efforts = columns(published(sample, False)['references'])
    loops = ('position', 'force', 'spool', 'current')
    assert names == [f'hip/{loop}' for loop in loops]
    assert positions == [sample[f'{loop}_reference'] for loop in loops]
    assert velocities == efforts == [0.0] * 4


def test_pressures_are_absolute(sample):
    """Gauge + 101325 Pa, as sensor_msgs/FluidPressure demands."""
    messages = published(sample, False)
    for chamber in 'ab':
        message = messages[f'pressure_{chamber}']
        assert message.fluid_pressure == sample[f'pressure_{chamber}'] + 101325.0
        assert message.header.frame_id == f'hip_pressure_{chamber}'


@pytest.mark.parametrize('is_rotary, component', [(False, 'force.x'), (True, 'torque.z')])
def test_load_cell_measures_along_the_rod_or_about_the_shaft(sample, is_rotary, component):
    message = published(sample, is_rotary)['load_cell']
    values = {f'{vector}.{axis}': getattr(getattr(message.wrench, vector), axis)
              for vector in ('force', 'torque') for axis in 'xyz'}
    assert message.header.frame_id == 'hip_load_cell'
    assert values.pop(component) == sample['force']
    assert set(values.values()) == {0.0}


def test_applied_setpoint_has_its_topic():
    row = np.zeros(1, dtype=COMMAND)[0]
    suffix, data = ActuatorMessages('hip', True).applied_setpoint(row, T_NS)
    assert suffix == APPLIED_SETPOINT[0]
    assert decode(data, message_class(APPLIED_SETPOINT[1])).header.stamp.nanosec == 3


def test_same_sample_gives_the_same_bytes(sample):
    state = ActuatorMessages('hip', False).state(sample, T_NS)
    assert ActuatorMessages('hip', False).state(sample.copy(), T_NS) == state
