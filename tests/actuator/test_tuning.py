"""Tuning an actuator: in force from the next tick on, all values or none, state kept."""

from isa_ros.actuator import tuning
from isa_ros.errors import ConfigError
import numpy as np
import pytest
from tests.actuator.efforts import run
from tests.sheets import actuator_sheet, MODELS, override, setpoint, smart_actuator, TICK


@pytest.mark.parametrize('model', MODELS)
def test_a_value_tuned_before_the_first_tick_acts_as_if_it_stood_in_the_sheet(model):
    """The samples are equal byte for byte, from t = 0 on."""
    sheet = actuator_sheet(model)
    kp = 0.7 * sheet.reu.force.kp
    tuned = smart_actuator(model, 'mass', timing=TICK)
    written = smart_actuator(
        model, 'mass', timing=TICK, sheet=override(sheet, 'reu.force.kp', kp))
    untouched = smart_actuator(model, 'mass', timing=TICK)
    tuned.tune({'force.kp': kp})
    samples = run(tuned, 30)
    assert samples == run(written, 30)
    assert samples != run(untouched, 30)
    assert tuned.digest == untouched.digest != written.digest


def test_a_value_acts_from_the_next_tick_on_and_the_loops_keep_their_states():
    """The tick before is not changed, and the integral keeps its value."""
    tuned, untouched = (smart_actuator('isa_v5', 'mass', timing=TICK) for _ in range(2))
    assert run(tuned, 20) == run(untouched, 20)
    tuned.tune({'force.kp': 1.2e-7})
    assert tuned.applied_parameters == {}
    assert tuned._reu.force.integral == untouched._reu.force.integral != 0.0
    assert run(tuned, 1) != run(untouched, 1)
    assert tuned.applied_parameters == {'force.kp': 1.2e-7}
    tuned.tick()
    assert tuned.applied_parameters == {}
    assert tuned.parameter('force.kp') == 1.2e-7


def test_of_several_before_one_tick_the_last_wins_and_what_does_not_change_is_not_said():
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    before = actuator.parameter('force.ki')
    actuator.tune({'force.kp': 1.2e-7, 'force.ki': before})
    actuator.tune({'force.kp': 1.1e-7, 'force.kf': 1e-3})
    actuator.tick()
    assert actuator.applied_parameters == {'force.kp': 1.1e-7, 'force.kf': 1e-3}
    actuator.tune({'force.kp': 1.0e-7})
    actuator.tune({'force.kp': 1.1e-7})
    actuator.tick()
    assert actuator.applied_parameters == {}


def test_the_value_of_the_sheet_brings_back_its_bytes():
    """Conversion leaves no rounding error: kp is V/mA in the sheet, V/A here."""
    sheet = actuator_sheet('isa_v5', 'default', 'explicit')
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK, sheet=sheet)
    before, kp = actuator._constants.tobytes(), actuator.parameter('current.kp')
    actuator.tune({'current.kp': 0.9 * kp})
    actuator.tick()
    assert actuator._constants.tobytes() != before
    actuator.tune({'current.kp': kp})
    actuator.tick()
    assert actuator._constants.tobytes() == before


def test_of_values_of_which_one_is_refused_none_is_taken():
    """The second value alone is valid, the first is beyond the spool's stop."""
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    kp = actuator.parameter('force.kp')
    with pytest.raises(ConfigError, match=r'isa_v5: force.limit = 0.001 m, must be <='):
        actuator.tune({'position.stiffness': 1e4, 'force.kp': 1.2e-7, 'force.limit': 1e-3})
    actuator.tick()
    assert actuator.applied_parameters == {}
    assert actuator.applied is None
    assert actuator.parameter('force.kp') == kp


def test_a_tuned_stiffness_is_a_setpoint_that_changes_this_gain_alone():
    """Equilibrium, feed-forward and the other gain are kept; the echo has all of them."""
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    actuator.accept(setpoint(position=0.051, velocity=0.01, effort=5.0, damping=3000.0))
    actuator.tick()
    actuator.tune({'position.stiffness': 4e4})
    assert actuator.parameter('position.stiffness') == 4e4
    actuator.tick()
    assert actuator.applied_parameters == {}
    echo = actuator.applied
    assert [echo[name] for name in (
        'position', 'velocity', 'effort', 'stiffness', 'damping', 'is_enabled')] == [
        0.051, 0.01, 5.0, 4e4, 3000.0, 1]


def test_a_gain_and_a_setpoint_before_one_tick_act_as_if_sent_one_after_the_other():
    """A setpoint without a gain keeps the tuned one; a gain in the setpoint replaces it."""
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    actuator.tune({'position.stiffness': 4e4, 'position.damping': 2e3})
    actuator.accept(setpoint(position=0.051, damping=1e3))
    actuator.tick()
    assert [actuator.applied[name] for name in ('position', 'stiffness', 'damping')] == [
        0.051, 4e4, 1e3]
    assert actuator.parameter('position.damping') == 1e3


@pytest.mark.parametrize('ticks_after', [0, 1, 5])
def test_a_restored_snapshot_continues_with_what_was_tuned(ticks_after):
    """Values in force or still pending are restored; samples and echoes are the same."""
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    run(actuator, 10)
    actuator.tune({'force.kp': 1.2e-7, 'position.stiffness': 4e4})
    run(actuator, ticks_after)
    snapshot = actuator.snapshot()
    twin = smart_actuator('isa_v5', 'mass', timing=TICK)
    twin.restore(snapshot)
    assert twin.applied_parameters == actuator.applied_parameters
    assert twin.parameter('force.kp') == 1.2e-7
    assert run(twin, 10) == run(actuator, 10)
    assert twin.snapshot() == actuator.snapshot()


def test_a_saved_state_with_a_value_that_cannot_be_is_refused():
    """A saved state is checked like a user's values."""
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    kp = np.float64(actuator.parameter('force.kp')).tobytes()
    snapshot = actuator.snapshot().replace(kp, np.float64(-1.0).tobytes())
    with pytest.raises(ConfigError, match='isa_v5: force.kp = -1 m/N, must be >= 0'):
        actuator.restore(snapshot)


def test_what_was_tuned_is_in_force_again_from_the_first_tick_of_another_run():
    """The echo has it, since the configuration has not; at t = 0 the sheet's is in force."""
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    begin = actuator._constants.tobytes()
    actuator.tune({'force.kp': 1.2e-7, 'position.stiffness': 4e4})
    actuator.tick()
    actuator.accept(setpoint(position=0.05, stiffness=3e4))
    actuator.tick()
    actuator.start(0.05, 0.0, 20.7e6, 0.0)
    assert actuator._constants.tobytes() == begin
    assert (actuator.applied_parameters, actuator.applied['stiffness']) == ({}, 1e5)
    actuator.tick()
    assert actuator.applied_parameters == {'force.kp': 1.2e-7}
    assert actuator.applied['stiffness'] == 4e4


def test_a_state_saved_before_the_tuning_brings_back_what_was_in_force_then():
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    first, begin = actuator.snapshot(), actuator._constants.tobytes()
    actuator.tune({'force.kp': 1.2e-7})
    actuator.tick()
    actuator.restore(first)
    assert actuator._constants.tobytes() == begin


@pytest.mark.parametrize(('key', 'name', 'unit'), [
    ('reu.current.kp_v_per_ma', 'current.kp', 1e3), ('reu.position.stiffness',
                                                     'position.stiffness', 1.0)])
def test_a_gain_has_its_key_and_unit_of_the_sheet_and_its_name_of_messages_in_si(
        key, name, unit):
    by_key, by_name = (smart_actuator(
        'isa_v5', 'mass', timing=TICK, sheet=actuator_sheet('isa_v5', 'default', 'explicit'))
        for _ in range(2))
    assert by_key.parameter(name) == by_key.parameter(key) * unit
    value = 0.5 * by_key.parameter(key)
    by_key.tune({key: value})
    by_name.tune({name: value * unit})
    assert by_key.parameter(key) == value and by_key.parameter(name) == value * unit
    assert run(by_key, 5) == run(by_name, 5)
    assert by_key.snapshot() == by_name.snapshot()


def test_messages_have_a_gain_by_its_name_in_si():
    actuator = smart_actuator(
        'isa_v5', 'mass', timing=TICK, sheet=actuator_sheet('isa_v5', 'default', 'explicit'))
    actuator.tune({'reu.current.kp_v_per_ma': 2.0, 'plant.spool.stuck': 1.0})
    actuator.tick()
    assert actuator.applied_parameters == {'current.kp': 2000.0, 'plant.spool.stuck': 1.0}


@pytest.mark.parametrize(('values', 'message'), [
    ({'reu.current.kp_v_per_ma': 2000.0},
     r'isa_v5: reu.current.kp_v_per_ma = 2000 V/mA, must be <= 1000 V/mA \(K_p of eq'),
    ({'reu.current.kp_v_per_a': 2.0},
     'isa_v5: reu.current.kp_v_per_a is unknown; .*reu.current.kp_v_per_ma')])
def test_a_refused_value_is_named_as_it_was_given(values, message):
    actuator = smart_actuator(
        'isa_v5', 'mass', timing=TICK, sheet=actuator_sheet('isa_v5', 'default', 'explicit'))
    with pytest.raises(ConfigError, match=message):
        actuator.tune(values)


def test_values_that_are_refused_together_are_refused_in_two_calls_too(monkeypatch):
    """Before one tick: what waits is checked with what comes."""
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    allowed = tuning.changed_together

    def not_both(sheet, load, values, known):
        if {'force.kp', 'force.kf'} <= values.keys():
            raise ConfigError('not both')
        return allowed(sheet, load, values, known)
    monkeypatch.setattr(tuning, 'changed_together', not_both)
    actuator.tune({'force.kp': 1.1e-7})
    with pytest.raises(ConfigError, match='isa_v5: not both'):
        actuator.tune({'force.kf': 1e-3})
    actuator.tick()
    assert actuator.applied_parameters == {'force.kp': 1.1e-7}


@pytest.mark.parametrize('key', ['plant.spool.stuck', 'reu.force.kp', 'force.kp'])
def test_a_truth_is_no_number(key):
    """It was taken as 1."""
    actuator = smart_actuator('isa_v5', 'mass', timing=TICK)
    before = actuator.parameter(key)
    with pytest.raises(ConfigError, match=f'{key} = True, must be a number'):
        actuator.tune({key: True})
    actuator.tick()
    assert actuator.parameter(key) == before
