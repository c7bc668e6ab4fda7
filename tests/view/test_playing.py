"""A bag that plays: the samples that it has, tick by tick, at the speed of host time."""

import base64
import json
from pathlib import Path

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.view.orders import order_of
from isa_ros.view.playing import Player
import numpy as np
import pytest
from tests.bag.golden import GOLDEN, rewrite

BAG = GOLDEN / 'leg_touchdown'


class Clock:
    """Host time that a test moves."""

    t = 100.0

    def __call__(self):
        return self.t


def played(bag=BAG):
    clock = Clock()
    player = Player(bag, Path(), clock)
    player.hub.opened()
    page = json.loads(player.hub.page)

    def after(seconds, *orders, **order):
        for own in (*orders, order):
            if own:
                player.hub.orders.put(order_of(json.dumps(own).encode()))
        clock.t += seconds
        frame = json.loads(player.frame()[6:])
        frame['rows'] = np.frombuffer(base64.b64decode(frame['y']), '<f4').reshape(
            frame['n'], page['channels'])
        return frame
    return page, after


def test_the_samples_are_those_of_the_bag():
    """Of all ticks, each once; the last ones stay, and it stands still."""
    page, after = played()
    result = isa_ros.read(BAG)
    frames = [after(0.0101) for _ in range(12)]
    rows = np.concatenate([own['rows'] for own in frames])
    ticks = [own['first'] + k for own in frames for k in range(own['n'])]
    assert ticks == [*range(len(result.time))] and page['end'] == result.time[-1]
    assert [own['is_paused'] for own in frames[-3:]] == [True] * 3
    assert frames[0]['tick'] == 10 and frames[-1]['tick'] == ticks[-1]
    kfe = next(own for own in page['groups'] if own['name'] == 'kfe')
    pressure = next(own for own in kfe['panels'] if own['label'] == 'pressure, MPa')
    for curve, name in zip(pressure['curves'], ('kfe.pressure_a', 'kfe.pressure_b')):
        np.testing.assert_array_equal(rows[:, curve['channel']], result[name].astype('<f4'))
    knee, = (own for own in page['scene'] if own['name'] == 'calf')
    np.testing.assert_array_equal(
        rows[:, knee['channels'][0]], result['body.position'][:, 2].astype('<f4'))


def test_speed_pause_step_and_seek():
    _, after = played()
    assert after(0.0101)['tick'] == 10
    assert after(0.0, what='speed', value=0.5)['speed'] == 0.5
    assert after(0.010)['tick'] == 15
    assert after(0.010, what='pause', value=True)['tick'] == 20
    assert [after(0.1)['n'], after(0.1)['tick']] == [0, 20]
    step = after(0.1, what='step', value=3, number=9)
    assert (step['first'], step['n'], step['tick']) == (21, 3, 23)
    assert step['answers'] == [{'number': 9, 'is_done': True, 'text': '3 ticks', 'tick': 20}]
    assert after(0.1)['n'] == 0
    assert after(0.1, {'what': 'step', 'value': 1}, what='step', value=1)['tick'] == 25
    seek = after(0.1, what='seek', value=0.05)
    assert (seek['first'], seek['n'], seek['tick']) == (50, 1, 50)
    assert after(0.1, what='seek', value=7.0)['tick'] == 80
    assert after(0.1, what='seek', value=1e9)['tick'] == 80
    back = after(0.0, what='pause', value=False)    # from the end: from the start
    assert (back['first'], back['is_paused']) == (0, False)


def test_a_bag_takes_no_setpoints():
    _, after = played()
    frame = after(0.001, what='setpoint', of='kfe', name='position', value=0.03, number=4)
    assert frame['answers'] == [{
        'number': 4, 'is_done': False, 'text': 'setpoint: a bag is only played', 'tick': 0}]


def test_a_fast_bag_is_thinned_and_a_suspended_program_does_not_jump(tmp_path):
    bag = isa_ros.load('rig_linear').simulate(3.0).save(tmp_path / 'bag')
    _, after = played(bag)
    fast = after(0.3001, what='speed', value=2.0)
    assert fast['every'] == 2 and fast['n'] == 151 and fast['tick'] == 300
    fast = after(0.3)
    assert fast['every'] == 3 and fast['first'] == 301 and fast['tick'] <= 900
    jump = after(60.0)
    assert jump['tick'] <= 901 + 1000 and not jump['is_paused']


def test_what_few_messages_have_is_held_and_what_none_has_is_missing(tmp_path):
    """A bag of every tenth joint state, without valves."""
    run = isa_ros.load('leg', changes={
        'record': {'decimate': {'/joint_states': 10}, 'leave_out': ['/*/valve', '/*/references']}})
    bag = run.simulate(0.03).save(tmp_path / 'bag')
    page, after = played(bag)
    titles = {panel['label'] for own in page['groups'] for panel in own['panels']}
    assert 'force, N' in titles
    rows = after(0.0301)['rows']
    knee, = (own for own in page['scene'] if own['name'] == 'calf')
    angle = rows[:, knee['channels'][0]]
    assert len(set(angle.tolist())) == pytest.approx(4, abs=1)
    assert (angle[11:19] == angle[11]).all()


def test_before_its_first_sample_a_channel_is_missing(tmp_path):
    """And never has a later one."""
    bag = rewrite(Bag(GOLDEN / 'rotor_step'), tmp_path / 'bag', lambda topic, sequence, data: (
        None if topic == '/rotor/valve' and sequence < 5 else data))
    page, after = played(bag)
    spool = next(panel for panel in page['groups'][0]['panels'] if panel['label'] == 'spool, mm')
    rows = after(0.0201)['rows'][:, spool['curves'][0]['channel']]
    assert np.isnan(rows[:5]).all() and not np.isnan(rows[5:]).any()
    np.testing.assert_array_equal(
        rows[5:], isa_ros.read(GOLDEN / 'rotor_step')['rotor.spool'][5:21].astype('<f4'))
