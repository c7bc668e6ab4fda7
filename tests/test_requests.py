"""Controllers' setpoints become commands, or are refused as a whole."""

import math

from isa_ros.controller import Setpoint, Setpoints
from isa_ros.core.device import FORCE, IMPEDANCE, POSITION
from isa_ros.core.record import row_record
from isa_ros.core.signals import (
    COMMAND, HAS_CLEAR_FAULT, HAS_ENABLE, HAS_GAINS, HAS_MODE, HAS_QUICK_STOP, HAS_REFERENCE,
    HAS_SETPOINT, SAMPLE)
from isa_ros.errors import SetpointError
from isa_ros.requests import fill_requests, merge_requests
import numpy as np
import pytest

NAMES = ('haa', 'kfe')


def requests(**setpoints: Setpoint) -> np.ndarray:
    """Return the rows that setpoints by name fill."""
    rows = np.zeros(2, COMMAND)
    fill_requests(setpoints, NAMES, rows)
    return rows


def test_a_setpoint_fills_the_row_of_its_actuator():
    """A missing gain keeps the one in force; other actuators receive no command."""
    rows = requests(kfe=Setpoint(0.1, 0.2, 30.0, damping=400.0))
    assert rows['kinds'].tolist() == [0, HAS_SETPOINT]
    _, _, position, velocity, effort, stiffness, damping, *_ = rows[1].item()
    assert (position, velocity, effort, damping) == (0.1, 0.2, 30.0, 400.0)
    assert math.isnan(stiffness)


@pytest.mark.parametrize('is_enabled', [True, False])
def test_enabling_comes_with_the_setpoint(is_enabled):
    row = requests(haa=Setpoint(0.0, is_enabled=is_enabled))[0]
    assert row['kinds'] == HAS_SETPOINT | HAS_ENABLE
    assert row['is_enabled'] == is_enabled


@pytest.mark.parametrize(('setpoint', 'kinds', 'mode', 'reference'), [
    (Setpoint(mode='force'), HAS_MODE, 4, 0.0),
    (Setpoint(mode='spool', spool=1e-4), HAS_MODE | HAS_REFERENCE, 2, 1e-4),
    (Setpoint(current=1e-3), HAS_REFERENCE, 1, 1e-3),
    (Setpoint(clear_fault=True, is_enabled=True), HAS_CLEAR_FAULT | HAS_ENABLE, 0, 0.0),
    (Setpoint(quick_stop=True), HAS_QUICK_STOP, 0, 0.0)])
def test_the_device_is_commanded_without_a_position(setpoint, kinds, mode, reference):
    row = requests(haa=setpoint)[0]
    assert (row['kinds'], row['mode'], row['reference']) == (kinds, mode, reference)


@pytest.mark.parametrize(('setpoint', 'message'), [
    (Setpoint(velocity=5.0), 'haa: setpoint velocity = 5 needs its position'),
    (Setpoint(stiffness=-1.0), 'haa: setpoint stiffness = -1.0, must be >= 0'),
    (Setpoint(mode='speed'), "haa: setpoint mode = 'speed', must be one of current, spool, press"),
    (Setpoint(spool=1e-4, current=1.0), 'haa: setpoint has current and spool, must be the one'),
    (Setpoint(mode='force', spool=1e-4), 'haa: setpoint spool is not of mode force'),
    (Setpoint(spool=math.inf), 'haa: setpoint spool = inf, must be finite'),
    (Setpoint(quick_stop=1), 'haa: setpoint quick_stop = 1, must be True or False'),
    (Setpoint(math.nan), 'haa: setpoint position = nan, must be finite'),
    (Setpoint(0.0, effort=math.inf), 'haa: setpoint effort = inf, must be finite'),
    (Setpoint(0.0, damping=math.nan), 'haa: setpoint damping = nan, must be finite'),
    (Setpoint(0.0, stiffness=-1.0), 'haa: setpoint stiffness = -1.0, must be >= 0')])
def test_a_value_that_cannot_be_is_refused(setpoint, message):
    with pytest.raises(SetpointError, match=message):
        requests(haa=setpoint)


def test_gains_alone_are_a_command_of_their_own():
    row = requests(haa=Setpoint(stiffness=1e4))[0]
    assert (row['kinds'], row['stiffness'], row['position']) == (HAS_GAINS, 1e4, 0.0)
    assert math.isnan(row['damping'])


@pytest.mark.parametrize(('mode', 'in_force', 'is_refused'), [
    (None, FORCE, False), (None, IMPEDANCE, True), (None, POSITION, True),
    ('force', IMPEDANCE, False), ('impedance', FORCE, True)])
def test_an_effort_needs_a_position_where_the_mode_uses_it(mode, in_force, is_refused):
    """Else it becomes the measured one: the position stays where a later mode begins."""
    sample = row_record(np.zeros(1, SAMPLE))
    sample.device_mode, sample.position = in_force, 0.03
    rows = np.zeros(1, COMMAND)
    setpoints = {'haa': Setpoint(effort=-50.0, mode=mode)}
    if is_refused:
        with pytest.raises(SetpointError, match='haa: setpoint effort = -50 needs its position'):
            fill_requests(setpoints, ['haa'], rows, {'haa': sample})
        return
    fill_requests(setpoints, ['haa'], rows, {'haa': sample})
    assert rows[0][['position', 'velocity', 'effort']].item() == (0.03, 0.0, -50.0)
    assert rows['kinds'][0] & HAS_SETPOINT


@pytest.mark.parametrize(('setpoint', 'in_force', 'needed'), [
    (Setpoint(0.03), FORCE, 'effort in mode force'),
    (Setpoint(0.03, mode='force'), IMPEDANCE, 'effort in mode force'),
    (Setpoint(0.03, mode='spool'), IMPEDANCE, 'spool, or an effort, in mode spool'),
    (Setpoint(0.03, 0.0, 0.0, mode='force'), IMPEDANCE, ''), (Setpoint(mode='force'), FORCE, ''),
    (Setpoint(0.03, mode='spool', spool=1e-4), FORCE, ''), (Setpoint(0.03), IMPEDANCE, ''),
    (Setpoint(0.03, mode='position'), FORCE, ''), (Setpoint(0.03), POSITION, '')])
def test_a_position_alone_is_refused_where_the_mode_uses_the_effort(setpoint, in_force, needed):
    """Else a load that the effort bears falls: its effort would become 0."""
    sample = row_record(np.zeros(1, SAMPLE))
    sample.device_mode = in_force
    if needed:
        with pytest.raises(SetpointError, match=f'position = 0.03 needs its {needed}'):
            fill_requests({'haa': setpoint}, ['haa'], np.zeros(1, COMMAND), {'haa': sample})
    else:
        fill_requests({'haa': setpoint}, ['haa'], np.zeros(1, COMMAND), {'haa': sample})


def test_an_unknown_actuator_is_refused_naming_those_there_are():
    with pytest.raises(SetpointError, match="'hip' is not an actuator of the run; valid: haa"):
        requests(hip=Setpoint(0.0))


def test_of_two_controllers_the_later_wins_where_both_speak():
    rows = requests(haa=Setpoint(0.1), kfe=Setpoint(0.2))
    merge_requests(requests(kfe=Setpoint(0.3)), rows)
    assert rows['position'].tolist() == [0.1, 0.3]
    assert rows['kinds'].tolist() == [HAS_SETPOINT, HAS_SETPOINT]


def rows_of(setpoints: Setpoints) -> np.ndarray:
    """Return the rows of three actuators that setpoints of several fill."""
    rows = np.zeros(3, COMMAND)
    fill_requests(setpoints, ('haa', 'hfe', 'kfe'), rows)
    return rows


def test_setpoints_as_arrays_are_those_of_each_actuator():
    """Numbers are for all of them, a gain of None keeps the one in force, others get nothing."""
    found = rows_of(Setpoints(
        ('kfe', 'haa'), np.array([0.1, 0.2]), 0.3, [4.0, 5.0], damping=np.array([60.0, 70.0])))
    one_by_one = np.zeros(3, COMMAND)
    fill_requests({'kfe': Setpoint(0.1, 0.3, 4.0, damping=60.0),
                   'haa': Setpoint(0.2, 0.3, 5.0, damping=70.0)},
                  ('haa', 'hfe', 'kfe'), one_by_one)
    assert found['kinds'].tolist() == [HAS_SETPOINT, 0, HAS_SETPOINT]
    for row in (0, 2):
        assert found[row].tobytes() == one_by_one[row].tobytes()


@pytest.mark.parametrize(('values', 'message'), [
    ({'position': [0.1, math.nan]}, 'kfe: setpoint position = nan, must be finite'),
    ({'effort': [math.inf, 0.0]}, 'haa: setpoint effort = inf, must be finite'),
    ({'stiffness': [1e4, -1.0]}, 'kfe: setpoint stiffness = -1.0, must be >= 0'),
    ({'velocity': [1.0, 2.0, 3.0]},
     r'setpoint velocity = \[1.0, 2.0, 3.0\], must be a number or 2 numbers'),
    ({'position': 'far'}, "setpoint position = 'far', must be a number or 2 numbers"),
    ({'names': ('haa', 'knee')}, "'knee' is not an actuator of the run; valid: haa, hfe, kfe")])
def test_arrays_with_a_value_that_cannot_be_are_refused_by_actuator(values, message):
    with pytest.raises(SetpointError, match=message):
        rows_of(Setpoints(**{'names': ('haa', 'kfe'), 'position': 0.0} | values))
