"""Setpoints beyond the stroke, the rated force or the usable gains: refused, or limited."""

from isa_ros.actuator.setpoint_range import SetpointRange
from isa_ros.core.signals import HAS_ENABLE
from isa_ros.errors import SetpointError
import pytest
from tests.sheets import actuator_sheet, MODELS, setpoint

BEYOND = [
    ({'position': 50.0}, 'knee: setpoint position = 50 m, must be 0 to 0.1 m, the stroke; '),
    ({'position': -1e-6}, 'knee: setpoint position = -1e-06 m, must be 0 to 0.1 m, the stroke; '),
    ({'position': 0.05, 'effort': 7501.0},
     'knee: setpoint effort = 7501 N, must be -5174 to 7500 N, the rated force; '),
    ({'position': 0.05, 'stiffness': 1e12},
     'knee: setpoint stiffness = 1e+12 N/m, must be 0 to 1e+07 N/m, the usable gains; ')]


@pytest.mark.parametrize(('values', 'message'), BEYOND)
def test_it_is_refused_with_value_bound_and_the_key(values, message):
    own = SetpointRange('knee', actuator_sheet('isa_v5'))
    with pytest.raises(SetpointError) as error:
        own.admit(setpoint(**values))
    assert str(error.value).startswith(message)
    assert 'beyond_range: limit' in str(error.value)


def test_it_is_limited_where_configured_and_every_field_is_named():
    own = SetpointRange('knee', actuator_sheet('isa_v5'), 'limit')
    command = setpoint(position=50.0, effort=-6000.0, damping=10.0)
    assert own.admit(command) == (
        'knee: setpoint position = 50 m, limited to 0.1 m, the stroke; '
        'knee: setpoint effort = -6000 N, limited to -5174 N, the rated force')
    assert command[['position', 'effort', 'damping']].item() == (0.1, -5174.0, 10.0)


@pytest.mark.parametrize('model', MODELS)
@pytest.mark.parametrize('end', [0.0, 1.0])
def test_the_ends_of_the_stroke_are_within_and_unchanged(model, end):
    sheet = actuator_sheet(model)
    command = setpoint(position=end * sheet.plant.drive.stroke)
    before = command.copy()
    assert SetpointRange(model, sheet).admit(command) == ''
    assert command.tobytes() == before.tobytes()


def test_a_position_that_no_block_uses_has_no_range():
    """With the valve amplifier the effort is a current."""
    own = SetpointRange('valve', actuator_sheet('isa_v5', 'default', 'valve_amplifier'))
    assert own.admit(setpoint(position=50.0, effort=0.005)) == ''


def test_enabling_alone_is_no_setpoint():
    command = setpoint(position=50.0)
    command['kinds'] = HAS_ENABLE
    assert SetpointRange('knee', actuator_sheet('isa_v5')).admit(command) == ''
