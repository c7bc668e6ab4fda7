"""Studies: their parameters, their results, and the output of the command."""

from dataclasses import replace
import json
import math
from pathlib import Path
import sys

from isa_ros.analysis.response.bode import bode
from isa_ros.analysis.signals.frequency import ripple
from isa_ros.analysis.studies import (
    falling_load, hysteresis, lowering, measure as study_run, power_unit, servo_valve, temperature)
from isa_ros.analysis.studies.measure import (
    Benches, changed, MeasuresAt, placed, shipped, Studied, up_and_back)
from isa_ros.analysis.studies.page import seen
from isa_ros.analysis.studies.studies import Case, STUDIES, Study, study_of
from isa_ros.cli import main as cli
from isa_ros.errors import ConfigError
from isa_ros.reu.schedule import Constant
from isa_ros.text.table import digits
import numpy as np
import pytest
from tests.text.terminal import Terminal

REST = slice(-4000, None)   # 0.4 s of 10 kHz
NEAR_STOP = 0.02
QUIET = 0.01                # of the step, about a quantum of the force sensors
CASES = [pytest.param(study, case, id=f'{study.name}-{case.model}')
         for study in STUDIES for case in study.cases]


def case_of(name: str, model: str) -> Case:
    """Return a case of a study."""
    return next(case for case in study_of(name).cases if case.model == model)


@pytest.fixture(scope='module')
def benches() -> Benches:
    """Return the benches, made once."""
    return Benches()


@pytest.mark.parametrize(('study', 'case'), CASES)
def test_every_value_can_be_run_and_one_of_them_is_the_shipped_one(study, case, benches):
    """All values are in range and rates divide, as a rig requires before it moves."""
    on = benches.of(case)
    for value in case.values:
        changed(on.blocked, 'force', case.parameters(value))
    own = shipped(case, on)
    assert sum(math.isclose(value, own, rel_tol=1e-9) for value in case.values) == 1


@pytest.mark.parametrize(('name', 'value', 'expected'), [
    ('adc_bits', 3.0, 'adc_bits = 3 bit, must be >= 4 bit'),
    ('backlash', 11.0, 'backlash = 0.011 m | rad, must be <= 0.01 m | rad'),
    ('lap', 51.0, 'pa_um = 51 um, must be <= 50 um'),
    ('force_rate', 2500.0, 'position.rate_hz = 1000 Hz does not divide force.rate_hz = 2500 Hz'),
    ('force_rate', 25e3, 'force.rate_hz = 25000 Hz does not divide current.rate_hz = 10000 Hz'),
    ('delay', 100.0, 'computation_delay_us = 100 us, must be a multiple of 20 us below 100 us')])
def test_a_value_no_actuator_could_have_is_refused(name, value, expected, benches):
    case = case_of(name, 'smart_manifold')
    with pytest.raises(ConfigError, match=expected.replace('|', r'\|')):
        changed(benches.of(case).blocked, 'force', case.parameters(value))


def test_coarser_converters_ripple_more(benches):
    """A limit cycle of about the quantum, 400 Nm over 2^bits, which the loop cannot resolve."""
    case = case_of('adc_bits', 'smart_manifold')
    found = {}
    for bits in (8.0, 10.0, 12.0):
        rig = changed(benches.of(case).blocked, 'force', case.parameters(bits))
        found[bits] = max(ripple(part[REST]) for part in up_and_back(rig))
        # half of peak to peak within one quantum to either side
        assert found[bits] <= 400.0 / 2.0 ** bits
    assert found[8.0] > found[10.0] > found[12.0]


def test_backlash_hunts_only_with_the_damping_in_the_proportional_part(benches):
    """Back at zero torque the loop crosses 5 mrad of half play, or stays on one side of it."""
    case = case_of('backlash', 'smart_manifold')
    on = benches.of(case)
    for damping, hunts in (('before_pid', False), ('proportional', True)):
        rig = changed(on.blocked, 'force', case.parameters(5.0) | {
            'reu.force.feedback_damping': damping})
        loaded, released = up_and_back(rig)
        assert ripple(loaded[REST]) < QUIET * rig.loop.amplitude
        assert (ripple(released[REST]) > 0.1 * rig.loop.amplitude) == hunts
    # It does not decay: no smaller in the last 0.4 s than 0.4 s before.
    assert ripple(released[REST]) == pytest.approx(ripple(released[-8000:-4000]), rel=0.05)


def test_overlap_takes_bandwidth_and_does_not_hunt(benches):
    """A dead band lowers the gain of a sine's first harmonic, the more the wider it is."""
    case = case_of('lap', 'smart_manifold')
    found = []
    for lap in (0.0, 10.0, 20.0, 40.0):
        rig = changed(benches.of(case).blocked, 'force', case.parameters(lap))
        found.append(bode(rig, study_run.SWEEP, 'closed').bandwidth)
        assert all(ripple(part[REST]) < QUIET * rig.loop.amplitude for part in up_and_back(rig))
    assert found == sorted(found, reverse=True) and found[0] > 2.0 * found[-1]


@pytest.mark.parametrize(('name', 'model', 'value', 'remedy'), [
    ('lap', 'isa_v5', -10.0, {'reu.force.kv': 0.0}),
    ('lap', 'smart_manifold', -5.0, {'reu.force.kp': 2e-5})])
def test_underlap_hunts_on_the_wheel_as_the_page_says(name, model, value, remedy, benches):
    """Too much velocity compensation of the ISA v5, too much gain of the manifold."""
    case, found = case_of(name, model), []
    on = benches.of(case)
    for added in ({}, remedy):
        rig = changed(on.wheel, 'position', case.parameters(value) | added)
        force = rig.excite(rig.start(), on.positions, on.velocities)['force']
        found.append(ripple(force[REST]))
    assert found[0] > 10.0 * found[1]


@pytest.mark.parametrize(('name', 'model', 'value', 'place', 'remedy'), [
    ('encoder', 'smart_manifold', 69.0, 0.5, {'reu.force.kv': 0.0}),
    ('support', 'smart_manifold', 10.0, NEAR_STOP, {'load.inertia': 0.005}),
    ('support', 'isa_v5', 1.0, NEAR_STOP, {'reu.force.gain_schedule': Constant()})])
def test_what_hunts_blocked_does_so_for_the_reason_on_the_page(
        name, model, value, place, remedy, benches):
    case, found = case_of(name, model), []
    for added in ({}, remedy):
        rig = changed(benches.of(case).blocked, 'force', case.parameters(value) | added)
        found.append(max(ripple(part[REST]) for part in up_and_back(placed(rig, place))))
    assert found[1] < QUIET * rig.loop.amplitude and found[0] > 10.0 * found[1]


def test_the_trot_moves_its_velocity_along_and_ends_at_rest(benches):
    """Setpoints 1 ms apart: the trapezoid of their velocities is the distance between them."""
    on = benches.of(case_of('lap', 'smart_manifold'))
    positions, velocities = on.positions[::10], on.velocities[::10]
    way = 0.5e-3 * (velocities[1:] + velocities[:-1])
    # h^3/12 of the third derivative, at most 7.2e3 rad/s^3 in the swing: 6e-7 rad
    assert np.abs(np.diff(positions) - way).max() < 1e-6
    assert np.ptp(positions) > 0.3      # HFE moves by 0.35 rad
    assert np.all(positions[-900:] == 0.0) and np.all(velocities[-900:] == 0.0)


def outcome(value: float) -> MeasuresAt:
    """Return an outcome with made-up numbers."""
    return MeasuresAt(
        value=value, rise=4.0, overshoot=40.0, bandwidth=60.0, ripple_mid=0.1, ripple_end=0.2,
        ripple_wheel=0.3, ripple_hz=20.0, force_error=3.0, position_error=70.0,
        step=np.zeros(1000))


@pytest.mark.parametrize('study', STUDIES, ids=lambda study: study.name)
def test_every_text_takes_its_numbers_from_the_run(study):
    """All braces refer to a value of the study; a part of a study has no text."""
    results = [Studied(case, case.values[0], 17.0, tuple(map(outcome, case.values)), True)
               for case in study.cases]
    text = seen(study, results)
    assert text and '{' not in text and max(map(len, text.splitlines())) <= 99
    assert seen(replace(study, cases=study.cases[:1]), results[:1]) == ''


def test_the_page_in_docs_shows_every_study():
    docs = Path(__file__).parents[3] / 'docs'
    page = (docs / 'studies.md').read_text(encoding='utf-8')
    for study in STUDIES:
        assert f'## {study.title}\n' in page
        assert (docs / f'figures/study_{study.name}.png').stat().st_size < 60_000


def test_without_a_name_the_studies_are_listed(capsys):
    assert cli.main(['study']) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == [
        *(study.name for study in STUDIES), temperature.NAME, servo_valve.NAME, hysteresis.NAME,
        falling_load.NAME, lowering.NAME, power_unit.NAME]


@pytest.mark.parametrize(('arguments', 'expected'), [
    (['backlsh'], "study 'backlsh' is unknown; did you mean backlash?"),
    (['lap', '--model', 'isa_v2'], '--model isa_v2: not a model of a study; did you mean isa_v5?'),
    (['lap', '--all'], 'study lap and --all, must be one of both'),
    (['--model', 'isa_v5'], '--model needs a study, or --all; adc_bits, '),
    (['lap', '--values', '3'], '--values needs one study of one --model'),
    (['adc_bits', '--model', 'isa_v5', '--values', '3'], 'adc_bits = 3 bit, must be >= 4 bit')])
def test_what_cannot_be_studied_is_one_line_and_2(arguments, expected, capsys):
    assert cli.main(['study', *arguments]) == 2
    printed = capsys.readouterr()
    assert expected in printed.err and printed.err.count('\n') == 1
    assert printed.out == ''


def test_the_command_prints_writes_and_draws_one_study(tmp_path: Path, capsys, monkeypatch):
    numbers, terminal = tmp_path / 'study.json', Terminal()
    monkeypatch.setattr(sys, 'stderr', terminal)
    assert cli.main([
        'study', 'backlash', '--model', 'smart_manifold', '--values', '0', '5',
        '--json', str(numbers), '--out', str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    tree, = json.loads(numbers.read_text())
    case, = tree['cases']
    assert (tree['name'], case['unit'], case['shipped'], case['step']) == (
        'backlash', 'mrad', 0.0, 17.0)
    assert case['parameters'] == {'plant.mechanics.backlash': 1e-3}
    page = (tmp_path / 'studies.md').read_text(encoding='utf-8')
    for found, label in zip(case['outcomes'], ('0*', '5'), strict=True):
        row = next(line for line in printed.splitlines() if line.split()[:1] == [label])
        assert f'{found["overshoot"]:.3g}' in row and digits(found['bandwidth'], 3) in row
        assert f'| {" | ".join(row.split())} |' in page
    figure = tmp_path / 'figures/study_backlash.png'
    assert figure.read_bytes().startswith(b'\x89PNG') and figure.name in page
    shown = terminal.getvalue().split('\r')
    assert shown[1].startswith('backlash: 1 of 2 values, ') and shown[-1] == '\x1b[K'


def test_a_study_is_plain_data():
    study = study_of('lap')
    assert isinstance(study, Study) and study == replace(study)
    assert study.cases[0].parameters(5.0) == {
        f'plant.valve.lap.{land}_um': 5.0 for land in ('pa', 'at', 'bt', 'pb')}
