"""`isa bode --bag`: the response of a loop from a recorded sweep of its reference."""

import json
from pathlib import Path

import isa_ros
from isa_ros.cli import main as cli
from isa_ros.config.paths import find, SCENARIOS
from isa_ros.config.text.yaml_text import read
import numpy as np
import pytest

BAND = ('--from', '10', '--to', '120', '--points', '5')
HOLD_S = 1e-3           # a setpoint is held for a tick
INTO_HOLD_S = 0.30e-3   # from the middle of the hold, 0.12 + 0.5 ms, to the conversion at 0.92
BARE_S = 0.1e-3         # half a period of the force block, in the bare measurement


@pytest.fixture(scope='module')
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the bag of the sweep of the torque that is shipped, and of a second at rest."""
    scenario = {**read(find('torque_bandwidth', SCENARIOS)), 'duration_s': 9.2}
    scenario['tracks']['rotor'].append({'t_s': 8.2, 'position': 'hold', 'effort': 0.0})
    path = tmp_path_factory.mktemp('sweep') / 'bag'
    isa_ros.load('rig_rotary', scenario=scenario).simulate().save(path)
    return path


def numbers(path: Path, *arguments: str) -> dict:
    """Return the numbers of a command."""
    assert cli.main([*arguments, '--json', str(path)]) == 0
    return json.loads(path.read_text())


@pytest.fixture(scope='module')
def found(bag: Path, tmp_path_factory: pytest.TempPathFactory) -> dict:
    """Return the response that the bag has."""
    return numbers(tmp_path_factory.mktemp('found') / 'bag.json', 'bode', '--bag', str(bag), *BAND)


def test_a_bag_gives_the_response_in_memory_behind_a_hold(found: dict, tmp_path: Path):
    """The same chirp of the bare actuator; the bag's segments and frequencies are its own."""
    bare = numbers(tmp_path / 'bare.json', 'bode', 'rig_rotary', '--load', 'blocked', *BAND,
                   '--method', 'chirp')
    f = np.array(bare['frequency_hz'])
    assert found['frequency_hz'] == pytest.approx(f, rel=1e-12)
    assert found['amplitude'] == pytest.approx(bare['amplitude'], rel=1e-3)
    # Remaining: the samples' own quantisation and the images of the hold at 1 kHz - f, which
    # a loop 30 dB down there passes into the samples: 1 % of the gain; a deg for the same.
    assert np.array(found['gain']) / bare['gain'] == pytest.approx(np.sinc(f * HOLD_S), rel=0.01)
    later = 360.0 * f * (INTO_HOLD_S + BARE_S)
    assert np.array(found['phase_deg']) - bare['phase_deg'] == pytest.approx(later, abs=1.5)
    assert min(found['coherence']) > 0.99
    assert found['bandwidth_hz'] == pytest.approx(bare['bandwidth_hz'], rel=0.02)


def test_the_end_of_a_bag_says_whether_the_loop_hunts(found: dict):
    """A second at rest is recorded; 2 % of the amplitude is the bound."""
    assert found['hunts'] is False and found['ripple'] < 0.02 * found['amplitude']


def test_without_a_rest_the_ripple_is_unknown(tmp_path: Path, capsys):
    """As the shipped scenario ends."""
    path = tmp_path / 'bag'
    isa_ros.load('rig_rotary', scenario='torque_bandwidth').simulate().save(path)
    assert numbers(tmp_path / 'a.json', 'bode', '--bag', str(path), *BAND)['hunts'] is None
    assert 'at rest: not recorded, so that the loop may hunt' in capsys.readouterr().out


@pytest.mark.parametrize(('arguments', 'expected'), [
    (['--to', '450'], 'must be <= 400 Hz: the bag has ticks at 1000 Hz'),
    (['--from', '1'], 's of a chirp in segments of 4 s, must hold at least 3 segments'),
    (['--loop', 'pressure'], 'the pressure loop is off'),
    (['--actuator', 'kfe'], 'kfe'),
    (['isa_v5'], 'isa_v5 cannot be chosen, it is as recorded'),
    (['--set', 'reu.force.kp=1e-8', '--load', 'wheel'], '--set, --load cannot be chosen')])
def test_what_a_bag_does_not_have_is_one_line(bag: Path, arguments, expected, capsys):
    assert cli.main(['bode', '--bag', str(bag), *arguments]) == 2
    printed = capsys.readouterr()
    assert expected in printed.err and printed.err.count('\n') == 1
    assert printed.out == ''


def test_a_reference_that_stands_still_is_refused(tmp_path: Path, capsys):
    """One step is not a sweep."""
    isa_ros.load('rig_rotary').simulate(duration=0.1).save(tmp_path / 'bag')
    assert cli.main(['bode', '--bag', str(tmp_path / 'bag')]) == 2
    assert 'rotor.force_reference must change' in capsys.readouterr().err


def test_a_model_or_a_bag_is_needed(capsys):
    assert cli.main(['bode']) == 2
    assert 'MODEL|CONFIG is missing; isa bode takes --bag BAG' in capsys.readouterr().err
