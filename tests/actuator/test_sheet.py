"""Wiring of plant and control blocks: combinations that do not fit are refused."""

from dataclasses import replace

from isa_ros.actuator.sheet import actuator_record, ActuatorSheet, refuse_wiring
from isa_ros.config.models.catalogue import actuator_model
from isa_ros.errors import ConfigError
from isa_ros.reu.wiring import Held, Off
import pytest
from tests.actuator.hosed_cylinder import CHECK, COUNTERBALANCE, HOSES
from tests.sheets import actuator_sheet, MODELS

SHIPPED = [(model, preset, variant) for model in MODELS
           for preset in actuator_model(model, 'test').presets
           for variant in (None, *actuator_model(model, 'test').variants)]


@pytest.mark.parametrize(('model', 'preset', 'variant'), SHIPPED)
def test_every_shipped_preset_and_variant_fits(model, preset, variant):
    """All sheets that ship can be run."""
    sheet = actuator_sheet(model, preset, *([variant] if variant else []))
    refuse_wiring(sheet)
    assert len(actuator_record(sheet, 0)) == 1


def changed(sheet: ActuatorSheet, part: str, name: str, value: object) -> ActuatorSheet:
    """Return a sheet with one whole section of plant or REU replaced."""
    return replace(sheet, **{part: replace(getattr(sheet, part), **{name: value})})


def test_a_spool_block_needs_a_spool_sensor():
    """Section 2.6: the mechanical feedback has none."""
    sheet = changed(actuator_sheet('smart_manifold'), 'reu', 'spool', Held(rate_hz=5000.0))
    with pytest.raises(ConfigError, match='reu.spool.kind = held: .* mechanical feedback'):
        refuse_wiring(sheet)


def test_a_leakage_is_not_stated_beyond_the_current_at_the_stop():
    """Of 10 mA; what scaling rounds is within."""
    sheet = actuator_sheet('cylinder')
    for last in (80.0, 10.1):
        leakage = replace(sheet.plant.valve.leakage, current_ma=(0.0, 0.5, last))
        valve = replace(sheet.plant.valve, leakage=leakage)
        with pytest.raises(ConfigError, match=(
                fr'plant.valve.leakage.current_ma\[2\] = {last:g} mA, must be <= 10 mA')):
            refuse_wiring(changed(sheet, 'plant', 'valve', valve))
    leakage = replace(sheet.plant.valve.leakage, current_ma=(0.0, 0.5, 10.0 + 1e-12))
    refuse_wiring(changed(sheet, 'plant', 'valve', replace(sheet.plant.valve, leakage=leakage)))


def test_the_spool_s_loop_is_closed_exactly_once():
    """Equation 8 is never put inside another spool loop; without it a spool loop is needed."""
    plain, explicit = actuator_sheet('isa_v5'), actuator_sheet('isa_v5', 'default', 'explicit')
    with pytest.raises(ConfigError, match='already is the closed loop'):
        refuse_wiring(changed(explicit, 'plant', 'spool', plain.plant.spool))
    for reu_spool in (plain.reu.spool, Off()):
        sheet = changed(plain, 'reu', 'spool', reu_spool)
        with pytest.raises(ConfigError, match='the spool loop is open'):
            refuse_wiring(changed(sheet, 'plant', 'spool', explicit.plant.spool))


@pytest.mark.parametrize(('model', 'variant', 'name', 'limit', 'message'), [
    ('isa_v5', (), 'force', 1.79e-4, 'limit = 0.000179 m, must be <= 0.000178 m'),
    ('smart_manifold', (), 'force', 5.1e-3, r'0.0051 A, must be <= 0.005 A.* series current'),
    ('isa_v5', ('position_control',), 'position', 5e-3, 'reu.position.limit = 0.005 m'),
    ('isa_v5', ('feedback_linearisation',), 'force', 5e-3, 'reu.force.limit = 0.005 m'),
])
def test_a_limit_beyond_the_spool_s_stop_is_refused(model, variant, name, limit, message):
    """Beyond the stop the block does not detect saturation, and its integral winds up."""
    sheet = actuator_sheet(model, 'default', *variant)
    block = replace(getattr(sheet.reu, name), limit=limit)
    with pytest.raises(ConfigError, match=message):
        refuse_wiring(changed(sheet, 'reu', name, block))


def test_the_current_s_loop_is_closed_exactly_once():
    """Equation 10 is never combined with the explicit coil."""
    plain, explicit = actuator_sheet('isa_v5'), actuator_sheet('isa_v5', 'default', 'explicit')
    for sheet in (changed(plain, 'plant', 'coil', explicit.plant.coil),
                  changed(explicit, 'plant', 'coil', plain.plant.coil)):
        with pytest.raises(ConfigError, match='lead_lag needs an explicit coil'):
            refuse_wiring(sheet)


@pytest.mark.parametrize('held', [
    {}, {'holding_a': COUNTERBALANCE}, {'holding_b': CHECK},
    {'holding_a': CHECK, 'holding_b': COUNTERBALANCE}], ids=['none', 'a', 'b', 'both'])
def test_a_stop_on_load_holding_valves_has_no_position_loop(held):
    """R16: K and K_i are 0 with one of them, and only then."""
    sheet = actuator_sheet('cylinder')
    flow = actuator_record(replace(sheet, plant=replace(sheet.plant, hoses=HOSES, **held)), 0)[
        'reu']['rules']['flow'][0]
    assert [bool(flow['hold']), bool(flow['integral'])] == [not held] * 2
    assert flow['damping'] > 0.0
