"""`isa against`: the parameters with which a measurement was made are found, within intervals."""

from collections.abc import Iterator
import json
from pathlib import Path
import warnings

import isa_ros
from isa_ros.analysis.measured.against import against, as_text, as_tree, fit_cells, NONE
from isa_ros.analysis.measured.closing import free_of
from isa_ros.analysis.measured.fit import Fit
from isa_ros.analysis.measured.mapping import load_mapping
from isa_ros.analysis.measured.measurement import read_measurement
from isa_ros.analysis.measured.playback import played, prepared
from isa_ros.cli.main import main
from isa_ros.errors import ConfigError
import numpy as np
import pytest
from scripts.made_measurement import CLOCK_PPM, measured

DURATION = 3.0  # of CORRELATION, 0.4 s, enough for an interval
TRUE = {'actuators.ram.load.inertia': 65.0,
        'actuators.ram.parameters.plant.friction.viscous': 520.0}
CYLINDER = {
    'name': 'own', 'supply': {
        'kind': 'constant', 'pressure_mpa': 14.0, 'return_pressure_mpa': 0.0},
    'actuators': {'ram': {
        'model': 'cylinder', 'load': {'kind': 'mass', 'inertia': 104.0},
        'initial_position_mm': 50.0, 'parameters': {'plant': {
            'drive': {'bore_mm': 50.0, 'rod_mm': 36.0, 'stroke_mm': 300.0,
                      'rated_pressure_mpa': 14.0},
            'valve': {'rated_drop_mpa': 7.0,
                      'flow': {'rated_flow_lpm': 40.0, 'rated_current_ma': 40.0}},
            'spool': {'frequency_hz': 80.0, 'at': 'minus_90_deg', 'damping_ratio': 0.8}}}}}}
"""Its forces are little more than the noise of a load cell."""


@pytest.fixture(scope='module')
def press(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Path, Path]]:
    """Return a measurement of a machine with `TRUE`, and its mapping."""
    yield measured(tmp_path_factory.mktemp('press'), DURATION, TRUE)


def test_without_noise_the_same_machine_is_met(tmp_path: Path) -> None:
    """What is left is the rounding of the file and of the encoder at the start."""
    path, mapping = measured(tmp_path, 0.5, {}, noise=0.0, clock_ppm=0.0)
    found = against(path, mapping, isa_ros.load('rig_linear'), [NONE])
    position = found.fits['position']
    assert not isinstance(position, str)
    assert position.nrmse < 1e-3 and abs(position.delay) < 1e-4
    assert position.gain == pytest.approx(1.0, abs=1e-3)
    assert not found.parameters and not found.improved


@pytest.mark.slow
def test_the_parameters_of_the_machine_are_found(press: tuple[Path, Path]) -> None:
    """Each within its interval, and its interval useful; the fit of all signals improves."""
    runs: list[int] = []
    found = against(*press, isa_ros.load('rig_linear'), [
        'load.inertia', 'plant.friction.viscous', 'clock_ppm'], None, runs.append)
    inertia, viscous, clock = found.parameters
    assert abs(inertia.value - 65.0) < inertia.half_width < 3.0 and inertia.free.start == 50.0
    assert abs(viscous.value - 520.0) < viscous.half_width < 120.0
    assert abs(clock.value - CLOCK_PPM) < clock.half_width
    for quantity, before in found.fits.items():
        after = found.improved_fits[quantity]
        assert not isinstance(before, str) and not isinstance(after, str)
        assert after.nrmse < 0.5 * before.nrmse, quantity
    assert runs == list(range(1, len(runs) + 1))
    text = as_text(found).splitlines()
    assert text[0].startswith('ram, simulated against measured')
    assert any(line.split()[:2] == ['load.inertia', '50'] and line.endswith('kg')
               for line in text)


@pytest.mark.slow
@pytest.mark.parametrize(('late_ms', 'clock_ppm', 'is_told'), [
    (0.0, 150.0, False), (2.0, 0.0, True)])
def test_a_delay_that_parameters_make_up_for_is_told(
        tmp_path: Path, late_ms: float, clock_ppm: float, is_told: bool) -> None:
    """Without a free delay_ms; a clock that was found makes none."""
    path, mapping = measured(
        tmp_path, DURATION, TRUE, clock_ppm=clock_ppm, delay=1e-3 * late_ms)
    keys = ['plant.friction.viscous', *(['clock_ppm'] if clock_ppm else [])]
    run = isa_ros.load('rig_linear', changes={'actuators.ram.load.inertia': 65.0})
    found = against(path, mapping, run, keys)
    text, tree = as_text(found), as_tree(found, path)
    assert ('the parameters make up for a delay: ' in text) is is_told is bool(found.late)
    assert found.late is None or 0.1 < found.late.value < late_ms
    assert tree['delay_left_ms'] == (found.late.value if found.late else None)


def test_a_delay_that_was_free_is_not_asked_for_again(
        press: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr('isa_ros.analysis.measured.against.delay_left')
    found = against(*press, isa_ros.load('rig_linear'), ['delay_ms'], 0.5)
    assert found.parameters and found.late is None


@pytest.mark.slow
@pytest.mark.parametrize('start', [686.9, 1236.4])
def test_a_noisy_load_cell_hides_no_friction(tmp_path: Path, start: float) -> None:
    """Viscous friction of 1236.4 Ns/m is found from its data sheet's value as from itself."""
    key = 'plant.friction.viscous'
    path, mapping = measured(
        tmp_path, DURATION, {f'actuators.ram.parameters.{key}': 1236.4}, noise=2.0,
        clock_ppm=0.0, machine=CYLINDER)
    found, = against(path, mapping, isa_ros.load(CYLINDER, changes={
        f'actuators.ram.parameters.{key}': start}), [key]).parameters
    assert found.free.start == pytest.approx(start)
    assert abs(found.value - 1236.4) < found.half_width < 150.0


def test_the_command_writes_numbers_and_figure(
        press: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, mapping = press
    assert main(['against', str(path), 'rig_linear', '--mapping', str(mapping), '--free', 'none',
                 '--duration', '0.3', '--set', 'actuators.ram.load.inertia=65',
                 '--json', str(tmp_path / 'x.json'), '--out', str(tmp_path / 'x.png')]) == 0
    tree = json.loads((tmp_path / 'x.json').read_text())
    assert (tree['measurement'], tree['actuator'], tree['parameters']) == ('press.csv', 'ram', [])
    assert set(tree['fits']) == {'position', 'force', 'pressure_a', 'pressure_b'}
    assert tree['fits']['position']['n'] == 301
    assert (tmp_path / 'x.png').read_bytes().startswith(b'\x89PNG')
    shown = capsys.readouterr()
    assert shown.out.splitlines()[1].split() == ['NRMSE', 'delay', 'gain', 'left']
    assert shown.err.splitlines() == [
        'isa: press.csv: 3001 samples, 3 s at 1000 Hz; 0.3 s are compared',
        'isa: ram: without velocity_command the damping of the impedance works against a command '
        'at rest, and the simulation is late by damping over stiffness, 40 ms; map it, or add to '
        'signals: velocity_command: {from: position_command}']


def test_the_slope_of_the_position_moves_the_damping_along(tmp_path: Path) -> None:
    """
    A machine that is commanded with the velocity, of which only the position was logged.

    Without it the simulation is late, of a sweep that is slow against the loops by damping over
    stiffness: 40 ms less the third that a phase of up to 0.5 rad costs. With its slope there is
    no remark, and it is met as by one that was logged: within the step of its converters.
    """
    told: list[str] = []
    run = isa_ros.load('rig_linear')
    path, mapping = measured(tmp_path, 0.8, {}, noise=0.0, clock_ppm=0.0, has_velocity=True)
    before = against(path, mapping, run, [NONE], begun=told.append).fits['position']
    assert not isinstance(before, str) and 0.025 < before.delay < 0.042
    assert 'late by damping over stiffness, 40 ms' in told[1]
    mapping.write_text(mapping.read_text().replace(
        'signals:', 'signals:\n  velocity_command: {from: position_command}'))
    told.clear()
    after = against(path, mapping, run, [NONE], begun=told.append).fits['position']
    assert not isinstance(after, str) and len(told) == 1
    assert abs(after.delay) < 1e-4 and after.nrmse < 2e-3


def test_the_run_begins_as_the_measurement_and_follows_its_command(
        press: tuple[Path, Path], tmp_path: Path) -> None:
    path, mapping = press
    text = mapping.read_text().replace('offset: 100.0', 'offset: 90.0')
    (tmp_path / 'map.yaml').write_text(text)
    own = read_measurement(path, load_mapping(tmp_path / 'map.yaml'), False)
    run = prepared(isa_ros.load('rig_linear'), 'ram', own)
    assert run.configuration.actuator('ram').initial_position == pytest.approx(0.04, abs=2e-5)
    assert run.configuration.actuator('ram').beyond_range == 'limit'
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        simulated = played(run, 'ram', own, 0.2)['position']
    assert simulated.values[-1] > 0.05 and len(simulated.t) == 201


def test_a_command_of_a_mode_is_given_in_that_mode(
        press: tuple[Path, Path], tmp_path: Path) -> None:
    path, mapping = press
    (tmp_path / 'map.yaml').write_text(mapping.read_text().replace(
        'position_command: {column: cmd, unit: mm}',
        'force_command: {column: cmd, unit: N, offset: 850}'))
    own = read_measurement(path, load_mapping(tmp_path / 'map.yaml'), False)
    run = prepared(isa_ros.load('rig_linear'), 'ram', own)
    assert run.configuration.actuator('ram').mode == 'force'
    force = played(run, 'ram', own, 0.2)['force'].values
    assert np.abs(force[50:100]).mean() > 300.0    # 900 N in all, less what moves 50 kg


@pytest.mark.parametrize('mode', ['force', 'spool', 'current'])
def test_a_position_that_the_mode_does_not_use_is_refused(
        press: tuple[Path, Path], mode: str) -> None:
    """Otherwise it would be simulated without a force, and parameters found for that."""
    run = isa_ros.load('rig_linear', changes={'actuators.ram.mode': mode})
    with pytest.raises(ConfigError) as refused:
        against(*press, run, [NONE])
    assert str(refused.value) == (
        f'press.csv: has position_command, which ram does not use in mode {mode}; set '
        'actuators.ram.mode to position or impedance, or map force_command too')


def test_a_short_measurement_is_said_to_have_no_intervals(
        press: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch) -> None:
    """Before the search, and only where there is one."""
    monkeypatch.setattr('isa_ros.analysis.measured.against.closed', lambda *given: [])
    told: list[str] = []
    for free, duration in (([NONE], 0.3), (['load.inertia'], 3.0), (['load.inertia'], 0.3)):
        assert not [line for line in told if 'too short' in line]
        against(*press, isa_ros.load('rig_linear'), free, duration, begun=told.append)
    assert 'press.csv: 0.3 s are too short for intervals, which need 3 s or more' in told


def test_what_is_told_does_not_wait_for_the_rest(tmp_path: Path) -> None:
    """How much there is and a doubt in its time are said of a log in us that is mapped as s."""
    path, mapping = measured(tmp_path, 0.5, {}, noise=0.0, clock_ppm=0.0)
    lines = path.read_text().splitlines()
    head = next(k for k, line in enumerate(lines) if line.startswith('t'))
    path.write_text('\n'.join([*lines[:head + 1], *(
        f'{float(t) * 1e3:g},{rest}' for t, _, rest in (
            line.partition(',') for line in lines[head + 1:]))]))
    mapping.write_text(mapping.read_text().replace('unit: ms', 'unit: s'))
    told: list[str] = []
    against(path, mapping, isa_ros.load('rig_linear'), [NONE], 0.1, begun=told.append)
    assert 'is its time in us?' in told[1]


@pytest.mark.parametrize('signals, expected', [
    ('position: {column: pos, unit: mm}', 'press.csv: has no command, so there is nothing to sim'),
    ('position_command: {column: cmd, unit: mm}', 'has commands only, nothing to compare'),
    ('force_command: {column: cmd, unit: N}\n  spool_command: {column: cmd, unit: mm}\n  '
     'position: {column: pos, unit: mm}', 'has force_command and spool_command, must have one'),
    ('velocity_command: {column: cmd, unit: mm/s}\n  position: {column: pos, unit: mm}',
     'has velocity_command, must have one')])
def test_what_cannot_be_simulated_is_refused(
        press: tuple[Path, Path], tmp_path: Path, signals: str, expected: str) -> None:
    (tmp_path / 'map.yaml').write_text(
        f'time: {{column: t, unit: ms}}\nsignals:\n  {signals}\n')
    with pytest.raises(ConfigError) as refused:
        against(press[0], tmp_path / 'map.yaml', isa_ros.load('rig_linear'), [NONE])
    assert expected in str(refused.value)


def test_a_run_of_several_actuators_needs_a_name(press: tuple[Path, Path]) -> None:
    with pytest.raises(ConfigError, match='the mapping lacks actuator, one of haa, hfe, kfe'):
        against(*press, isa_ros.load('leg'), [NONE])


def test_free_parameters_have_their_declared_bounds() -> None:
    run = isa_ros.load('rig_linear')
    [bulk] = free_of(run, 'ram', ['plant.oil.effective_bulk_modulus'])
    assert (bulk.start, bulk.low, bulk.high, bulk.unit) == (7e8, 7e7, 2e9, 'Pa')
    [given] = free_of(run, 'ram', ['plant.mechanics.backlash=0:1e-4'])
    assert (given.start, given.low, given.high, given.size) == (0.0, 0.0, 1e-4, 2.5e-5)
    assert [own.key for own in free_of(run, 'ram', [])] == [
        'load.inertia', 'plant.friction.viscous', 'plant.oil.effective_bulk_modulus', 'delay_ms']


@pytest.mark.parametrize('key, expected', [
    ('plant.friction.viscose', '--free plant.friction.viscose: is unknown; did you mean viscous'),
    ('oil.bulk', '--free oil.bulk: is unknown'),
    ('plant.mechanics.backlash', 'is 0, give bounds within its range: plant.mechanics.backlash='),
    ('load.inertia=3', '--free load.inertia=3: must be KEY=LOW:HIGH'),
    ('load.inertia=9:3', 'give bounds within its range'),
    ('reu.position.kind', 'is unknown')])
def test_a_key_that_cannot_be_free_is_refused(key: str, expected: str) -> None:
    with pytest.raises(ConfigError) as refused:
        free_of(isa_ros.load('rig_linear'), 'ram', [key])
    assert expected in str(refused.value)


@pytest.mark.parametrize('is_at_end', [False, True])
def test_a_delay_at_the_end_of_its_search_is_no_match(is_at_end: bool) -> None:
    """As of a time in the wrong unit: a gain of 0 leaves nothing, which reads as perfect."""
    remark = fit_cells('force', Fit(1.0, 0.1, 0.0, 0.0, 99, is_at_end))[-1]
    assert remark == ('no match: the delay is at the end of its search' if is_at_end else '')
