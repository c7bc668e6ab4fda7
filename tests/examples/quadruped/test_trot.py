"""The quadruped stands, squats, is pushed and trots, on twelve hydraulic actuators."""

import isa_ros
from isa_ros.analysis.signals.recorded_result import read
from isa_ros.bag.reader import Bag
from isa_ros.errors import ConfigError
from isa_ros.examples.quadruped.trot import Trot
from isa_ros.replay.replay import replay
import numpy as np
import pytest

TROT = 'scenario.controllers.trot.program'
SHORT = [{'t_s': 0.0, 'height': 0.56}, {'t_s': 0.1, 'steps': 1}, {'t_s': 0.2},
         {'t_s': 0.6, 'speed': 0.5}]
PUSH = {'t_s': 1.2, 'body': 'body', 'set': {'push_y': 1076.0}, 'until_s': 1.25}


def roll(result) -> np.ndarray:
    """Return the roll of the trunk, rad."""
    w, x, y, z = result['body.orientation'].T
    return np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))


@pytest.fixture(scope='module')
def trotted():
    """Return a result of 1.8 s: on the spot, then to 0.5 m/s, and a push of 54 Ns."""
    run = isa_ros.load('quadruped', 'quadruped_trot', duration=1.8, changes={
        TROT: SHORT, 'scenario.changes': [PUSH]})
    return run.simulate()


def test_it_trots_and_takes_a_jolt(trotted):
    place, speed = trotted['body.position'], trotted['body.velocity']
    assert place[:, 2].min() > 0.45
    assert np.abs(roll(trotted)).max() < 0.3
    late = trotted.time > 1.0
    mean = (place[-1, 0] - place[late][0, 0]) / (trotted.time[-1] - trotted.time[late][0])
    assert mean == pytest.approx(0.5, rel=0.15)
    during = (trotted.time > 1.2) & (trotted.time < 1.3)
    assert speed[during, 1].max() > 0.3     # 54 Ns on 108 kg
    assert abs(speed[-1, 1]) < 0.5 * speed[during, 1].max()


def test_diagonal_feet_step_together(trotted):
    feet = [trotted[f'body.{leg}_foot_touches'] > 0.0 for leg in ('lf', 'rf', 'lh', 'rh')]
    stepping = (trotted.time > 0.5) & (trotted.time < 1.2)
    for first, second in ((0, 3), (1, 2)):
        assert np.mean(feet[first][stepping] == feet[second][stepping]) > 0.9
    assert np.mean(feet[0][stepping]) == pytest.approx(0.55, abs=0.1)


def test_energy_closes_over_trunk_and_ground(trotted):
    """What actuators and the push do is in motion, height and ground, to 1e-6 of it all."""
    kinetic, potential, elastic, lost, drives, push = (
        trotted[f'body.{name}'] for name in (
            'kinetic_energy', 'potential_energy', 'elastic_energy', 'ground_loss', 'drive_work',
            'push_work'))
    rest = kinetic + potential + elastic + lost - drives - push
    throughput = lost[-1] + np.abs(np.diff(drives)).sum()
    assert push[-1] > 10.0
    # RK4 at 0.2 ms through the contacts' beginnings and ends.
    assert np.abs(rest - rest[0]).max() < 1e-6 * throughput


def test_it_is_read_and_replayed_from_the_bag(tmp_path):
    """The push is an input of the replay, the controller is not called."""
    result = isa_ros.load('quadruped', 'quadruped_trot', duration=0.2, changes={
        TROT: SHORT, 'scenario.changes': [{**PUSH, 't_s': 0.12, 'until_s': 0.17}]}).simulate()
    bag = result.save(tmp_path / 'bag')
    assert result['body.push_work'][-1] > 1.0
    assert replay(Bag(bag)).is_equal
    recorded = read(bag)
    for column in ('lf_kfe.force', 'body.position', 'body.orientation'):
        assert np.array_equal(recorded[column], result[column])


def test_it_stands_squats_and_stands_again():
    run = isa_ros.load('quadruped', 'quadruped_squat', changes={TROT: [
        {'t_s': 0.0, 'height': 0.565}, {'t_s': 0.3, 'height': 0.50}, {'t_s': 0.5},
        {'t_s': 0.8, 'height': 0.565}]}, duration=1.2)
    height = run.simulate()['body.position'][:, 2]
    assert height.min() == pytest.approx(0.50, abs=0.01)
    assert height[-1] == pytest.approx(0.565, abs=0.005)


def test_a_saved_trot_continues_with_the_same_bytes():
    run = isa_ros.load('quadruped', 'quadruped_trot', changes={TROT: SHORT})
    first, second = run.simulation(), run.simulation()
    for _ in range(450):    # two feet in the air
        first.step()
    assert not first.body_sample.lf_foot_touches or not first.body_sample.rf_foot_touches
    second.restore(first.snapshot())
    for _ in range(200):
        first.step()
        second.step()
    assert first.snapshot() == second.snapshot()


@pytest.mark.parametrize('config, section, message', [
    ('leg', {'program': SHORT}, 'body = None, must be a robot of the run: it has none'),
    ('quadruped', {'program': SHORT, 'body': 'robot'}, "body = 'robot', must be a robot of the "
     'run: body'),
    ('quadruped', {}, 'program = None, must be a list of points'),
    ('quadruped', {'program': SHORT, 'dutty': 0.6}, 'controllers.trot.dutty is unknown'),
    ('two_joint_leg', {'program': SHORT}, "body = 'body': number of feet = 1, must be 4"),
    ('crane_counterbalance', {'program': SHORT}, "trot.body = 'crane': number of feet = 0, must")])
def test_refused_sections(config, section, message):
    run = isa_ros.load(config, changes={'controllers': {'trot': {
        'class': f'{Trot.__module__}:Trot', **section}}})
    with pytest.raises(ConfigError) as refused:
        run.simulation()
    assert message in str(refused.value)


@pytest.mark.long
@pytest.mark.parametrize('speed', [0.0, 0.5, 1.0])
def test_it_trots_for_ten_seconds_and_takes_a_jolt(speed, tmp_path):
    """Height, roll, and the mean speed before and after the jolt, from the bag."""
    result = read(isa_ros.load('quadruped', 'quadruped_trot', changes={
        f'{TROT}[3].speed': speed}).simulate().save(tmp_path / 'bag'))
    place = result['body.position']
    assert place[:, 2].min() > 0.45
    assert np.abs(roll(result)).max() < 0.3
    late = result.time > 3.0
    mean = (place[-1, 0] - place[late][0, 0]) / (result.time[-1] - 3.0)
    assert mean == pytest.approx(speed, rel=0.15, abs=0.02)
