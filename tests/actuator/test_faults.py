"""Faults of an actuator as changed values: in force from a tick on, and as if in the sheet."""

from isa_ros.actuator.sheet import actuator_record
from isa_ros.actuator.tunable import changing, named, PROTECTION, tunables
from isa_ros.core.changeable import changeables
from isa_ros.errors import ConfigError
from isa_ros.loads.sheets import Mass
import pytest
from tests.actuator.efforts import run
from tests.actuator.energy import account, CLOSES, IMPACTS, remainder
from tests.sheets import actuator_sheet, MODELS, override, setpoint, smart_actuator, TICK

VALUES = {
    'plant.spool.stuck': 1.0, 'plant.spool.null_bias.current_ma': 0.4,
    'plant.valve.hysteresis_percent': 3.0, 'plant.valve.threshold_percent': 0.0,
    'plant.valve.null_leakage_lpm': 0.5, 'plant.coil.open_coils': 1.0,
    'plant.coil.shorted_turns': 0.5, 'plant.coil.supply_voltage': 2.0,
    'plant.oil.cross_port_leakage': 2e-12, 'plant.oil.external_leakage_a': 1e-12,
    'plant.oil.external_leakage_b': 1e-12, 'plant.oil.entrained_air': 0.02,
    'plant.relief.opening_pressure_mpa': 3.0, 'plant.friction.stiction': 120.0,
    'plant.friction.coulomb': 90.0, 'reu.frozen': 1.0, 'reu.device.emergency_stop': 1.0}
FAULTS = [{'plant.spool.stuck': 1.0}, {'plant.coil.shorted_turns': 0.5, 'reu.frozen': 1.0},
          {'plant.oil.entrained_air': 0.05, 'force.kp': 1.2e-7}]


def test_every_value_that_may_change_is_among_those_tested():
    """A new one is added to `VALUES`."""
    sheet = actuator_sheet('isa_v5')
    found = [name for name in changing(sheet) if name not in tunables(sheet)
             and not name.startswith(('plant.sensors.', 'link.', PROTECTION))]
    assert sorted(VALUES) == sorted(found)


RATED = ('plant.relief.opening_pressure_mpa', 'plant.valve.hysteresis_percent')
"""Values that the REU's protection takes as ratings from the sheet, but not from a fault."""
NOT_ALONE = ('plant.valve.threshold_percent',)
"""Values that another one leaves no range where it is 0."""


@pytest.mark.parametrize('name', [
    name for name in VALUES if name not in (*RATED, *NOT_ALONE)])
def test_a_fault_before_the_first_tick_acts_as_if_it_stood_in_the_sheet(name):
    """The samples are equal byte for byte, and those without the fault are others."""
    value, sheet = VALUES[name], actuator_sheet('isa_v5')
    changed = smart_actuator('isa_v5', 'mass', timing=TICK)
    written = smart_actuator('isa_v5', 'mass', timing=TICK, sheet=override(sheet, name, value))
    untouched = smart_actuator('isa_v5', 'mass', timing=TICK)
    for own in (changed, written, untouched):   # enough to reach every limit
        own.accept(setpoint(position=0.06, effort=4000.0))
    changed.tune({name: value})
    samples = run(changed, 60)
    assert samples == run(written, 60)
    assert samples != run(untouched, 60)


@pytest.mark.parametrize('name', RATED)
def test_a_fault_of_a_rating_changes_the_plant_and_no_level_of_the_reu(name):
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    plant, reu = (actuator.memory.constants[part].tobytes() for part in ('plant', 'reu'))
    actuator.tune({name: VALUES[name]})
    run(actuator, 1)
    assert actuator.memory.constants['plant'].tobytes() != plant
    assert actuator.memory.constants['reu'].tobytes() == reu


@pytest.mark.parametrize('faults', FAULTS)
def test_a_fault_that_ends_brings_back_the_constants_bit_for_bit(faults):
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    before, sound = actuator._constants.tobytes(), {
        name: actuator.parameter(name) for name in faults}
    actuator.tune(faults)
    run(actuator, 3)
    assert actuator._constants.tobytes() != before
    actuator.tune(sound)
    run(actuator, 1)
    assert actuator._constants.tobytes() == before
    assert actuator.applied_parameters == sound


def test_states_are_kept_when_a_fault_begins():
    """A tick of no length would not move them: the memory is untouched by the change itself."""
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    run(actuator, 10)
    body, reu = actuator._body.tobytes(), actuator._reu.tobytes()
    actuator.tune({'plant.oil.entrained_air': 0.05})
    actuator.tuning.latch(0)
    assert (actuator._body.tobytes(), actuator._reu.tobytes()) == (body, reu)


@pytest.mark.parametrize('name', VALUES)
def test_the_energy_account_closes_whatever_fails(name):
    """E1 = E2 + ... + E6 over a run in which the fault begins; leaks to the outside are in E3."""
    actuator = smart_actuator('isa_v5', Mass(inertia=40.0, force=-300.0))
    for k in range(2000):
        if k % 250 == 0:
            actuator.accept(setpoint(position=0.05 + 0.01 * (-1) ** (k // 250)))
        if k == 600:
            actuator.tune({name: VALUES[name]})
        actuator.tick()
    found = account(actuator)
    assert found['hydraulic_energy'] > 1.0
    # relief valves at 3 MPa, oil boiling behind a stuck spool: bounds of their own tests
    assert remainder(found) < (IMPACTS if name in (
        'plant.relief.opening_pressure_mpa', 'plant.spool.stuck', 'reu.frozen',
        'plant.coil.open_coils', 'plant.coil.supply_voltage') else CLOSES)
    if 'external' in name:
        assert found['cross_port_energy'] > 0.1


@pytest.mark.parametrize('model', MODELS)
def test_the_reu_does_not_know_the_faults_of_its_plant(model):
    """Its constants are those of the sound device, whether tuned or written in the sheet."""
    sheet = actuator_sheet(model)
    sound = actuator_record(sheet, 6)['reu'].tobytes()
    for name, own in changeables(sheet).items():
        if own.declared.get('is_fault') and name.startswith('plant.'):
            faulty = actuator_record(override(sheet, name, own.bounds['le']), 6)
            assert faulty['reu'].tobytes() == sound, name
            assert faulty['plant'].tobytes() != actuator_record(sheet, 6)['plant'].tobytes()


def test_a_sensor_sticks_while_what_it_measures_goes_on_and_comes_free():
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    run(actuator, 10)
    actuator.tune({'plant.sensors.pressure_a.stuck': 1.0})
    run(actuator, 2)
    held, exact = actuator.sample.pressure_a, actuator._body.plant.chambers.p_a
    run(actuator, 20)
    step = actuator._constants.plant.sensors.pressure_step
    assert actuator.sample.pressure_a == held
    assert abs(actuator._body.plant.chambers.p_a - exact) > 2.0 * step
    actuator.tune({'plant.sensors.pressure_a.stuck': 0.0})
    run(actuator, 2)
    assert actuator.sample.pressure_a != held


def test_a_delay_that_is_no_whole_number_of_conversions_is_refused_when_it_is_changed():
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    with pytest.raises(ConfigError, match='isa_v5: .*delay_ms = 0.07 ms'):
        actuator.tune({'plant.sensors.force.delay_ms': 0.07})


def test_a_link_may_lose_its_frames_only_where_there_is_one():
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    with pytest.raises(ConfigError, match='isa_v5: link.loss is not used: there is no link'):
        actuator.tune({'link.loss': 1.0})


@pytest.mark.parametrize('ticks_after', [0, 1, 5])
@pytest.mark.parametrize('faults', FAULTS)
def test_a_snapshot_in_a_fault_continues_byte_for_byte(faults, ticks_after):
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    run(actuator, 10)
    actuator.tune(faults)
    run(actuator, ticks_after)
    twin = smart_actuator('isa_v5', 'mass', timing=TICK)
    twin.restore(actuator.snapshot())
    assert twin.applied_parameters == actuator.applied_parameters
    assert run(twin, 10) == run(actuator, 10)
    assert twin.snapshot() == actuator.snapshot()


def test_a_plant_too_fast_for_its_step_is_refused_when_it_is_changed():
    """A leak that empties the chambers faster than RK4 follows: here of very little oil."""
    sheet = override(actuator_sheet('isa_v5'), 'plant.oil.dead_volume_ml', 0.1)
    sheet = override(sheet, 'plant.oil.effective_bulk_modulus', 2e9)
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK, sheet=sheet)
    with pytest.raises(ConfigError, match='isa_v5: plant.oil.* for the plant step'):
        actuator.tune({'plant.oil.cross_port_leakage': 1e-11})


def test_a_gain_by_its_key_is_converted_and_all_others_stay():
    sheet = actuator_sheet('isa_v5', 'default', 'explicit')
    assert named(changing(sheet), {'reu.current.kp_v_per_ma': 2.0, 'plant.spool.stuck': 1.0}) == {
        'current.kp': 2000.0, 'plant.spool.stuck': 1.0}
