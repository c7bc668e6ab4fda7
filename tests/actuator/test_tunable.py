"""Tunable parameters: every gain and limit of the blocks that are on, once, in SI."""

from dataclasses import replace
import math

from isa_ros.actuator.sheet import actuator_record, ActuatorSheet
from isa_ros.actuator.tunable import tunables, with_changed
from isa_ros.config.models.catalogue import actuator_model, model_names
from isa_ros.errors import ConfigError, ParameterError
from isa_ros.reu.schedule import ThreePoints
from isa_ros.reu.wiring import active
import pytest
from tests.sheets import actuator_sheet

NOT_SI = ('kPa', 'MPa', 'mA', 'mm', 'bar', 'measured', 'output', '|')
EVERY = [(name, variant) for name in model_names()
         for variant in ('', *actuator_model(name, 'test').variants)]


def sheet_of(model: str, variant: str) -> ActuatorSheet:
    return actuator_sheet(model, 'default', *([variant] if variant else []))


@pytest.mark.parametrize(('model', 'variant'), EVERY)
def test_every_tunable_is_si_within_its_range_and_has_a_meaning(model, variant):
    sheet = sheet_of(model, variant)
    for name, tunable in tunables(sheet).items():
        assert name == tunable.name and name.partition('.')[0] in active(sheet.reu)
        assert not any(word in tunable.unit for word in NOT_SI), (name, tunable.unit)
        assert tunable.doc and {'ge', 'gt'} & set(tunable.bounds)
        assert {'le', 'lt'} & set(tunable.bounds)  # a ROS range has two ends
    assert with_changed(sheet, {name: t.value for name, t in tunables(sheet).items()}) is sheet


@pytest.mark.parametrize(('model', 'variant'), EVERY)
def test_every_tunable_changes_a_constant_of_the_loops_and_nothing_of_the_plant(model, variant):
    """The gains of the impedance are excepted, since they are part of the setpoint."""
    sheet = sheet_of(model, variant)
    before = actuator_record(sheet, 6)
    for name, tunable in tunables(sheet).items():
        value = 0.9 * tunable.value or 0.5 * min(1.0, tunable.bounds['le'])
        if name.endswith('.limit'):
            value = 0.5 * tunable.value
        after = actuator_record(with_changed(sheet, {name: value}), 6)
        assert after['plant'].tobytes() == before['plant'].tobytes()
        is_gain = name in ('position.stiffness', 'position.damping')
        assert (after['reu'].tobytes() == before['reu'].tobytes()) == is_gain, name


def test_rates_filters_and_kinds_are_not_tunable():
    """They define the structure of the loops."""
    names = tunables(actuator_sheet('isa_v5', 'default', 'explicit'))
    assert {'position.stiffness', 'force.kp', 'spool.kp', 'current.kp'} <= set(names)
    assert not [name for name in names if 'rate' in name or 'filter' in name or 'kind' in name]


@pytest.mark.parametrize(('model', 'variant', 'name', 'unit'), [
    ('isa_v5', '', 'force.kp', 'm/N'), ('smart_manifold', '', 'force.ki', 'A/(Nm s)'),
    ('isa_v5', 'pressure_control', 'pressure.kp', 'm/Pa'),
    ('isa_v5', 'position_control', 'position.kp', 'm/m'),
    ('isa_v5', 'explicit', 'spool.kd', 'A s/m'), ('isa_v5', 'explicit', 'current.kp', 'V/A'),
    ('smart_manifold', '', 'force.kv', 'A per rad/s'),
    ('smart_manifold', '', 'force.compensation.knee', 'A'),
    ('isa_v5', '', 'position.stiffness', 'N/m')])
def test_the_unit_is_that_of_the_blocks_that_are_on(model, variant, name, unit):
    """Output per measured; the reference of the next block inwards is the output."""
    assert tunables(sheet_of(model, variant))[name].unit == unit


@pytest.mark.parametrize(('variant', 'name', 'field', 'per_unit'), [
    ('explicit', 'current.kp', 'kp_v_per_ma', 1e3),
    ('explicit', 'current.limit', 'limit_v', 1.0),
    ('feedback_linearisation', 'force.least_drop', 'least_drop_kpa', 1e3),
    ('feedback_linearisation', 'force.supply_pressure', 'supply_pressure_mpa', 1e6)])
def test_a_sheet_in_other_units_is_tuned_in_si(variant, name, field, per_unit):
    sheet = sheet_of('isa_v5', variant)
    tunable = tunables(sheet)[name]
    block = name.partition('.')[0]
    assert tunable.value == pytest.approx(getattr(getattr(sheet.reu, block), field) * per_unit)
    changed = with_changed(sheet, {name: 0.5 * tunable.value})
    assert tunables(changed)[name].value == pytest.approx(0.5 * tunable.value)


def test_the_factors_of_a_schedule_are_tunable_where_there_is_one():
    sheet = actuator_sheet('isa_v5')
    three = ThreePoints(retracted=0.5, middle=1.0, extended=0.7)
    force = replace(sheet.reu.force, gain_schedule=three)
    scheduled = replace(sheet, reu=replace(sheet.reu, force=force))
    assert tunables(scheduled)['force.gain_schedule.extended'].value == 0.7
    changed = with_changed(scheduled, {'force.gain_schedule.extended': 0.6, 'force.kp': 1e-7})
    assert changed.reu.force.gain_schedule.extended == 0.6
    assert changed.reu.force.kp == 1e-7
    assert 'force.gain_schedule.extended' not in tunables(sheet)


@pytest.mark.parametrize(('name', 'value', 'error', 'message'), [
    ('force.kp', -1e-9, ParameterError, r'force.kp = -1e-09 m/N, must be >= 0 m/N \(prop'),
    ('force.kp', math.nan, ParameterError, 'force.kp = nan m/N, must be finite'),
    ('force.kp', True, ParameterError, 'force.kp = True, must be a number in m/N'),
    ('force.limit', 2e-4, ParameterError, r'^force.limit = 0.0002 m, must be <= 0.000178178 m \('),
    ('force.knee', 1.0, ConfigError, 'force.knee is unknown; did you mean'),
    ('spool.kp', 1.0, ConfigError, 'spool.kp is unknown'),
    ('force.rate_hz', 1e3, ConfigError, 'force.rate_hz is unknown')])
def test_what_cannot_be_is_refused_in_one_line(name, value, error, message):
    """The message has name, value, unit and bound."""
    with pytest.raises(error, match=message) as raised:
        with_changed(actuator_sheet('isa_v5'), {name: value})
    assert '\n' not in str(raised.value)
