"""Other values by dotted key, from texts KEY=VALUE."""

from isa_ros.config.text.changes import assigned, changed, changes_of, replaced, values_of
from isa_ros.errors import ConfigError
import pytest


@pytest.mark.parametrize(('text', 'key', 'value'), [
    ('reu.force.kp=3e-7', 'reu.force.kp', 3e-7), ('step_ms=1', 'step_ms', 1),
    ('preset=table_4', 'preset', 'table_4'), ('a.kind=off', 'a.kind', 'off'),
    ('reu.pressure={kind: off}', 'reu.pressure', {'kind': 'off'}),
    ('variants=[explicit]', 'variants', ['explicit']), ('name=a=b', 'name', 'a=b')])
def test_a_value_is_read_as_in_a_file(text, key, value):
    assert assigned(text, '--set') == (key, value)
    assert type(assigned(text, '--set')[1]) is type(value)


@pytest.mark.parametrize(('text', 'message'), [
    ('reu.force.kp', "--set 'reu.force.kp', must be KEY=VALUE"), ('=3', "--set '=3', must be"),
    ('a=1\nb: 2', 'must have one value'), ('a={b', '--set a={b: line '),
    ('a=!x 1', 'tags')])
def test_what_is_no_key_and_value_is_refused(text, message):
    with pytest.raises(ConfigError) as caught:
        assigned(text, '--set')
    assert message in str(caught.value)


def test_the_last_value_of_a_key_counts_and_is_set_last():
    """A section set between two values of one of its keys does not win over the second."""
    values = values_of(['a.b=1', 'a={b: 2}', 'a.b=3'], '--set')
    assert list(values.items()) == [('a', {'b': 2}), ('a.b', 3)]
    assert changed({}, values, 'x.yaml') == {'a': {'b': 3}}


def test_keys_of_the_scenario_are_apart():
    found = changes_of(['supply.pressure_mpa=14', 'scenario.tracks.kfe[1].position=0.06'])
    assert found.run == {'supply.pressure_mpa': 14}
    assert found.scenario == {'tracks.kfe[1].position': 0.06}


@pytest.mark.parametrize('key', ['faults[0].set.plant.spool.stuck', 'faults[0].set.load.force'])
def test_a_key_with_dots_that_a_section_has_is_found(key):
    """The longest one that is there: it is replaced, not set beside in sections."""
    tree = {'faults': [{'set': {'plant.spool.stuck': 1, 'load': {'force': 2}, 'plant': {}}}]}
    own = replaced(tree, key, 9, 'x.yaml')['faults'][0]['set']
    assert own == {'plant.spool.stuck': 9, 'load': {'force': 2}, 'plant': {}} if (
        'spool' in key) else {'plant.spool.stuck': 1, 'load': {'force': 9}, 'plant': {}}
    assert tree['faults'][0]['set']['plant.spool.stuck'] == 1


@pytest.mark.parametrize('kind', ['none', 'off', 'held', 'rigid'])
def test_a_kind_without_values_leaves_none_of_the_other_kind(kind):
    tree = {'hoses': {'kind': 'lumped', 'length_m': 3.0}, 'lag': 4.0}
    assert replaced(tree, 'hoses.kind', kind, 'x.yaml') == {'hoses': {'kind': kind}, 'lag': 4.0}
    assert replaced(tree, 'hoses.kind', 'other', 'x.yaml')['hoses'] == {
        'kind': 'other', 'length_m': 3.0}
    assert replaced(tree, 'hoses.type', kind, 'x.yaml')['hoses']['length_m'] == 3.0
    assert changed(tree, {'hoses.kind': kind, 'hoses.length_m': 5.0}, 'x.yaml')['hoses'] == {
        'kind': kind, 'length_m': 5.0}


def test_of_two_keys_with_dots_the_longer_one_is_meant():
    tree = {'a.b': {'c': 1}, 'a.b.c': 2, 'a': {'b': {'c': 3}}}
    assert replaced(tree, 'a.b.c', 9, 'x.yaml') == {
        'a.b': {'c': 1}, 'a.b.c': 9, 'a': {'b': {'c': 3}}}
    assert replaced(tree, 'a.b.d', 9, 'x.yaml')['a.b'] == {'c': 1, 'd': 9}
