"""What is wanted of the quadruped over time."""

from isa_ros.config.text.sections import Place
from isa_ros.errors import ConfigError
from isa_ros.examples.quadruped.parameters import gains_of, program_of
import pytest

PLACE = Place('trot.yaml', 'controllers.trot.program')
POINTS = [{'t_s': 0.0, 'height': 0.56}, {'t_s': 1.0, 'steps': 1, 'turn_rate': 0.2},
          {'t_s': 2.0, 'speed': 0.5, 'side_speed': -0.1}, {'t_s': 3.0, 'steps': 0, 'height': 0.5}]


@pytest.mark.parametrize('t, values, steps', [
    (0.0, [0.56, 0.0, 0.0, 0.0], False), (0.5, [0.56, 0.0, 0.0, 0.1], False),
    (1.0, [0.56, 0.0, 0.0, 0.2], True), (1.5, [0.56, 0.25, -0.05, 0.2], True),
    (2.5, [0.53, 0.5, -0.1, 0.2], True), (3.0, [0.5, 0.5, -0.1, 0.2], False),
    (99.0, [0.5, 0.5, -0.1, 0.2], False)])
def test_values_change_evenly_between_points_and_stepping_at_them(t, values, steps):
    """What a point leaves out is as before."""
    wanted, is_stepping = program_of(POINTS, PLACE).wanted(t)
    assert wanted == pytest.approx(values, abs=1e-12)
    assert is_stepping is steps


def test_a_program_may_be_asked_for_an_earlier_time():
    program = program_of(POINTS, PLACE)
    program.wanted(99.0)
    wanted, steps = program.wanted(0.25)
    assert wanted == pytest.approx([0.56, 0.0, 0.0, 0.05], abs=1e-12) and not steps


@pytest.mark.parametrize('points, message', [
    (None, 'program = None, must be a list of points'), ([], 'must be a list of points'),
    ([{'t_s': 1.0, 'height': 0.5}], 'program[0].t_s = 1 s, must be 0 s'),
    ([{'t_s': 0.0, 'height': 0.5}, {'t_s': 0.0}],
     'program[1].t_s = 0 s, must be > 0 s, that of the point before'),
    ([{'t_s': 0.0}], 'program[0] lacks height'),
    ([{'t_s': 0.0, 'height': 0.5, 'speeed': 1}], 'program[0].speeed is unknown'),
    ([{'t_s': 0.0, 'height': 5.0}], 'program[0].height = 5'), ([3], 'program[0] = 3')])
def test_refused_programs(points, message):
    with pytest.raises(ConfigError) as refused:
        program_of(points, PLACE)
    assert str(refused.value).startswith('trot.yaml: controllers.trot.program')
    assert message in str(refused.value)


def test_gains_are_checked_with_their_units():
    with pytest.raises(ConfigError, match=r'frequency = 9 Hz, must be <= 4 Hz'):
        gains_of({'frequency': 9.0}, Place('trot.yaml', 'controllers.trot'))
