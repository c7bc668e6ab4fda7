"""Setpoints of a scenario beyond stroke, rating or usable gains: refused, limited, accepted."""

from dataclasses import replace

from isa_ros.config.runs.run_config import RunConfig
from isa_ros.core.signals import COMMAND
from isa_ros.errors import ConfigError
from isa_ros.scenario.scenario import Scenario, scenario_of
import numpy as np
import pytest
from tests.runs import hip_and_knee

HEAD = 'name: test\nduration_s: 2.0\n{}tracks:\n  knee:\n'
RUN = hip_and_knee()
STROKE, RATED = 0.1, 7500.0     # of the ISA v5
SINE = 'sine: {amplitude: 0.06, frequency_hz: 0.25}'
QUARTER = f'  - {{t_s: 0.5, position: 0.05, {SINE}}}\n'
BEYOND = [
    ('  - {t_s: 0, position: 50.0}\n',
     'scenario.yaml: tracks.knee[0].position = 50 m, must be 0 to 0.1 m, the stroke; '
     'beyond_range: accept of the scenario takes it as it is, limit of the actuator limits it'),
    ('  - {t_s: 0, position: 0.05}\n  - {t_s: 1, position: 0.05, effort: 7501}\n',
     'tracks.knee[1].effort = 7501 N, must be -5174 to 7500 N, the rated force; '),
    ('  - {t_s: 0, position: 0.05, stiffness: 1.0e+8}\n',
     'tracks.knee[0].stiffness = 1e+08 N/m, must be 0 to 5e+07 N/m, the usable gains; '),
    # 0.05 + 0.06 sin(pi/2 (t - 0.5)) is past 0.1 m from t = 0.5 + 2/pi asin(5/6) = 1.1271 on
    (QUARTER + '  - {t_s: 1.5, position: 0.1}\n',
     'tracks.knee[0].sine: position = 0.100045 m at t = 1.128 s, must be 0 to 0.1 m, the str'),
    (QUARTER, 'tracks.knee[0].sine: position = -0.01 m, must be 0 to 0.1 m, the stroke; '),
    ('  - {t_s: 0, position: 0.05, effort: 100, pulse: {moves: effort, amplitude: 7500, '
     'period_s: 0.1, width_s: 0.01}}\n',
     'tracks.knee[0].pulse: effort = 7600 N, must be -5174 to 7500 N, the rated force; '),
    # 0.03 x 2 pi 20 Hz, in one direction or the other first
    ('  - {t_s: 0, position: 0.05, sine: {amplitude: 0.03, frequency_hz: 20.0}}\n',
     'tracks.knee[0].sine: velocity = -3.76991 m/s, must be -1.66859 to 1.66859 m/s, the sp'),
    ('  - {t_s: 0, position: 0.05, velocity: 0.1, ramp: {amplitude: 0.03, duration_s: 0.01}}\n',
     'tracks.knee[0].ramp: velocity = 3.1 m/s, must be -1.66859 to 1.66859 m/s, the speed')]


def read(tracks: str, run: RunConfig = RUN, more: str = '') -> Scenario:
    return scenario_of(HEAD.format(more) + tracks, run)


def limiting() -> RunConfig:
    """Return the run with actuators that limit."""
    return replace(RUN, actuators=tuple(
        replace(own, beyond_range='limit') for own in RUN.actuators))


def knee(scenario: Scenario, tick: int) -> np.void:
    rows = np.zeros(len(RUN.actuators), COMMAND)
    scenario.commands(tick, rows)
    return rows[1]


@pytest.mark.parametrize(('tracks', 'message'), BEYOND)
def test_it_is_refused_by_file_key_value_and_bound(tracks: str, message: str) -> None:
    with pytest.raises(ConfigError) as caught:
        read(tracks)
    assert message in str(caught.value) and '\n' not in str(caught.value)


@pytest.mark.parametrize(('tracks', 'message'), BEYOND)
def test_it_is_limited_where_configured_and_the_scenario_says_so(
        tracks: str, message: str) -> None:
    """At every tick; its text, which the bag has, gives the same rows."""
    scenario = read(tracks, limiting())
    line, = scenario.limited
    key_and_value = message.removeprefix('scenario.yaml: ').partition(', must')[0]
    assert f'scenario.yaml: {key_and_value}, limited to ' in line
    again = scenario_of(scenario.to_yaml(), limiting())
    for tick in range(2000):
        row = knee(scenario, tick)
        assert 0.0 <= row['position'] <= STROKE and row['effort'] <= RATED
        assert not row['stiffness'] > 5e7 and abs(row['velocity']) < 1.6686
        assert row.tobytes() == knee(again, tick).tobytes()


@pytest.mark.parametrize('tracks', [
    QUARTER.replace('0.06', '0.05'),
    QUARTER.replace('0.25', '0.125') + '  - {t_s: 0.9, position: 0.1}\n',
    '  - {t_s: 0, position: 0.0, effort: -5174}\n  - {t_s: 1, position: 0.1, effort: 7500}\n'])
def test_what_stays_within_is_taken_as_it_is(tracks: str) -> None:
    """The ends of the range, and a motion that another setpoint ends before it leaves it."""
    scenario, refusing = read(tracks, limiting()), read(tracks)
    assert not scenario.limited
    for tick in range(2000):
        assert knee(scenario, tick).tobytes() == knee(refusing, tick).tobytes()


def test_a_scenario_that_accepts_says_it_in_its_text() -> None:
    """For an impedance that presses against a stop; not further than a stroke, likely a unit."""
    accept = 'beyond_range: accept\n'
    scenario = read('  - {t_s: 0, position: -0.01}\n', more=accept)
    assert knee(scenario, 0)['position'] == -0.01 and not scenario.limited
    assert scenario_of(scenario.to_yaml(), RUN) == scenario
    with pytest.raises(ConfigError, match=r'knee\[0\].position = -50 m, must be >= -0.1 m'):
        read('  - {t_s: 0, position: -50}\n', more=accept)
    with pytest.raises(ConfigError, match="beyond_range = 'limit', must be one of accept"):
        read('  - {t_s: 0, position: 0.0}\n', more='beyond_range: limit\n')


def test_a_motion_ends_before_the_tick_of_the_next_setpoint() -> None:
    """It passes 0.1 m after t = 1.1271 s: at 1.128 s, which is the next one's first tick."""
    scenario = read(QUARTER + '  - {t_s: 1.128, position: 0.1}\n')
    assert knee(scenario, 1127)['position'] <= STROKE
    with pytest.raises(ConfigError, match='at t = 1.128 s'):
        read(QUARTER + '  - {t_s: 1.129, position: 0.1}\n')


def test_an_equilibrium_may_be_a_stroke_beyond_either_end() -> None:
    accept = 'beyond_range: accept\n'
    for position in (-0.1, 0.15, 0.2):
        tracks = f'  - {{t_s: 0, position: {position}}}\n'
        assert knee(read(tracks, more=accept), 0)['position'] == position
    with pytest.raises(ConfigError, match=r'position = 0.201 m, must be <= 0.2 m'):
        read('  - {t_s: 0, position: 0.201}\n', more=accept)
