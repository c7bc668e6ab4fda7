"""What an actuator publishes: interface.md's table of topics, value by value."""

from isa_ros.core.signals import SAMPLE
from msg_adapters.actuator_messages import STATE_TOPICS, StateMessages
from msg_adapters.cdr_reader import decode, message_class
import numpy as np
import pytest

T_NS = 2_000_000_003


@pytest.fixture
def sample():
    """Return a row whose fields all differ, (1,): field k holds k + 1."""
    return np.array([tuple(range(1, len(SAMPLE.names) + 1))], dtype=SAMPLE)


def published(sample, is_rotary):
    """Return the messages by topic suffix."""
    return decoded(StateMessages([('hip', is_rotary)]).pack(sample, T_NS))


def decoded(state):
    """Return the messages of one actuator by topic suffix."""
    return {suffix: decode(data, message_class(type_))
            for (suffix, type_), data in zip(STATE_TOPICS, state, strict=True)}


def columns(message):
    """Return the four arrays of a JointState."""
    return (list(message.name), list(message.position), list(message.velocity),
            list(message.effort))


def test_state_topics_come_sorted():
    topics = [suffix for suffix, _ in STATE_TOPICS]
    assert topics == sorted(topics)


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


def test_same_sample_gives_the_same_bytes(sample):
    state = StateMessages([('hip', False)]).pack(sample, T_NS)
    assert StateMessages([('hip', False)]).pack(sample.copy(), T_NS) == state


def test_actuators_together_say_what_each_says_alone(sample):
    """Names of unequal length, so that no message of the second stands where the first has it."""
    other = sample.copy()
    for k, field in enumerate(SAMPLE.names):
        other[field] = -0.0 if k % 2 else 1e9 / (k + 1)
    together = StateMessages([('hip', True), ('knee_left', False)]).pack(
        np.concatenate((sample, other)), T_NS)
    assert together == [
        *StateMessages([('hip', True)]).pack(sample, T_NS),
        *StateMessages([('knee_left', False)]).pack(other, T_NS)]
