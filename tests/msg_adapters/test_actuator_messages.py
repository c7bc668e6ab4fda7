"""What an actuator publishes: interface.md's table of topics, value by value."""

from isa_ros.core.accounts import FIELDS
from isa_ros.core.device import FIELDS as OF_DEVICE
from msg_adapters.actuator_messages import APPLIED_SETPOINT, STATE_TOPICS, TOPICS
from msg_adapters.cdr_reader import decode, message_class
import pytest
from tests.messages import of_actuator, packed, VALUES

T_NS, START_NS = 2_000_000_003, 1_000_000_009
ROW = {value: float(k) for k, value in enumerate(VALUES, start=1)}
"""Values of one actuator; all differ."""


def sampled(field):
    """Return a value of its sample."""
    return ROW[f'sample {field}']


def published(is_rotary=False):
    """Return the messages by topic suffix."""
    prepared = of_actuator('hip', is_rotary)
    types = dict(TOPICS)
    return {suffix: decode(data, message_class(types[suffix]))
            for suffix, data in zip(prepared, packed(
                list(prepared.values()), list(ROW.values()), T_NS, START_NS), strict=True)}


def columns(message):
    """Return the four arrays of a JointState."""
    return (list(message.name), list(message.position), list(message.velocity),
            list(message.effort))


def test_state_topics_come_sorted():
    topics = [suffix for suffix, _ in STATE_TOPICS]
    assert topics == sorted(topics)


def test_every_topic_but_those_with_texts_is_prepared():
    """Tuned parameters and the device are encoded as they come: their lengths vary."""
    assert {'applied_parameters', 'device', *of_actuator('hip', False)} == {
        suffix for suffix, _ in TOPICS}


@pytest.mark.parametrize('suffix', [suffix for suffix, _ in STATE_TOPICS])
def test_every_state_has_stamp_and_frame(suffix):
    header = published()[suffix].header
    assert (header.stamp.sec, header.stamp.nanosec) == (2, 3)
    assert header.frame_id.startswith('hip')


def test_joint_state_is_encoder_estimate_and_measured_force():
    assert columns(published()['joint_states']) == (
        ['hip'], [sampled('position')], [sampled('velocity')], [sampled('force')])


def test_valve_is_spool_with_coil_current_and_supply():
    assert columns(published()['valve']) == (
        ['hip/spool', 'hip/supply'], [sampled('spool'), sampled('supply_volume')],
        [sampled('spool_velocity'), sampled('supply_flow')], [sampled('current'), 0.0])


def test_references_come_outermost_first():
    names, positions, velocities, efforts = columns(published()['references'])
    loops = ('position', 'force', 'spool', 'current')
    assert names == [f'hip/{loop}' for loop in loops]
    assert positions == [sampled(f'{loop}_reference') for loop in loops]
    assert velocities == efforts == [0.0] * 4


@pytest.mark.parametrize('chamber', 'ab')
def test_pressures_are_the_absolute_ones(chamber):
    """As sensor_msgs/FluidPressure demands; the sample has them as gauge."""
    message = published()[f'pressure_{chamber}']
    assert message.fluid_pressure == ROW[f'absolute pressure_{chamber}']
    assert message.header.frame_id == 'hip'


@pytest.mark.parametrize('is_rotary, component', [(False, 'force.x'), (True, 'torque.z')])
def test_load_cell_measures_along_the_rod_or_about_the_shaft(is_rotary, component):
    message = published(is_rotary)['load_cell']
    values = {f'{vector}.{axis}': getattr(getattr(message.wrench, vector), axis)
              for vector in ('force', 'torque') for axis in 'xyz'}
    assert message.header.frame_id == 'hip_load_cell'
    assert values.pop(component) == sampled('force')
    assert set(values.values()) == {0.0}


def test_what_was_applied_carries_the_tick_s_start():
    """It was in force over the whole tick, at whose end it is published."""
    message = published()[APPLIED_SETPOINT[0]]
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (1, 9)
    assert list(message.position) == [ROW[f'applied {field}'] for field in (
        'position', 'stiffness', 'damping', 'is_enabled', 'mode', 'reference', 'kinds')]


def test_actuators_together_say_what_each_says_alone():
    """Names of unequal length, so that no message of the second stands where the first has it."""
    first, second = list(ROW.values()), [1e9 / (k + 1) * (-1.0) ** k for k in range(len(VALUES))]
    together = packed(
        [*of_actuator('hip', True).values(),
         *of_actuator('knee_left', False, len(VALUES)).values()], first + second, T_NS, START_NS)
    assert together == [
        *packed(list(of_actuator('hip', True).values()), first, T_NS, START_NS),
        *packed(list(of_actuator('knee_left', False).values()), second, T_NS, START_NS)]
    assert len(set(together)) == len(together)


def test_every_value_but_the_gauge_pressures_is_published():
    """Of these the absolute ones are; energies, device, age and supply are elsewhere."""
    used = {column for _, fields in of_actuator('hip', False).values()
            for column in fields.values() if column >= 0}
    assert {value for k, value in enumerate(VALUES) if k not in used} == {
        'sample pressure_a', 'sample pressure_b', 'sample power', 'sample age',
        'sample temperature', 'sample supply_pressure', 'sample cushion_pressure',
        *(f'sample {field}' for field in (*OF_DEVICE, *FIELDS) if field != 'supply_volume')}
