"""Setpoints beyond the stroke, the rated force or the usable gains: refused, or limited."""

import math

from isa_ros.actuator.setpoint_range import load_positions, SetpointRange
from isa_ros.core.device import CURRENT, FORCE, IMPEDANCE, POSITION, PRESSURE, SPOOL
from isa_ros.core.signals import HAS_ENABLE, HAS_MODE, HAS_REFERENCE
from isa_ros.errors import SetpointError
import numpy as np
import pytest
from tests.sheets import actuator_sheet, MODELS, setpoint

BEYOND = [
    ({'position': 50.0}, 'knee: setpoint position = 50 m, must be 0 to 0.1 m, the stroke; '),
    ({'position': -1e-6}, 'knee: setpoint position = -1e-06 m, must be 0 to 0.1 m, the stroke; '),
    ({'position': 0.05, 'velocity': 1e6},
     'knee: setpoint velocity = 1e+06 m/s, must be -1.66859 to 1.66859 m/s, the '),
    ({'position': 0.05, 'effort': 7501.0},
     'knee: setpoint effort = 7501 N, must be -5174 to 7500 N, the rated force; '),
    ({'position': 0.05, 'stiffness': 1e12},
     'knee: setpoint stiffness = 1e+12 N/m, must be 0 to 5e+07 N/m, the usable gains; ')]


@pytest.mark.parametrize(('values', 'message'), BEYOND)
def test_it_is_refused_with_value_bound_and_the_key(values, message):
    own = SetpointRange('knee', actuator_sheet('isa_v5'))
    with pytest.raises(SetpointError) as error:
        own.admit(setpoint(**values), IMPEDANCE)
    assert str(error.value).startswith(message)
    assert 'beyond_range: limit' in str(error.value)


def test_it_is_limited_where_configured_and_every_field_is_named():
    own = SetpointRange('knee', actuator_sheet('isa_v5'), 'limit')
    command = setpoint(position=50.0, effort=-6000.0, damping=10.0)
    assert own.admit(command, IMPEDANCE) == (
        'knee: setpoint position = 50 m, limited to 0.1 m, the stroke; '
        'knee: setpoint effort = -6000 N, limited to -5174 N, the rated force')
    assert command[['position', 'effort', 'damping']].item() == (0.1, -5174.0, 10.0)


@pytest.mark.parametrize('model', MODELS)
@pytest.mark.parametrize('end', [0.0, 1.0])
def test_the_ends_of_the_stroke_are_within_and_unchanged(model, end):
    sheet = actuator_sheet(model)
    command = setpoint(position=end * sheet.plant.drive.stroke)
    before = command.copy()
    assert SetpointRange(model, sheet).admit(command, IMPEDANCE) == ''
    assert command.tobytes() == before.tobytes()


def test_a_position_that_no_block_uses_has_no_range():
    """With the valve amplifier the effort is a current."""
    own = SetpointRange('valve', actuator_sheet('isa_v5', 'default', 'valve_amplifier'))
    assert own.admit(setpoint(position=50.0, effort=0.005), CURRENT) == ''


NAN = math.nan


@pytest.mark.parametrize(('values', 'mode', 'missing'), [
    ({'position': NAN, 'effort': 9.0}, IMPEDANCE, 'position'),
    ({'position': NAN}, POSITION, 'position'), ({'position': NAN, 'effort': NAN}, FORCE, 'effort'),
    ({'position': 0.05, 'velocity': NAN}, IMPEDANCE, 'velocity'),
    ({'position': 0.05, 'velocity': NAN}, POSITION, 'velocity'),
    ({'position': 0.05, 'effort': NAN}, IMPEDANCE, 'effort'),
    ({'position': NAN, 'effort': NAN}, CURRENT, 'effort'), ({'position': NAN}, None, 'position')])
def test_a_number_that_the_mode_uses_must_be_given(values, mode, missing):
    own = SetpointRange('knee', actuator_sheet('isa_v5'))
    with pytest.raises(SetpointError, match=f'^knee: setpoint {missing} is missing or NaN, must '):
        own.admit(setpoint(**values), mode)


@pytest.mark.parametrize(('values', 'mode'), [
    ({'position': NAN, 'velocity': NAN, 'effort': 9.0}, FORCE),
    ({'position': 0.05, 'effort': NAN}, POSITION)])
def test_a_number_that_the_mode_does_not_use_may_be_missing(values, mode):
    assert SetpointRange('knee', actuator_sheet('isa_v5')).admit(setpoint(**values), mode) == ''


def test_enabling_alone_is_no_setpoint():
    command = setpoint(position=50.0)
    command['kinds'] = HAS_ENABLE
    assert SetpointRange('knee', actuator_sheet('isa_v5')).admit(command, IMPEDANCE) == ''


def reference(mode, value, kinds=HAS_REFERENCE):
    """Return a command with a reference of a mode."""
    command = setpoint(mode=mode, reference=value)
    command['kinds'] = kinds
    return command


@pytest.mark.parametrize(('mode', 'value', 'message'), [
    (SPOOL, 1e-3, 'knee: setpoint spool = 0.001 m, must be -0.000'),
    (CURRENT, 0.1, 'knee: setpoint current = 0.1 A, must be -0.0'),
    (PRESSURE, -1e9, 'knee: setpoint pressure = -1e')])
def test_a_reference_beyond_valve_or_sensor_is_refused(mode, value, message):
    own = SetpointRange('knee', actuator_sheet('isa_v5', 'default', 'pressure_control'))
    with pytest.raises(SetpointError) as error:
        own.admit(reference(mode, value), mode)
    assert str(error.value).startswith(message)


def test_a_reference_of_another_mode_is_refused_with_the_mode_in_force():
    own = SetpointRange('knee', actuator_sheet('isa_v5'))
    with pytest.raises(SetpointError, match='setpoint spool is not of the mode in force, force'):
        own.admit(reference(SPOOL, 1e-5), 4)
    assert own.admit(reference(SPOOL, 1e-5, HAS_MODE | HAS_REFERENCE), 4) == ''


def test_a_mode_that_the_wiring_does_not_have_is_refused_with_the_reason():
    own = SetpointRange('hip', actuator_sheet('smart_manifold'))
    with pytest.raises(SetpointError) as error:
        own.admit(reference(SPOOL, 0.0, HAS_MODE), IMPEDANCE)
    assert str(error.value) == (
        'hip: mode = spool: reu.spool.kind = off; possible: current, force, impedance')


def test_rows_are_limited_at_once_as_one_by_one():
    """Setpoints with their gains, and the reference of a mode; a gain of NaN stays in force."""
    own = SetpointRange('knee', actuator_sheet('isa_v5'), 'limit')
    for given in ([setpoint(position=50.0, effort=-1e5), setpoint(position=0.03, damping=1e12),
                   setpoint(position=-1.0, stiffness=1e4)],
                  [reference(SPOOL, 1e-3), reference(SPOOL, 1e-5), reference(SPOOL, -1e-3)]):
        rows = np.array(given)
        expected = rows.copy()
        for row in expected:
            own.admit(row)
        assert rows.tobytes() != expected.tobytes()
        own.limit(rows)
        assert rows.tobytes() == expected.tobytes()


def test_a_load_may_be_half_a_stroke_beyond_the_ends_and_that_of_a_motor_anywhere():
    assert load_positions(actuator_sheet('isa_v5'))[:3] == (-0.05, pytest.approx(0.15), 'm')
    assert load_positions(actuator_sheet('hydraulic_motor'))[:3] == (-math.inf, math.inf, 'rad')
