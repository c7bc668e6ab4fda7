"""Forces that swing where the motion has ended: which are told, and how large they are."""

import isa_ros
from isa_ros.analysis.report.verdict import NOTE, verdict
from isa_ros.analysis.signals.signals import Signal, Signals, signals_of
from isa_ros.reu.wiring import active
import numpy as np
import pytest
from tests.analysis.report.test_verdict import SHEET, signals, T, texts

REST = 0.05 - 0.01 * np.exp(-T / 0.05)
SPAN = SHEET.plant.sensors.force_range
WAVE = 0.01 * SPAN * (-1.0) ** np.arange(101)      # +-1 % of the range of the sensor


def swings(force, position=REST, **more):
    found = verdict(signals(position=position, force=force, **more), [], [], '')
    return [text for text in texts(found, NOTE) if text.startswith('Force')]


def test_a_force_that_swings_where_the_motion_has_ended_is_told():
    """A square wave about 2 kN, and one of a blocked actuator."""
    expected = ['Force swings in the last tenth of the time: ram by +-'
                f'{0.0101 * SPAN:.3g} N at 50 Hz, 1 % of the range of its sensor.']
    blocked = np.full(101, 0.04)
    assert swings(2e3 + 1.01 * WAVE) == swings(1.01 * WAVE, blocked) == expected
    gap = np.where(np.arange(101) == 95, np.nan, 1.01 * WAVE)
    assert [text.partition(' at ')[0] for text in swings(gap)] == [
        expected[0].partition(' at ')[0]]
    assert swings(0.99 * WAVE) == swings(0.99 * WAVE, blocked) == []
    assert swings(9.0 * WAVE, 0.04 + 0.01 * T) == []                # it moves
    assert swings(np.where(T < 0.85, 9.0, 0.5) * WAVE) == []        # it has ended


def test_what_is_wanted_of_a_blocked_actuator_is_not_told():
    blocked, wave = np.full(101, 0.04), 9.0 * WAVE
    assert swings(wave, blocked, force_reference=0.51 * wave) == []
    assert len(swings(wave, blocked, force_reference=0.49 * wave)) == 1
    assert len(swings(wave, force_reference=wave)) == 1     # of a loop around it


def test_a_step_a_drift_and_a_pulse_are_no_swings():
    step, pulse = np.where(T > 0.95, SPAN, 0.0), np.where(np.abs(T - 0.95) < 0.02, SPAN, 0.0)
    assert swings(step + 0.001 * WAVE) == swings(SPAN * T) == swings(pulse) == []

    def pulses(*ticks):
        return np.where(np.isin(np.arange(101), ticks), SPAN, 0.0)
    assert swings(pulses(92, 95)) == []                 # two whole half periods
    assert len(swings(pulses(92, 95, 98))) == 1         # four
    assert swings(pulses(92, 93, 94, 97, 98, 99)) == swings(pulses(91, 93, 95)) == []   # it ends


def test_a_valve_without_a_force_loop_swings_as_its_current_is_asked_to():
    """On a fixture, which yields."""
    run = isa_ros.load('rig_valve').configuration
    assert 'force' not in active(run.actuator('hrv').sheet.reu)
    force = 0.1 * run.actuator('hrv').sheet.plant.sensors.force_range * (-1.0) ** np.arange(101)
    own = Signals(run, {'hrv.position': Signal(T, REST), 'hrv.force': Signal(T, force)}, T, 'here')
    assert not any('swings' in found.text for found in verdict(own, [], [], ''))


@pytest.mark.parametrize('beside', [
    SPAN * T, -SPAN * T, np.where(T > 0.955, 0.3 * SPAN, 0.0), np.where(T == T[95], SPAN, 0.0)])
def test_a_swing_is_as_large_beside_a_drift_a_step_and_a_pulse(beside):
    """Ways of 6 and 4 % of the range in turn; or one way of them all that is longer."""
    said, = swings(beside + 2.5 * WAVE)
    assert f' by +-{0.025 * SPAN:.3g} N at ' in said
    assert said.endswith(' Hz, 2.5 % of the range of its sensor.')


def test_a_swing_of_the_whole_range_is_told_without_an_exponent():
    said, = swings(150.0 * WAVE)
    assert said.endswith('150 % of the range of its sensor.')


@pytest.mark.parametrize(('factor', 'is_told'), [(8.0, True), (1.0, False)])
def test_a_loop_that_hunts_on_a_fixture_is_told(factor, is_told):
    """Its support yields by micrometres, so that the position is no constant."""
    run = isa_ros.load('rig_linear', {
        'name': 'pressed', 'duration_s': 0.5, 'loads': {'ram': {'kind': 'blocked'}},
        'tracks': {'ram': [
            {'t_s': 0.0, 'mode': 'force', 'position': 'hold', 'effort': 1000.0}]}})
    kp = run.configuration.actuators[0].sheet.reu.force.kp
    found = signals_of(run.replace({
        'actuators.ram.parameters.reu.force.kp': factor * kp}).simulate())
    assert np.ptp(found['ram.position']) > 0.0
    said = [own.text for own in verdict(found, [], [], '')]
    assert any(text.startswith('Stood: ram within 0.') for text in said)
    assert any(text.startswith('Force swings in the last tenth') for text in said) is is_told
