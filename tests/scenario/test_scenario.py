"""Scenarios: rows of commands by tick, replaced loads and starts, and refusals."""

import math
from pathlib import Path

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.signals import COMMAND, HAS_ENABLE, HAS_SETPOINT
from isa_ros.errors import ConfigError
from isa_ros.loads.sheets import Blocked
from isa_ros.scenario.scenario import idle, load_scenario, Scenario, scenario_of
import numpy as np
import pytest

CONFIG = Path(__file__).parents[2] / 'config'
DROP = CONFIG / 'scenarios' / 'drop.yaml'
STEP = CONFIG / 'scenarios' / 'step.yaml'
TROT = CONFIG / 'scenarios' / 'trot.yaml'
TROT_LEG = CONFIG / 'scenarios' / 'trot_leg.yaml'


def rows(scenario: Scenario, tick: int) -> np.ndarray:
    """Return the commands of a tick, written over rows without new commands."""
    out = np.full(len(scenario.run.actuators), 7, COMMAND)
    out['kinds'] = 0
    scenario.commands(tick, out)
    return out


def of_track(text: str, run: RunConfig) -> Scenario:
    """Return a scenario of 1 s with these setpoints for the rotor."""
    return scenario_of(f'name: s\nduration_s: 1\ntracks:\n  rotor:\n{text}', run)


def test_the_drop_holds_the_leg_10_cm_above_the_ground(leg: RunConfig) -> None:
    """The issue's scenario: 10 cm, 1e5 N/m and 4000 Ns/m on the knee."""
    drop = load_scenario(DROP, leg)
    assert drop.run.leg is not None and leg.leg is not None
    assert drop.run.leg.start.foot_height_mm == 100.0 and drop.run.leg.start.release_s == 0.1
    assert drop.run.leg.start.kfe_deg == leg.leg.start.kfe_deg
    knee = rows(drop, 0)[drop.run.index('kfe')]
    assert knee['kinds'] == HAS_SETPOINT
    assert (knee['stiffness'], knee['damping']) == (1e5, 4000.0)
    assert knee['position'] == drop.run.actuator('kfe').initial_position


def test_a_gain_that_is_not_given_is_kept(leg: RunConfig) -> None:
    """`signals.COMMAND`: NaN keeps the gain in force."""
    row = rows(load_scenario(DROP, leg), 0)[0]
    assert math.isnan(row['stiffness']) and math.isnan(row['damping'])
    assert row['velocity'] == row['effort'] == 0.0


def test_the_step_blocks_the_wheel_and_asks_for_17_nm(rotary: RunConfig) -> None:
    step = load_scenario(STEP, rotary)
    assert isinstance(step.run.actuators[0].load, Blocked)
    assert not isinstance(rotary.actuators[0].load, Blocked)
    before, at, after = (rows(step, tick)[0] for tick in (99, 100, 101))
    assert before['kinds'] == after['kinds'] == 0
    assert at['kinds'] == HAS_SETPOINT and at['effort'] == 17.0
    assert rows(step, 0)[0]['stiffness'] == 0.0


@pytest.mark.parametrize('path', [DROP, STEP, TROT, TROT_LEG], ids=lambda path: path.stem)
def test_a_scenario_survives_its_text(path: Path, leg: RunConfig, rotary: RunConfig) -> None:
    """The text is stored in the bag: it must give every row of every tick bit for bit."""
    scenario = load_scenario(path, leg if path in (DROP, TROT_LEG) else rotary)
    again = scenario_of(scenario.to_yaml(), scenario.run)
    assert again == scenario and again.n_ticks is not None
    for tick in range(again.n_ticks):
        assert rows(again, tick).tobytes() == rows(scenario, tick).tobytes()


def test_a_sine_speaks_every_tick_until_the_next_setpoint(rotary: RunConfig) -> None:
    """Position x0 + A sin(w t) and its derivative A w cos(w t), t from its own setpoint."""
    scenario = of_track(
        '  - {t_s: 0.1, position: 0.8, enabled: true,\n'
        '     sine: {amplitude: 0.35, frequency_hz: 1.7}}\n'
        '  - {t_s: 0.5, position: 0.8}\n', rotary)
    assert rows(scenario, 99)[0]['kinds'] == 0
    assert rows(scenario, 100)[0]['kinds'] == HAS_SETPOINT | HAS_ENABLE
    omega = 2.0 * math.pi * 1.7
    for tick in (101, 250, 499):
        row, t = rows(scenario, tick)[0], (tick - 100) * 1e-3
        assert row['kinds'] == HAS_SETPOINT
        # A phase of some radians computed in another order: a few units of 2.2e-16.
        assert row['position'] == pytest.approx(0.8 + 0.35 * math.sin(omega * t), abs=1e-14)
        assert row['velocity'] == pytest.approx(0.35 * omega * math.cos(omega * t), abs=1e-13)
    assert rows(scenario, 500)[0]['velocity'] == 0.0
    assert rows(scenario, 501)[0]['kinds'] == 0


@pytest.mark.parametrize('text', [
    'chirp: {amplitude: 0.1, start_hz: 1, end_hz: 50, duration_s: 0.3, sweep: linear}',
    'chirp: {moves: effort, amplitude: 17, start_hz: 50, end_hz: 1, duration_s: 0.3, '
    'sweep: exponential}',
    'pulse: {moves: effort, amplitude: 17.0, period_s: 0.1, width_s: 0.03}',
    'gait: {joint: hfe}',
])
def test_a_motion_survives_its_text(text: str, rotary: RunConfig) -> None:
    """Missing keys are written out; every row is reproduced bit for bit."""
    scenario = of_track(f'  - {{t_s: 0.1, position: 0.8, {text}}}\n', rotary)
    again = scenario_of(scenario.to_yaml(), scenario.run)
    assert again == scenario
    for tick in range(1000):
        assert rows(again, tick).tobytes() == rows(scenario, tick).tobytes()


def test_a_motion_is_added_to_its_setpoint(rotary: RunConfig) -> None:
    scenario = of_track(
        '  - {t_s: 0.1, position: 0.8, velocity: 0.1, effort: -3,\n'
        '     pulse: {moves: effort, amplitude: 17, period_s: 0.1, width_s: 0.03}}\n', rotary)
    up, down = rows(scenario, 100)[0], rows(scenario, 130)[0]
    assert (up['position'], up['velocity'], up['effort']) == (0.8, 0.1, 14.0)
    assert (down['position'], down['velocity'], down['effort']) == (0.8, 0.1, -3.0)


def test_enabling_alone_is_no_setpoint(rotary: RunConfig) -> None:
    row = rows(of_track('  - {t_s: 0.002, enabled: false}\n', rotary), 2)[0]
    assert row['kinds'] == HAS_ENABLE and row['is_enabled'] == 0


@pytest.mark.parametrize('text, expected', [
    ('  - {position: 0.8}\n', 'tracks.rotor[0] lacks t_s'),
    ('  - {t_s: 0.0005, position: 0.8}\n',
     't_s = 0.0005 s, must be a multiple of step_ms = 1 ms'),
    ('  - {t_s: 1.0, position: 0.8}\n', 't_s = 1 s, must be < duration_s = 1 s'),
    ('  - {t_s: 0.2, position: 0.8}\n  - {t_s: 0.2, position: 0.9}\n',
     'tracks.rotor[1].t_s = 0.2 s, must be > the one before it, 0.2 s'),
    ('  - {t_s: 0, position: .nan}\n', 'rotor[0].position = nan rad, must be finite'),
    ('  - {t_s: 0, position: 0.8, effort: .inf}\n', 'effort = inf Nm, must be finite'),
    ('  - {t_s: 0, position: held}\n', "position = 'held', must be a number in rad, or hold"),
    ('  - {t_s: 0, position: 50}\n', 'position = 50 rad, must be 0 to 1.745 rad, the stroke'),
    ('  - {t_s: 0, position_deg: 50}\n', 'position_deg is unknown; the key is position, in SI'),
    ('  - {t_s: 0, position: 0.8, stiffness: -1}\n', 'stiffness = -1 Nm/rad, must be >= 0'),
    ('  - {t_s: 0, position: 0.8, enabled: 1}\n', 'enabled = 1, must be true or false'),
    ('  - {t_s: 0, effort: 3.0}\n',
     "rotor[0].effort is not enough: mode impedance needs the position (or 'hold')"),
    ('  - {t_s: 0, mode: force, velocity: 3.0}\n',
     'rotor[0].velocity is not enough: mode force needs the effort'),
    ('  - {t_s: 0, mode: force, position: 0.8}\n',
     'rotor[0].position is not enough: mode force needs the effort'),
    ('  - {t_s: 0, mode: force}\n  - {t_s: 0.1, position: 0.8}\n',
     'rotor[1].position is not enough: mode force needs the effort'),
    ('  - {t_s: 0, mode: current, position: 0.8}\n',
     'rotor[0].position is not enough: mode current needs the current, or the effort'),
    ('  - {t_s: 0, mode: force, sine: {moves: effort, amplitude: 1, frequency_hz: 1}}\n',
     'rotor[0].sine is not enough: mode force needs the effort'),
    ('  - {t_s: 0, mode: force, effort: 1, sine: {amplitude: 1, frequency_hz: 1}}\n',
     'rotor[0].sine is not used: it moves the position, which the setpoint does not have'),
    ('  - {t_s: 0, mode: force, effort: 1, gait: {joint: hfe}}\n',
     'rotor[0].gait is not used: it moves the position, which the setpoint does not have'),
    ('  - {t_s: 0, stiffness: 1.0e+8}\n', 'rotor[0].stiffness = 1e+08 Nm/rad, must be 0 to '),
    ('  - {t_s: 0}\n', 'rotor[0] needs a setpoint, or a key of the device'),
    ('  - {t_s: 0, position: 0.8, stifness: 3}\n', 'stifness is unknown; did you mean stiffness'),
    ('  - {t_s: 0, position: 0.8, sine: {amplitude: 1, frequency_hz: 0}}\n',
     'sine.frequency_hz = 0 Hz, must be > 0 Hz'),
    ('  - {t_s: 0, position: 0.8, sine: {amplitude: 1, frequency_hz: 501}}\n',
     'rotor[0].sine.frequency_hz = 501 Hz, must be <= 500 Hz, half the rate of step_ms = 1 ms'),
    ('  - {t_s: 0, position: 0.8, sine: {amplitude: 17, frequency_hz: 1}}\n',
     'rotor[0].sine.amplitude = 17 rad, must be <= 10 rad (of the position)'),
    ('  - {t_s: 0, position: 0.8, sine: {moves: speed, amplitude: 1, frequency_hz: 1}}\n',
     "rotor[0].sine.moves = 'speed', must be one of position, effort"),
    ('  - {t_s: 0, position: 0.8, chirp: {amplitude: 1, start_hz: 1, end_hz: 600, '
     'duration_s: 1, sweep: linear}}\n', 'rotor[0].chirp.end_hz = 600 Hz, must be <= 500 Hz'),
    ('  - {t_s: 0, position: 0.8, chirp: {amplitude: 1, start_hz: 1, end_hz: 9}}\n',
     'rotor[0].chirp lacks duration_s'),
    ('  - {t_s: 0, position: 0.8, pulse: {amplitude: 1, period_s: 0.1, width_s: 0.0305}}\n',
     'rotor[0].pulse.width_s = 0.0305 s, must be a multiple of step_ms = 1 ms'),
    ('  - {t_s: 0, position: 0.8, sine: {amplitude: 1, frequency_hz: 1}, gait: {joint: hfe}}\n',
     'rotor[0] has sine and gait, must be one motion'),
    ('  - {t_s: 0, enabled: true, gait: {joint: hfe}}\n',
     "gait is not enough: mode impedance needs the position (or 'hold')"),
    ('  - {t_s: 0, position: 0.8, gait: {joint: hip}}\n',
     "rotor[0].gait.joint = 'hip', must be one of haa, hfe, kfe"),
    ('  - {t_s: 0, position: 0.8, gait: {joint: hfe, forward_speed: 2}}\n',
     'rotor[0].gait: forward_speed = 2 m/s at step_frequency_hz = 1.7 Hz moves hfe from -8.34'),
    ('  - {t_s: 0, position: 0.2, gait: {joint: hfe}}\n',
     'rotor[0].gait moves rotor from -0.1509 to 0.5509 rad, must stay within its 0 to 1.745 rad'),
    ('  - 3\n', 'tracks.rotor[0] = 3, must be a section'),
    ('    {}\n', 'tracks.rotor = {}, must be a list of setpoints'),
])
def test_a_wrong_setpoint_is_refused_by_file_and_key(
        text: str, expected: str, rotary: RunConfig) -> None:
    with pytest.raises(ConfigError) as caught:
        of_track(text, rotary)
    assert expected in str(caught.value)
    assert str(caught.value).startswith('scenario.yaml: ')
    assert '\n' not in str(caught.value)


@pytest.mark.parametrize('text, expected', [
    ('tracks: {motor: [{t_s: 0, position: 0}]}', 'tracks.motor is unknown: .* valid: rotor'),
    ('loads: {motor: {kind: blocked}}', 'loads.motor is unknown: .* valid: rotor'),
    ('loads: {rotor: {kind: rope}}', "loads.rotor.kind = 'rope', must be one of"),
    ('loads: {rotor: {kind: wheel, inertia: -1}}', 'loads.rotor.inertia = -1 kg'),
    ('leg: {release_s: 0.1}', 'leg is not used: rig_rotary.yaml has no leg'),
    ('track: {}', 'track is unknown; did you mean tracks'),
])
def test_a_scenario_for_another_rig_is_refused(
        text: str, expected: str, rotary: RunConfig) -> None:
    with pytest.raises(ConfigError, match=expected):
        scenario_of(f'name: s\nduration_s: 1\n{text}\n', rotary)


@pytest.mark.parametrize('text, expected', [
    ('loads: {kfe: {kind: blocked}}', 'loads.kfe is not used: the load of kfe is the leg'),
    ('leg: {kfe_deg: -20}', 'leg.kfe_deg = -20 deg, must be within its range'),
    ('leg: {release_s: 0.0001}', 'leg.release_s = 0.0001 s, must be a multiple of step_ms'),
    ('leg: {foot_height: 0.1}', 'leg.foot_height is unknown; the key is foot_height_mm'),
])
def test_a_start_the_leg_cannot_take_is_refused(text: str, expected: str, leg: RunConfig) -> None:
    with pytest.raises(ConfigError, match=expected):
        scenario_of(f'name: s\nduration_s: 1\n{text}\n', leg)


@pytest.mark.parametrize('duration, expected', [
    (1e-9, 'duration = 1e-09 s, must be >= step_ms = 1 ms'),
    (0.0, 'must be > 0 s'), (1e7, 'must be <= 1e'), (0.0005, 'must be a multiple of step_ms'),
    (math.nan, 'must be finite'),
])
def test_a_wrong_duration_is_refused(duration: float, expected: str, rotary: RunConfig) -> None:
    with pytest.raises(ConfigError, match=expected):
        idle(rotary, duration)


def test_what_a_controller_asks_for_stays_where_the_scenario_is_silent(rotary):
    """Enabling alone does not change the setpoint."""
    scenario = of_track('    - {t_s: 0.0, enabled: true}', rotary)
    out = np.zeros(1, COMMAND)
    out['kinds'], out['position'] = HAS_SETPOINT, 0.25
    scenario.commands(0, out)
    assert out['kinds'][0] == HAS_SETPOINT | HAS_ENABLE
    assert out['position'][0] == 0.25
    scenario.commands(1, out)
    assert out['position'][0] == 0.25


def test_an_idle_scenario_commands_nothing(rotary: RunConfig) -> None:
    scenario = idle(rotary)
    assert scenario.n_ticks is None and scenario.duration_s is None
    assert rows(scenario, 0)[0]['kinds'] == 0
    assert idle(rotary, 0.25).n_ticks == 250


def test_a_scenario_may_name_the_figure_it_is_drawn_as(rotary: RunConfig) -> None:
    """The figure is kept in the text stored in a bag."""
    scenario = scenario_of('name: s\nfigure: torque_step\nduration_s: 1\n', rotary)
    assert scenario.figure == 'torque_step'
    assert scenario_of(scenario.to_yaml(), rotary).figure == 'torque_step'


@pytest.mark.parametrize('text, expected', [
    ('torqe_step', 'did you mean torque_step'), ('bode', 'valid: position_torque_tracking'),
    ('7', 'figure = 7 is not a figure'), ('[a]', 'is not a figure')])
def test_an_unknown_figure_is_refused(text: str, expected: str, rotary: RunConfig) -> None:
    with pytest.raises(ConfigError, match=expected):
        scenario_of(f'name: s\nfigure: {text}\nduration_s: 1\n', rotary)


def test_a_shortened_scenario_has_what_begins_before_its_end(rotary):
    """As it is stored with the bag, where its file is read again."""
    whole = of_track('  - {t_s: 0.1, position: 0.8}\n  - {t_s: 0.5, position: 0.9}\n', rotary)
    whole = whole.with_faults([
        {'t_s': 0.2, 'actuator': 'rotor', 'fault': 'valve_stuck', 'until_s': 0.9},
        {'t_s': 0.6, 'supply': 'supply', 'set': {'pressure_mpa': 10.0}}])
    half = whole.lasting(0.5)
    assert [event.tick for event in half.tracks[0].events] == [100]
    assert [fault.tick for fault in half.faults] == [200]
    assert scenario_of(half.to_yaml(), rotary) == half
    assert whole.lasting(0.1).tracks == ()
    assert scenario_of(whole.lasting(0.1).to_yaml(), rotary) == whole.lasting(0.1)


def test_a_refused_fault_is_called_by_its_place_in_the_given_list(rotary):
    """Not by that in a list which the faults of the file precede."""
    whole = of_track('  - {t_s: 0.1, position: 0.8}\n', rotary).with_faults(
        [{'t_s': 0.6, 'supply': 'supply', 'set': {'pressure_mpa': 10.0}}])
    late = {'t_s': 0.2, 'actuator': 'rotor', 'fault': 'valve_stuck'}
    assert [fault.tick for fault in whole.lasting(0.3).with_faults([late]).faults] == [200]
    with pytest.raises(ConfigError) as refused:
        whole.lasting(0.2).with_faults([late])
    assert str(refused.value) == (
        'the given faults: faults[0].t_s = 0.2 s, must be < duration_s = 0.2 s')
