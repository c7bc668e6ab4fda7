"""`isa bode` and `isa step` on the bare actuator: numbers, agreement of methods, refusals."""

from dataclasses import replace
import json
from pathlib import Path

from isa_ros.analysis.response.bode import Bode, bode, conclusions, table
from isa_ros.analysis.response.loops import loop_of
from isa_ros.analysis.response.rig import Choice, Rig, rig
from isa_ros.analysis.response.step import step, summary
from isa_ros.analysis.response.sweep import FrequencySweep
from isa_ros.cli import main as cli
from isa_ros.reu.wiring import Off
import numpy as np
import pytest

FORCE = FrequencySweep(low=2.0, high=150.0, points=24)


@pytest.fixture(scope='module')
def torque() -> Rig:
    """Return the blocked rotary rig with the paper's gains."""
    return rig(Choice(name='smart_manifold', loop='force', preset='table_4'))


@pytest.fixture(scope='module')
def measured(torque: Rig) -> Bode:
    """Return its closed loop."""
    return bode(torque, FORCE, 'closed')


def test_torque_bandwidth_of_table_4_at_17_newton_metres(measured):
    """physics.md section 4: -3 dB at 40 to 100 Hz for 17 Nm (paper: 50 to 100)."""
    assert measured.bandwidth is not None and 40.0 <= measured.bandwidth <= 100.0
    assert measured.amplitude == 17.0
    assert measured.response.coherence.min() > 0.99
    # (2/23)^2, see test_slow_torque_follows_its_reference
    assert measured.response.gain[0] == pytest.approx(1.0, abs=0.01)


def test_stepped_sine_and_chirp_agree(torque, measured):
    """Two excitations and two estimators, one loop at one amplitude."""
    swept = bode(torque, FrequencySweep(low=2.0, high=150.0, points=24, is_chirp=True), 'closed')
    log_f = np.log(swept.response.frequency)
    real, imaginary = (np.interp(log_f, np.log(measured.response.frequency), part)
                       for part in (measured.response.value.real, measured.response.value.imag))
    # Straight lines between points a factor q = 75^(1/23) apart, ln q = 0.19: near the peak
    # (1.75 at 29 Hz, half width about 10 Hz) the second derivative over ln f is about
    # 2 * 1.75 (29 / 10)^2 = 29, off by 29 / 8 * 0.19^2 = 0.13; far from it a tenth of that.
    distance = np.abs(swept.response.value - (real + 1j * imaginary))
    assert distance.max() < 0.13
    assert np.median(distance) < 0.013
    # the crossing has a slope of 12 dB an octave: 0.013 of 0.71 is 0.16 dB, 1 %
    assert swept.bandwidth == pytest.approx(measured.bandwidth, rel=0.02)


def test_open_and_closed_loop_are_one_run(torque, measured):
    """L = T / (1 - T) at every frequency."""
    opened = bode(torque, FORCE, 'open')
    closed = measured.response.value
    # a fit of the difference is the difference of the fits
    assert opened.response.value == pytest.approx(closed / (1.0 - closed), rel=1e-6)
    assert opened.margins == measured.margins


def test_small_spool_strokes_have_the_bandwidth_of_equations_8_and_10():
    """The closed spool loop behind the current's pole: 104 Hz without the voltage limit."""
    sweep = FrequencySweep(low=5.0, high=300.0, points=25)
    got = bode(rig(Choice(name='isa_v5', loop='spool')), sweep, 'closed', 0.005)
    # physics.md erratum 20: 104.0 Hz, less the hold of 5 kHz: a delay of 0.1 ms has no gain.
    # Interpolation over points a factor 1.19 apart: 0.17^2 / 8 of a slope that changes by about
    # its own size in an octave: 0.5 %
    assert got.bandwidth == pytest.approx(104.0, rel=0.01)


def test_a_blocked_torque_step_has_its_figures(torque):
    """physics.md section 4, table 4: 4 to 9 ms, steady error below 0.2 Nm."""
    got = step(torque, 0.5)
    assert got.figures.rise_time is not None and 4e-3 <= got.figures.rise_time <= 9e-3
    assert abs(got.figures.steady_error) < 0.2
    assert got.reference[got.t < 0.0].max() == 0.0 and got.reference[-1] == 17.0


@pytest.mark.parametrize(('arguments', 'expected'), [
    (['bode', 'isa_v5', '--from', '50', '--to', '20'], '--from = 50 Hz, must be < --to = 20 Hz'),
    (['bode', 'isa_v5', '--to', '4000'], '--to = 4000 Hz, must be <= 2000 Hz'),
    (['bode', 'isa_v5', '--points', '1'], '--points = 1, must be >= 2'),
    (['bode', 'isa_v5', '--loop', 'pressure'], 'the pressure loop is off; on: position, force'),
    (['bode', 'isa_v5', '--loop', 'current', '--of', 'plant'], '--of plant: the current loop'),
    (['bode', 'isa_v5', '--amplitude', '9000'], '--amplitude = 9000 N, must be <= 7500 N'),
    (['bode', 'isa_v5', '--preset', 'tabel_4'], 'did you mean table_4?'),
    (['bode', 'isa_v5', '--variant', 'x'], "--variant = 'x' is not a variant of isa_v5"),
    (['bode', 'isa_v5', '--load', 'bloked'], "--load.kind = 'bloked', must be one of"),
    (['bode', 'isa_v5', '--position', '120'], '--position = 120 mm, must be 0 to 100 mm'),
    (['bode', 'isa_v5', '--actuator', 'kfe'], '--actuator kfe is not used: isa_v5 is a model'),
    (['bode', 'isa_v5', '--out', 'x.txt'], '--out x.txt: must end in one of'),
    (['bode', 'leg.yaml'], 'several actuators, --actuator must name one: '),
    (['bode', 'leg.yaml', '--actuator', 'x'], "leg.yaml: no actuator 'x'; valid: "),
    (['bode', 'leg.yaml', '--preset', 'table_4'], '--preset is not used'),
    (['bode', 'isa_v9'], 'isa_v9: no such file; did you mean isa_v5 or isa_v2?'),
    (['step', 'isa_v5', '--duration', '1000'], '--duration = 1000 s, must be 0.01 to 100 s'),
])
def test_what_cannot_be_measured_is_one_line_and_2(arguments, expected, capsys):
    assert cli.main(arguments) == 2
    printed = capsys.readouterr()
    assert expected in printed.err and printed.err.count('\n') == 1
    assert printed.out == ''


@pytest.mark.parametrize(('arguments', 'expected'), [
    (['bode', 'isa_v5', '--loop', 'speed'], "invalid choice: 'speed'"),
    (['bode', 'isa_v5', '--amplitude', '-1'], "'-1' must be a number > 0"),
    (['bode', 'isa_v5', '--points', '2.5'], "'2.5' must be a whole number > 0"),
    (['step', 'isa_v5', '--position', 'mid'], "'mid' must be a number"),
    (['step'], 'the following arguments are required: MODEL|CONFIG')])
def test_wrong_usage_is_one_line_and_2(arguments, expected, capsys):
    with pytest.raises(SystemExit) as caught:
        cli.main(arguments)
    assert caught.value.code == 2
    printed = capsys.readouterr().err
    assert expected in printed and printed.count('\n') == 1


def test_the_command_prints_writes_and_draws_one_measurement(tmp_path: Path, capsys):
    numbers, figure = tmp_path / 'bode.json', tmp_path / 'bode.png'
    assert cli.main([
        'bode', 'rig_rotary', '--from', '20', '--to', '120', '--points', '6', '--position', '50',
        '--amplitude', '10', '--of', 'plant', '--json', str(numbers), '--out', str(figure)]) == 0
    printed = capsys.readouterr().out
    found = json.loads(numbers.read_text())
    assert 'rotor (smart_manifold, preset table_4), blocked at 50 deg' in printed
    assert 'torque: plant' in printed and 'stepped sine of 10 Nm' in printed
    assert f'{found["bandwidth_hz"]:.4g} Hz' in printed
    assert (found['amplitude'], found['unit'], found['response_unit']) == (10.0, 'Nm', 'Nm/mA')
    assert len(found['frequency_hz']) == len(found['coherence']) == 6
    ratios = np.array(found['output_amplitude']) / np.array(found['input_amplitude'])
    assert found['gain'] == pytest.approx(ratios, rel=1e-9)
    assert figure.read_bytes().startswith(b'\x89PNG')


def test_the_step_command_prints_writes_and_draws(tmp_path: Path, capsys):
    numbers, figure = tmp_path / 'step.json', tmp_path / 'step.svg'
    assert cli.main(['step', 'isa_v5', '--loop', 'spool', '--json', str(numbers),
                     '--out', str(figure)]) == 0
    found = json.loads(numbers.read_text())
    assert f'{found["rise_time_s"] * 1e3:.4g} ms' in capsys.readouterr().out
    assert found['output'][-1] == pytest.approx(found['amplitude'], rel=1e-6)
    assert b'<svg' in figure.read_bytes()


def test_a_position_loop_keeps_the_load_the_actuator_has():
    assert rig(Choice(name='rig_rotary', loop='position')).load == 'wheel'
    assert rig(Choice(name='isa_v5', loop='position')).load == 'mass'
    assert rig(Choice(name='leg.yaml', actuator='kfe', loop='position')).load == 'mass'
    assert rig(Choice(name='isa_v5', loop='spool')).load == 'blocked'


def test_a_pressure_loop_is_measured_like_the_others():
    """The ISA v5's force gains times an area close a loop of the pressure difference."""
    bench = rig(Choice(name='isa_v5', loop='force'))
    force, area = bench.config.sheet.reu.force, bench.config.sheet.plant.drive.areas[1]
    pressure = replace(force, kp=area * force.kp, ki=area * force.ki)
    sheet = replace(bench.config.sheet, reu=replace(
        bench.config.sheet.reu, pressure=pressure, force=Off()))
    loop = loop_of(sheet, 'pressure')
    config = replace(bench.config, sheet=loop.sheet)
    got = bode(Rig(replace(bench.run, actuators=(config,)), loop, 'blocked'),
               FrequencySweep(low=1.0, high=150.0, points=12), 'plant')
    assert loop.inward == 'spool_reference'
    assert got.response.coherence[0] > 0.99
    # at 1 Hz, a fiftieth of its bandwidth or less, the integral holds it: 1/50 of 1
    assert got.bandwidth is not None and got.bandwidth > 50.0
    assert got.first_gain == pytest.approx(1.0, abs=0.02)
    # oil integrates the spool's flow: between the valve's leakage, whose pole the phase of
    # -65 deg at 1 Hz puts at 0.5 Hz, and the valve's own lag (104 Hz) there is -90 deg, less
    # atan(0.5 / 4) = 7 and plus about 4 / 104 of 90 deg, twice for its second order = 7
    assert got.response.phase[3] == pytest.approx(-90.0, abs=7.0)


HUNTING = ('isa_v5', '--set', 'reu.force.kp=3e-7')
BAND = ('--from', '10', '--to', '150', '--points', '8')


def test_a_hunting_loop_has_no_margins(tmp_path: Path, capsys):
    """
    Damping fed back with four times the gain is a limit cycle of 12 % of the excitation.

    Under the excitation the response is coherent (0.97 and more) and has the margins of a stable
    loop, 6 dB and 75 deg: the cycle of 90 N at 184 Hz is in the damping of the block, which these
    margins count as part of the plant.
    """
    numbers, figure = tmp_path / 'bode.json', tmp_path / 'bode.svg'
    assert cli.main([
        'bode', *HUNTING, *BAND, '--json', str(numbers), '--out', str(figure)]) == 1
    printed, found = capsys.readouterr().out, json.loads(numbers.read_text())
    assert 'the loop hunts: at rest it oscillates by ' in printed
    assert 'margin: ' not in printed and '-3 dB: ' not in printed
    assert found['hunts'] and min(found['coherence']) > 0.95
    results = ('bandwidth_hz', 'gain_margin_db', 'phase_margin_deg')
    assert [found[name] for name in results] == [None, None, None]
    assert found['ripple'] > 0.05 * found['amplitude']
    assert f'{found["ripple"]:.3g} N at {found["ripple_hz"]:.4g} Hz' in printed
    assert 'the loop hunts: ' in figure.read_text()


def test_the_ripple_is_that_of_the_step(capsys):
    """The same loop at the same place: a sine has sqrt(2) of its deviation as amplitude."""
    hunting = rig(Choice(name='isa_v5', loop='force', values={'reu.force.kp': 3e-7}))
    rest = bode(hunting, FrequencySweep(low=10.0, high=150.0, points=2), 'closed').rest
    # half of peak to peak against the deviation of a cycle with harmonics
    assert rest.ripple == pytest.approx(np.sqrt(2.0) * step(hunting, 0.5).figures.ripple, rel=0.1)


def test_a_quiet_loop_states_its_ripple(capsys):
    assert cli.main(['bode', 'isa_v5', *BAND]) == 0
    printed = capsys.readouterr().out
    assert 'open loop, phase margin: ' in printed and 'at rest, ripple: ' in printed
    assert 'hunts' not in printed


def test_a_frequency_without_coherence_is_marked_and_left_out(capsys):
    """A pressure difference of 2 MPa under ten times the gains: a limit cycle, not a response."""
    bench = rig(Choice(name='isa_v5', loop='pressure', variants=('pressure_control',)))
    reu = bench.config.sheet.reu
    wild = replace(reu, pressure=replace(
        reu.pressure, kp=10.0 * reu.pressure.kp, ki=10.0 * reu.pressure.ki))
    hunting = bench.with_config(
        replace(bench.config, sheet=replace(bench.config.sheet, reu=wild)))
    sweep = FrequencySweep(low=20.0, high=60.0, points=4)
    lost = bode(hunting, sweep, 'closed', 0.2)
    assert not lost.response.is_trusted.any() and lost.bandwidth is None
    *rows, ripple, warning = table(lost).splitlines()
    assert all(row.endswith('!') for row in rows[1:]) and 'coherence falls to' in warning
    assert 'coherence falls to' not in '\n'.join(conclusions(bode(bench, sweep, 'closed', 2.0)))


def test_a_step_that_is_not_followed_is_said_so():
    """Torque against a free mass cannot be held, since the mass yields."""
    stopped = step(rig(Choice(name='smart_manifold', loop='force')), 0.3, 17.0)
    assert 'does not follow' not in summary(stopped) and stopped.follows
    lost = step(rig(Choice(name='isa_v5', loop='force', load='mass')), 0.06, 7000.0)
    assert 'does not follow' in summary(lost) and not lost.follows and not lost.hunts


def test_a_command_whose_step_is_not_followed_answers_no(capsys):
    """One that hunts: its ripple is larger than half of the step."""
    sound = ['step', 'isa_v5', '--loop', 'force']
    assert cli.main([*sound, '--set', 'reu.force.kp=8e-7']) == 1
    assert 'the loop does not follow' in capsys.readouterr().out
    assert cli.main(sound) == 0


def test_a_valve_with_hysteresis_is_told_beside_its_response(measured):
    """The gain of a play depends on the amplitude; without one nothing is said."""
    sheet = measured.loop.sheet
    valve = replace(sheet.plant.valve, hysteresis_percent=3.0)
    worn = replace(measured, loop=replace(measured.loop, sheet=replace(
        sheet, plant=replace(sheet.plant, valve=valve))))
    assert 'hysteresis' not in '\n'.join(conclusions(measured))
    assert conclusions(worn)[-1].startswith(
        'the valve has 3 % hysteresis: gain and phase are those of this amplitude')
