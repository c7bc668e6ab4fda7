"""Groups, lines and requests of an emergency stop that cannot be."""

from dataclasses import replace
import math

import isa_ros
from isa_ros.config.runs.run_reading import run_of_text
from isa_ros.errors import ConfigError
import pytest
from tests.tick.stopped_group import run, tree


@pytest.mark.parametrize('value', [0.5, 2, math.nan, 'on', None])
def test_what_is_neither_open_nor_released_is_refused(value):
    simulation = run().simulation()
    with pytest.raises(ConfigError, match=rf'emergency_stop = {value!r}, must be True \(open\) '
                                          r'or False \(released\)$'):
        simulation.emergency_stop(value)


@pytest.mark.parametrize(('value', 'words'), [
    (0.5, '= 0.5, must be a whole number'), (2.0, '= 2, must be <= 1'),
    (math.nan, '= nan, must be finite'), (True, '= True, must be a number')])
def test_a_line_that_is_set_as_a_parameter_is_open_or_not(value, words):
    simulation = run().simulation()
    with pytest.raises(ConfigError, match=f'emergency_stop.pair.opened {words}'):
        simulation.surroundings.tune({'emergency_stop.pair.opened': value})
    assert simulation.surroundings.tuned_value('emergency_stop.pair.opened') == 0.0


def test_the_configuration_comes_back_from_its_text():
    own = run().configuration
    assert run_of_text(own.to_yaml()) == own
    plain = replace(own, emergency_stops=())
    assert 'emergency_stops' not in plain.to_yaml()
    assert [group.actuators for group in plain.stop_groups] == [('left', 'right', 'other')]


@pytest.mark.parametrize(('group', 'words'), [
    ({'actuators': []}, 'emergency_stops.pair.actuators is empty'),
    ({'actuators': ['left', 'rigth']}, "'rigth' is not an actuator; did you mean right"),
    ({'reactions': ['hold']}, "reactions: 'hold', must be of quick_stop, disable, block"),
    ({'dumps': 'later'}, 'must be one of at_rest, at_once, never')])
def test_a_group_that_cannot_be_is_refused(group, words):
    with pytest.raises(ConfigError, match=words):
        run(group)


def test_a_group_that_dumps_at_once_has_a_dump_valve():
    ideal = {'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.0}
    with pytest.raises(ConfigError, match=(
            'emergency_stops.pair.dumps = at_once is not used: no dump valve is in supply')):
        isa_ros.load({**tree({'dumps': 'at_once'}), 'supply': ideal})
    isa_ros.load({**tree({'dumps': 'at_rest'}), 'supply': ideal})
    isa_ros.load({**tree({'dumps': 'at_once'}), 'supply': {**ideal, 'dump': {
        'kind': 'lag', 'time_constant_ms': 1.0}}})


@pytest.mark.parametrize(('fault', 'words'), [
    ({'emergency_stop': 'par'}, "'par' is not a group; did you mean pair"),
    ({'emergency_stop': 'pair', 'set': {'opened': 1}}, 'set is not used'),
    ({'emergency_stop': 'pair', 'supply': 'supply'}, 'must have one of')])
def test_a_row_of_a_scenario_that_stops_no_group_is_refused(fault, words):
    with pytest.raises(ConfigError, match=words):
        isa_ros.load(tree(), {'name': 'bad', 'duration_s': 0.1, 'faults': [{'t_s': 0.0} | fault]})


def test_a_request_for_a_group_that_is_not_there_is_refused():
    with pytest.raises(ConfigError, match="'legs' is not a group; valid: pair"):
        run().simulation().emergency_stop(group='legs')


def test_no_supply_has_the_name_of_the_lines():
    named = tree()
    named['supplies'] = {'emergency_stop': named.pop('supply') | {  # type: ignore[operator]
        'feeds': ['left', 'right', 'other']}}
    with pytest.raises(ConfigError, match='the name is taken by the lines of emergency stops'):
        isa_ros.load(named)
