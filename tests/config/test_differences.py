"""Two configurations: every differing key with both values and the unit, in their order."""

from dataclasses import replace

import isa_ros
from isa_ros.config.differences import (
    configuration_differences, DifferingKey, section_differences)
from isa_ros.config.runs.run_config import RunConfig
from isa_ros.config.text.yaml_text import dump, parse, Tree
import pytest
from tests.runs import hip_and_knee


def section(run: RunConfig) -> Tree:
    """Return the resolved section of a run, as it is read from a bag."""
    return parse(run.to_yaml(), 'text')


def differences(expected: RunConfig, actual: RunConfig) -> list[DifferingKey]:
    return configuration_differences(section(expected), section(actual))


def test_equal_configurations_have_no_differences() -> None:
    assert differences(hip_and_knee(), hip_and_knee()) == []


@pytest.mark.parametrize(('key', 'values', 'unit'), [
    ('actuators.kfe.parameters.plant.friction.stiction', (110.0, 150.0), 'N'),
    ('actuators.haa.parameters.plant.friction.stiction', (1.5, 2.0), 'Nm'),
    ('actuators.kfe.parameters.plant.oil.aeration_pressure_kpa', (6.0, 7.0), 'kPa'),
    ('actuators.kfe.parameters.reu.force.kp', (8e-8, 9e-8), 'm/N'),
    ('actuators.haa.parameters.reu.force.kp', (2e-5, 3e-5), 'A/Nm'),
    ('actuators.haa.parameters.reu.force.kv', (0.0, 1e-3), 'A per rad/s'),
    ('actuators.kfe.parameters.reu.position.stiffness', (1e5, 2e5), 'N/m'),
    ('tick_timeout_s', (5.0, 6.0), 's')])
def test_a_key_has_both_values_and_its_unit(
        key: str, values: tuple[float, float], unit: str) -> None:
    """Under the key of the run file, in the unit of a linear or a rotary actuator."""
    leg = isa_ros.load('leg')
    runs = [leg.replace({key: value}).configuration for value in values]
    assert differences(*runs) == [DifferingKey(key, *values, unit)]


def test_start_load_supply_and_body_have_units() -> None:
    """Sections that a run file has in another form have the keys of the resolved text."""
    leg = isa_ros.load('leg')
    one, other = (leg.replace({'leg.start.foot_height_mm': height, 'supply.pressure_mpa': mpa})
                  for height, mpa in ((50.0, 16.0), (40.0, 18.0)))
    found = differences(one.configuration, other.configuration)
    # with the supply the ratings of the actuators change, which scale with it
    assert [key for key in found if '.parameters.' not in key.key] == [
        DifferingKey('supplies.supply.pressure_mpa', 16.0, 18.0, 'MPa'),
        DifferingKey('body.start.foot_height_mm', 50.0, 40.0, 'mm')]
    one, other = (isa_ros.load('rig_rotary').replace({
        'actuators.rotor.initial_position_deg': deg,
        'actuators.rotor.load': {'kind': 'mass', 'inertia': inertia}})
        for deg, inertia in ((90.0, 0.5), (80.0, 0.6)))
    found = differences(one.configuration, other.configuration)
    assert [(key.key, key.unit) for key in found] == [
        ('actuators.rotor.initial_position', 'rad'), ('actuators.rotor.load.inertia', 'kg m2')]


def test_another_kind_is_named_with_the_keys_that_only_one_has() -> None:
    one, other = (isa_ros.load('rig_linear').replace({
        'actuators.ram.load': load}) for load in ({'kind': 'blocked'},
                                                  {'kind': 'mass', 'inertia': 20.0}))
    found = {key.key: key for key in differences(one.configuration, other.configuration)}
    assert found['actuators.ram.load.kind'][1:3] == ('blocked', 'mass')
    assert found['actuators.ram.load.inertia'][2:] == (20.0, 'kg')
    assert found['actuators.ram.load.displacement'] == DifferingKey(
        'actuators.ram.load.displacement', 0.0, None, 'm')
    assert 'actuators.ram.load.force' not in found


def test_a_section_that_only_one_has_is_one_line() -> None:
    run = hip_and_knee()
    without = section(run)
    del without['actuators']['knee']  # type: ignore[union-attr, arg-type, call-overload]
    found, = configuration_differences(section(run), without)
    assert (found.key, found.actual) == ('actuators.knee', None)
    assert found.cells[1].startswith('{model: isa_v5, preset: ') and len(found.cells[1]) < 50
    assert found.cells[2:] == ('absent', '')


def test_older_forms_of_a_section_are_no_difference() -> None:
    """``supply`` at the top is the supply of all actuators."""
    older = section(hip_and_knee())
    supply = dict(older.pop('supplies')['supply'])  # type: ignore
    del supply['feeds']
    assert configuration_differences(
        parse(dump(older | {'supply': supply}), 'text'), section(hip_and_knee())) == []


def test_a_text_of_another_version_is_compared_without_units() -> None:
    run = hip_and_knee()
    found = configuration_differences(
        section(run) | {'magic': 1}, section(replace(run, tick_timeout_s=6.0)) | {'magic': 2})
    assert found == [DifferingKey('tick_timeout_s', 5.0, 6.0, ''), DifferingKey('magic', 1, 2)]


@pytest.mark.parametrize(('expected', 'actual', 'found'), [
    ({'a': {'b': 1.0}}, {'a': {'b': 1}}, []),
    ({'a': ['x']}, {'a': ['x', 'y']}, [('a', ['x'], ['x', 'y'])]),
    ({'a': [{'t': 0}, {'t': 1}]}, {'a': [{'t': 0}, {'t': 2}]}, [('a[1].t', 1, 2)]),
    ({'a': [{'t': 0}]}, {'a': [{'t': 0}, {'t': 2}]}, [('a[1]', None, {'t': 2})]),
    ({'a': 1, 'b': 2}, {'b': 3, 'c': 4}, [('a', 1, None), ('b', 2, 3), ('c', None, 4)])])
def test_sections_differ_by_dotted_key(
        expected: Tree, actual: Tree, found: list[tuple[str, object, object]]) -> None:
    """Entries of a list of sections are compared one by one, other lists as a whole."""
    assert section_differences(expected, actual) == [DifferingKey(*key) for key in found]


def test_values_are_shown_with_every_digit() -> None:
    assert DifferingKey('a', 0.1 + 0.2, {'t_s': 0.5, 'enabled': True}, 's').cells == (
        'a', '0.30000000000000004', '{t_s: 0.5, enabled: True}', 's')
