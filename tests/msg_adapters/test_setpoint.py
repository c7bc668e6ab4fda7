"""Setpoints: what is accepted, what it means, and what is refused by name."""

import math

from hypothesis import given, settings, strategies as st
from isa_ros.core.signals import (
    COMMAND, EVERY_KIND, HAS_ENABLE, HAS_REFERENCE, HAS_SETPOINT, WAS_REFUSED)
from isa_ros.errors import SetpointError
from msg_adapters.cdr import encode
from msg_adapters.cdr_reader import decode
from msg_adapters.setpoint import applied_kinds, applied_to_command, msg_to_command
import numpy as np
import pytest
from sensor_msgs.msg import JointState
from tests.messages import applied_setpoint

finite = st.floats(allow_nan=False, allow_infinity=False)
positive = st.floats(0.0, allow_infinity=False)


def command(**values):
    """Return a COMMAND row, unnamed fields zero."""
    row = np.zeros(1, dtype=COMMAND)[0]
    for name, value in values.items():
        row[name] = value
    return row


def test_plain_joint_state_keeps_the_gains():
    row = msg_to_command(JointState(name=['hip'], position=[0.5]), 'hip')
    assert row['kinds'] == HAS_SETPOINT
    assert (row['position'], row['velocity'], row['effort']) == (0.5, 0.0, 0.0)
    assert math.isnan(row['stiffness']) and math.isnan(row['damping'])


def test_velocity_and_effort_are_taken():
    message = JointState(name=['hip'], position=[0.5], velocity=[-1.0], effort=[20.0])
    row = msg_to_command(message, 'hip')
    assert (row['velocity'], row['effort']) == (-1.0, 20.0)


def test_gains_are_entries_in_any_order():
    message = JointState(
        name=['hip/damping', 'hip', 'hip/stiffness'], position=[20.0, 0.5, 300.0],
        velocity=[0.0, 1.0, 0.0])
    row = msg_to_command(message, 'hip')
    assert (row['position'], row['velocity']) == (0.5, 1.0)
    assert (row['stiffness'], row['damping']) == (300.0, 20.0)


def test_one_gain_alone_keeps_the_other():
    message = JointState(name=['hip', 'hip/stiffness'], position=[0.5, 300.0])
    row = msg_to_command(message, 'hip')
    assert row['stiffness'] == 300.0 and math.isnan(row['damping'])


@pytest.mark.parametrize('value', [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize('array', ['position', 'velocity', 'effort'])
@pytest.mark.parametrize('entry', [0, 1])
def test_a_value_that_is_not_finite_rejects_the_whole_message(value, array, entry):
    """But NaN in the entry of the actuator is a number that is not given."""
    if math.isnan(value) and not entry:
        return
    columns = {name: [0.0, 0.0] for name in ('position', 'velocity', 'effort')}
    columns[array][entry] = value
    message = JointState(name=['hip', 'hip/stiffness'], **columns)
    with pytest.raises(SetpointError, match=rf'hip.*: setpoint {array} = -?(nan|inf), must be'):
        msg_to_command(message, 'hip')


@pytest.mark.parametrize('absent', [
    JointState(name=['hip'], effort=[20.0]),
    JointState(name=['hip'], position=[math.nan], velocity=[0.0], effort=[20.0])])
def test_an_effort_alone_has_no_position(absent):
    """As hardware interfaces of ros2_control that have no position interface send it."""
    row = msg_to_command(absent, 'hip')
    assert row['kinds'] == HAS_SETPOINT and math.isnan(row['position'])
    assert (row['velocity'], row['effort']) == (0.0, 20.0)


def test_numbers_that_are_not_given_stay_so():
    row = msg_to_command(JointState(
        name=['hip'], position=[0.5], velocity=[math.nan], effort=[math.nan]), 'hip')
    assert row['position'] == 0.5 and math.isnan(row['velocity']) and math.isnan(row['effort'])


@pytest.mark.parametrize(('entry', 'mode'), [('current', 1), ('spool', 2), ('pressure', 3)])
def test_the_reference_of_a_mode_is_an_entry_with_or_without_a_setpoint(entry, mode):
    row = msg_to_command(JointState(name=[f'hip/{entry}'], position=[1e-3]), 'hip')
    assert (row['kinds'], row['mode'], row['reference']) == (HAS_REFERENCE, mode, 1e-3)
    row = msg_to_command(
        JointState(name=['hip', f'hip/{entry}'], position=[0.5, 1e-3]), 'hip')
    assert row['kinds'] == HAS_SETPOINT | HAS_REFERENCE


@pytest.mark.parametrize('message, said', [
    (JointState(name=['hip/spool', 'hip/current'], position=[0.0, 0.0]),
     'hip: setpoint has current and spool, must be the one of its mode'),
    (JointState(name=['hip/spool'], position=[math.nan]), 'hip/spool: setpoint position = nan'),
    (JointState(name=['knee'], position=[0.0]),
     'hip: is not among the joints of the setpoint, knee'),
    (JointState(), 'hip: is not among the joints of the setpoint, none'),
    (JointState(name=['hip', 'hip/stifness'], position=[0.0, 1.0]),
     'unknown setpoint entries hip/stifness, must'),
    (JointState(name=['hip', 'hip'], position=[0.0, 1.0]), 'names an entry twice'),
    (JointState(name=['hip']), 'hip: setpoint has neither position, velocity nor effort'),
    (JointState(name=['hip', 'hip/damping'], effort=[1.0]), '0 positions for 2 names'),
    (JointState(name=['hip'], position=[0.0, 1.0]), '2 positions for 1 names'),
    (JointState(name=['hip'], position=[0.0], effort=[1.0, 2.0]), '2 values of effort for 1'),
    (JointState(name=['hip', 'hip/damping'], position=[0.0, -1.0]),
     'hip/damping = -1.0, must be >= 0'),
])
def test_malformed_setpoint_is_refused(message, said):
    with pytest.raises(SetpointError, match=said):
        msg_to_command(message, 'hip')


@given(position=finite, velocity=finite, effort=finite, stiffness=positive, damping=positive,
       is_enabled=st.integers(0, 1), mode=st.integers(0, 6), reference=finite,
       kinds=st.integers(0, EVERY_KIND), t_ns=st.integers(0, 10**12))
@settings(deadline=None)
def test_applied_setpoint_comes_back_bit_for_bit(t_ns, **values):
    """Replay feeds the recorded applied setpoints, so the round trip must be exact."""
    row = command(**values)
    data = applied_setpoint('hip', row, t_ns)
    assert applied_to_command(data, 'hip').tobytes() == row.tobytes()


def test_applied_setpoint_names_all_that_took_effect():
    row = command(position=0.5, velocity=1.0, effort=2.0, stiffness=300.0, damping=20.0,
                  is_enabled=1, mode=6, reference=1e-4, kinds=9)
    message = decode(applied_setpoint('hip', row, 3_000_000_004), JointState)
    assert message.name == ['hip', 'hip/stiffness', 'hip/damping', 'hip/enabled', 'hip/mode',
                            'hip/reference', 'hip/changed']
    assert list(message.position) == [0.5, 300.0, 20.0, 1.0, 6.0, 1e-4, 9.0]
    assert list(message.velocity) == [1.0, *[0.0] * 6]
    assert list(message.effort) == [2.0, *[0.0] * 6]
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (3, 4)
    assert message.header.frame_id == 'hip'


def test_applied_setpoint_of_another_actuator_is_refused():
    data = applied_setpoint('knee', command(), 0)
    with pytest.raises(SetpointError, match='hip: applied setpoint names knee'):
        applied_to_command(data, 'hip')


@pytest.mark.parametrize(('entry', 'value', 'message'), [
    (3, 0.5, 'hip/enabled = 0.5, must be a whole number of 0 to 1'),
    (3, 2.0, 'hip/enabled = 2.0, must be a whole number of 0 to 1'),
    (4, 7.0, 'hip/mode = 7.0, must be a whole number of 0 to 6'),
    (6, -1.0, 'hip/changed = -1.0, must be a whole number of 0 to 255')])
def test_numbers_of_an_applied_setpoint_are_whole_and_known(entry, value, message):
    found = decode(applied_setpoint('hip', command(), 0), JointState)
    found.position[entry] = value
    with pytest.raises(SetpointError, match=message):
        applied_to_command(encode(found), 'hip')


def cut(n):
    """Return an applied setpoint with its first ``n`` entries."""
    found = decode(applied_setpoint('hip', command(
        position=0.5, velocity=1.0, effort=2.0, stiffness=300.0, damping=20.0, is_enabled=1), 0),
        JointState)
    for field in ('name', 'position', 'velocity', 'effort'):
        setattr(found, field, list(getattr(found, field))[:n])
    return encode(found)


def test_what_was_applied_before_there_were_modes_is_a_setpoint_with_enable():
    row = applied_to_command(cut(4), 'hip')
    assert row.tobytes() == command(
        kinds=HAS_SETPOINT | HAS_ENABLE, is_enabled=1, position=0.5, velocity=1.0, effort=2.0,
        stiffness=300.0, damping=20.0).tobytes()
    for n in (0, 1, 3, 5, 6):
        with pytest.raises(SetpointError, match='hip: applied setpoint names '):
            applied_to_command(cut(n), 'hip')


@pytest.mark.parametrize('stayed', [0, 1])
def test_a_refused_request_is_read_as_it_was_asked(stayed):
    """Of enable or disable: what stayed is the opposite."""
    data = applied_setpoint('hip', command(kinds=HAS_ENABLE | WAS_REFUSED, is_enabled=stayed), 0)
    row = applied_to_command(data, 'hip')
    assert (row['kinds'], row['is_enabled']) == (HAS_ENABLE, 1 - stayed)


@pytest.mark.parametrize('field', ['position', 'velocity', 'effort'])
@pytest.mark.parametrize('read', [applied_to_command, applied_kinds])
def test_an_applied_setpoint_has_all_values_of_each_entry(read, field):
    found = decode(applied_setpoint('hip', command(), 0), JointState)
    setattr(found, field, list(getattr(found, field))[:6])
    with pytest.raises(SetpointError, match='with all values of each'):
        read(encode(found), 'hip')


@pytest.mark.parametrize('entry', range(7))
@pytest.mark.parametrize('value', [math.nan, math.inf])
def test_an_applied_setpoint_lacks_no_value(entry, value):
    """All of them are in force; one that was sent may lack some."""
    found = decode(applied_setpoint('hip', command(), 0), JointState)
    found.position[entry] = value
    with pytest.raises(SetpointError, match='hip: applied .* must be finite'):
        applied_to_command(encode(found), 'hip')


@given(kinds=st.integers(0, EVERY_KIND | WAS_REFUSED))
@settings(deadline=None)
def test_what_changed_is_read_with_whether_it_was_refused(kinds):
    assert applied_kinds(applied_setpoint('hip', command(kinds=kinds), 0), 'hip') == kinds


def test_what_changed_in_a_message_that_does_not_say_it_is_refused():
    """Of another actuator, or as bags had it before there were modes."""
    with pytest.raises(SetpointError, match='hip: applied setpoint names knee'):
        applied_kinds(applied_setpoint('knee', command(), 0), 'hip')
    found = decode(applied_setpoint('hip', command(), 0), JointState)
    found.name, found.position = found.name[:4], found.position[:4]
    with pytest.raises(SetpointError, match='hip: applied setpoint names hip, '):
        applied_kinds(encode(found), 'hip')
