"""Identification: known parameters recovered from the sensor signals."""

from dataclasses import replace
import json
import math
from pathlib import Path

from isa_ros.analysis.identification.flow_curves import DualGainCurve
from isa_ros.analysis.identification.force_balance import (
    COULOMB, fit_friction, OFFSET, STICTION, STRIBECK, VISCOUS)
from isa_ros.analysis.identification.identification import identify, identify_bag
from isa_ros.analysis.identification.volume_balance import (
    C_LI, COMPLIANCE, CURVE, fit_balance, NULL, Q_0)
from isa_ros.cli.main import main
from isa_ros.plant.plant import plant_record
from isa_ros.scripting.run import load
import numpy as np
import pytest
from tests.analysis.recordings import CHANGED, noisy, recording
from tests.sheets import actuator_sheet, override

RIGS = ('smart_manifold', 'isa_v5')
SEEDS = 20
# Of 20 intervals of 95 %, 16 or fewer contain the true value in 1.6 % of the cases.
LEAST_HITS = 17


def true_balance(model: str) -> np.ndarray:
    """Return the parameters of `fit_balance` of the actuator that was recorded."""
    sheet = actuator_sheet(model)
    for path, value in CHANGED[model].items():
        sheet = override(sheet, f'plant.{path}', value)
    plant = plant_record(sheet.plant)[0]
    expected = np.zeros(CURVE + DualGainCurve.size)
    expected[[Q_0, COMPLIANCE, C_LI]] = (
        plant.valve.q_0, 1.0 / plant.chambers.beta, plant.chambers.c_li)
    expected[CURVE:] = plant.valve.k_low, plant.valve.k_high, plant.valve.x_dg
    return expected


def true_friction(model: str) -> np.ndarray:
    expected = np.zeros(5)
    for k, name in ((COULOMB, 'coulomb'), (VISCOUS, 'viscous'), (STICTION, 'stiction')):
        expected[k] = CHANGED[model][f'friction.{name}']
    expected[STRIBECK] = actuator_sheet(model).plant.friction.stribeck_speed
    return expected


def shipped_curve(model: str) -> DualGainCurve:
    return DualGainCurve(float(recording(model).plant.valve.x_dg))


@pytest.mark.slow
@pytest.mark.parametrize('model', RIGS)
def test_intervals_of_valve_and_oil_hold_the_truth_under_noise(model: str) -> None:
    """All seven parameters; the shipped sheet is taken as known, with another value of each."""
    expected, clean = true_balance(model), recording(model)
    found = [fit_balance(noisy(clean, seed), shipped_curve(model)) for seed in range(SEEDS)]
    hits = sum(np.abs(one.values - expected) <= one.half_widths for one in found)
    assert np.all(hits >= LEAST_HITS), hits
    # The intervals are narrow enough: the shipped values are 20 % and more away.
    assert all(one.half_widths[k] < 0.1 * expected[k]
               for one in found for k in range(len(expected)) if k != NULL)


@pytest.mark.slow
@pytest.mark.parametrize('model, sure', [
    ('smart_manifold', (COULOMB, VISCOUS, OFFSET)),
    ('isa_v5', (COULOMB, VISCOUS, OFFSET, STICTION, STRIBECK)),
])
def test_intervals_of_friction_hold_the_truth_under_noise(
        model: str, sure: tuple[int, ...]) -> None:
    """In this motion the manifold has no steady sliding as slow as its Stribeck speed."""
    expected, clean = true_friction(model), recording(model)
    found = [fit_friction(noisy(clean, seed)) for seed in range(SEEDS)]
    hits = sum(np.abs(one.values - expected) <= one.half_widths for one in found)
    assert np.all(hits[list(sure)] >= LEAST_HITS), hits
    assert all(one.half_widths[k] < 0.15 * expected[k]
               for one in found for k in (COULOMB, VISCOUS))


@pytest.mark.parametrize('model', RIGS)
def test_the_converters_alone_do_not_mislead(model: str) -> None:
    """Without noise the rounding repeats in every period, without scatter."""
    balance = fit_balance(recording(model), shipped_curve(model))
    assert np.all(np.abs(balance.values - true_balance(model)) <= balance.half_widths)
    friction = fit_friction(recording(model))
    known = np.isfinite(friction.values)
    assert known[COULOMB] and known[VISCOUS]
    assert np.all((np.abs(friction.values - true_friction(model))
                   <= friction.half_widths)[known])


def test_an_offset_of_the_force_sensor_is_not_taken_for_friction() -> None:
    """A constant beside friction moves by the offset, friction stays within its interval."""
    clean = recording('isa_v5')
    before = fit_friction(clean)
    after = fit_friction(replace(clean, force=clean.force + 40.0))
    assert after.values[OFFSET] - before.values[OFFSET] == pytest.approx(-40.0, abs=0.1)
    assert abs(after.values[COULOMB] - before.values[COULOMB]) < before.half_widths[COULOMB]


def test_a_null_of_the_spool_sensor_is_not_taken_for_leakage() -> None:
    """The null moves by the shift, leakage stays within its interval."""
    clean = recording('smart_manifold')
    curve = shipped_curve('smart_manifold')
    before = fit_balance(clean, curve)
    after = fit_balance(replace(clean, spool=clean.spool + 2e-6), curve)
    assert abs(after.values[NULL] - before.values[NULL] - 2e-6) < after.half_widths[NULL]
    for k in (C_LI, Q_0):
        assert abs(after.values[k] - before.values[k]) < before.half_widths[k]


def test_what_the_motion_does_not_show_is_refused() -> None:
    """Slow motion in one direction: no high gain, no friction; every refusal has a reason."""
    whole = recording('smart_manifold')
    slow = slice(12_100, 13_200)  # a quarter of the slow sine at the end
    short = replace(whole, **{
        name: getattr(whole, name)[slow] for name in (
            'position', 'force', 'pressure_a', 'pressure_b', 'spool', 'supply_pressure')})
    found = {one.parameter: one for one in identify(
        short, actuator_sheet('smart_manifold').plant)}
    for name in ('high flow gain', 'dual-gain point', 'Coulomb friction', 'stiction'):
        assert found[name].value is None and found[name].reason.startswith('not in the data')
    assert all((one.value is None) == bool(one.reason) for one in found.values())


def test_a_high_response_valve_is_identified_by_its_own_curve() -> None:
    """The ISA v2: one gain up to the knee and the flow beyond it; the shipped values."""
    sheet = actuator_sheet('isa_v2').plant
    found = {(one.parameter, one.unit): one
             for one in identify(recording('isa_v2'), sheet)}
    for key in (('flow gain', 'l/min/mA'), ('flow beyond the knee', 'l/min'),
                ('bulk modulus', 'Pa'), ('null leakage', 'l/min')):
        assert found[key].holds, found[key]
        assert found[key].high - found[key].low < 0.4 * found[key].value


@pytest.mark.slow
@pytest.mark.parametrize('config, scenario, name', [
    ('rig_rotary', 'identify', 'rotor'), ('rig_linear', 'identify_linear', 'ram')])
def test_the_shipped_scenarios_show_everything(
        config: str, scenario: str, name: str, tmp_path: Path,
        capsys: pytest.CaptureFixture[str]) -> None:
    """A bag through `isa identify`: all parameters are listed, intervals contain their values."""
    load(config, scenario).simulate().save(tmp_path / 'bag')
    assert main(['identify', str(tmp_path / 'bag'), '--actuator', name,
                 '--json', str(tmp_path / 'found.json')]) == 0
    printed = capsys.readouterr().out
    assert printed.startswith(name) and 'differs' not in printed
    found = json.loads((tmp_path / 'found.json').read_text())
    rows = found['actuators'][name]
    assert found['confidence'] == 0.95 and len(rows) == 12
    for row in rows:
        assert row['reason'] == '' and row['low'] <= row['configured'] <= row['high'], row
        assert row['low'] < row['value'] < row['high'] and math.isfinite(row['value'])


def test_a_bag_without_motion_is_refused_in_one_line(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Input that cannot be used: exit code 2."""
    load('rig_rotary').simulate(0.1).save(tmp_path / 'bag')
    assert main(['identify', str(tmp_path / 'bag')]) == 2
    printed = capsys.readouterr().err
    assert printed.count('\n') == 1
    assert 'bag: nothing to identify: rotor moved' in printed


@pytest.mark.slow
def test_of_an_own_cylinder_the_friction_is_estimated(tmp_path: Path) -> None:
    """Its valve has the curve of a data sheet, without few parameters to fit."""
    load('rig_cylinder', 'identify_linear').simulate().save(tmp_path / 'bag')
    found = {one.parameter: one for one in identify_bag(tmp_path / 'bag').actuators['ram']}
    for name in ('Coulomb friction', 'viscous friction', 'stiction', 'Stribeck speed'):
        assert found[name].holds and found[name].high - found[name].low < 0.3 * found[name].value
    assert found['bulk modulus'].value is None
    assert found['bulk modulus'].reason == 'not estimated with the flow curve of a data sheet'
    assert 'low flow gain' not in found


TWO = """
name: two
step_ms: 1.0
controller_offset_ms: 0.12
tick_timeout_s: 5.0
supply: {kind: constant, pressure_mpa: 20.7, return_pressure_mpa: 0.0}
actuators:
  moving:
    {model: smart_manifold, preset: default, load: {kind: mass}, initial_position_deg: 50.0}
  standing:
    {model: smart_manifold, preset: default, load: {kind: mass}, initial_position_deg: 50.0}
"""
TURN = """
name: turn
duration_s: 0.6
tracks:
  moving:
  - {t_s: 0.0, position: hold, sine: {amplitude: 0.1, frequency_hz: 2.0}}
"""


def test_behind_hoses_nothing_is_estimated() -> None:
    """The sensors are at the valve: the drop of the hoses would be taken for friction."""
    plant, recorded = actuator_sheet('isa_v5').plant, recording('isa_v5')
    hoses = load('rig_hoses').configuration.actuators[0].sheet.plant.hoses
    rows, found = identify(recorded, plant), identify(recorded, replace(plant, hoses=hoses))
    assert all(row.value is not None for row in rows)
    assert found == [replace(
        row, value=None, low=None, high=None,
        reason='not estimated behind hoses: the sensors read the pressures at the valve')
        for row in rows]


def test_an_actuator_that_stands_is_named_beside_one_that_moves(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The table and the file list it with the reason."""
    (tmp_path / 'two.yaml').write_text(TWO)
    (tmp_path / 'turn.yaml').write_text(TURN)
    load(tmp_path / 'two.yaml', tmp_path / 'turn.yaml').simulate().save(tmp_path / 'bag')
    assert main(['identify', str(tmp_path / 'bag'), '--json', str(tmp_path / 'out.json')]) == 0
    printed = capsys.readouterr().out.splitlines()
    assert printed[0] == 'moving'
    assert printed[-1].startswith('standing: nothing to identify: moved')
    found = json.loads((tmp_path / 'out.json').read_text())
    assert list(found['actuators']) == ['moving'] and list(found['still']) == ['standing']


def test_an_unknown_actuator_is_refused_with_the_known_ones(
        capsys: pytest.CaptureFixture[str]) -> None:
    golden = Path(__file__).parents[2] / 'golden' / 'rotor_step'
    assert main(['identify', str(golden), '--actuator', 'knee']) == 2
    assert "no actuator 'knee'; valid: rotor" in capsys.readouterr().err


def test_a_bag_too_short_says_so() -> None:
    """The golden step moves for 0.1 s only, so it is refused."""
    golden = Path(__file__).parents[2] / 'golden' / 'rotor_step'
    found = identify_bag(golden).actuators['rotor']
    assert all(one.value is None and one.reason for one in found)
    assert found[0].reason.startswith('too short')
