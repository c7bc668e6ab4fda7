"""A run with pages: the same bytes as without; orders take effect between ticks, and replay."""

import base64
import json
from pathlib import Path

import isa_ros
from isa_ros.bag.reader import Bag
from isa_ros.config.assembly import group_of, surroundings_of
from isa_ros.config.paths import CONFIG, find, SCENARIOS
from isa_ros.errors import ConfigError
from isa_ros.replay.replay import replay
from isa_ros.run.coordinator import Coordinator
from isa_ros.run.options import Request
from isa_ros.run.outlets import Outlets
from isa_ros.run.session import prepare, record
from isa_ros.tick.in_process import InProcess
from isa_ros.view import running
from isa_ros.view.frames import PERIOD_S
from isa_ros.view.orders import order_of
from isa_ros.view.running import LiveRun, view_run
import numpy as np
import pytest


class Lived:
    """A run of a rig, with the orders of a page before some ticks."""

    def __init__(self, out: Path, orders=(), config='rig_linear', scenario=None, has_page=True,
                 duration=0.05, is_paused=False, stops_at=None):
        self.host, self.frames, self.ticks, self.stops_at = 0.0, [], 0, stops_at
        self.orders = {tick: [*own] for tick, own in dict(orders).items()}
        session = prepare(Request(
            config=find(config, CONFIG), out=out, duration_s=duration, is_paused=is_paused,
            scenario=None if scenario is None else find(scenario, SCENARIOS)))
        surroundings, group = surroundings_of(session.run), group_of(session.run)
        self.live = LiveRun(session, group, surroundings, Path(), self._now)
        self.page = json.loads(self.live.hub.page)
        if has_page:
            self.live.hub.opened()
        self.live.hub.send = self._take
        record(session, InProcess(group, surroundings.starts()), surroundings,
               lambda topics: Outlets(), None, lambda: self.ticks == self.stops_at, self._serve,
               sinks=(self.live,))
        self.bags = session.bags
        self.bag = Bag(out)

    def _now(self):
        self.host += 0.4 * PERIOD_S
        return self.host

    def _take(self, frame):
        tree = json.loads(frame[6:])
        rows = np.frombuffer(base64.b64decode(tree.pop('y')), '<f4')
        self.frames.append({**tree, 'rows': rows.reshape(tree['n'], self.page['channels'])})

    def _serve(self, coordinator: Coordinator):
        self.ticks = coordinator.ticks
        for order in self.orders.pop(coordinator.ticks, ()):
            self.live.hub.orders.put(order_of(json.dumps(order).encode()))
        self.live.serve(coordinator)

    @property
    def answers(self):
        return [own for frame in self.frames for own in frame['answers']]

    def applied(self, topic):
        return [message.sequence for message in self.bag.messages({topic})]


def bytes_of(bag: Path) -> bytes:
    file, = bag.glob('*.mcap')
    return file.read_bytes()


def setpoint(name, value, of='ram', number=1):
    return {'what': 'setpoint', 'of': of, 'name': name, 'value': value, 'number': number}


def fault(name, value, of='ram'):
    return {'what': 'fault', 'of': of, 'name': name, 'value': value}


@pytest.mark.parametrize('config, scenario', [('rig_linear', None), ('leg', 'drop')])
def test_a_page_changes_no_byte(tmp_path, config, scenario):
    """Open or closed the bag is that of the run in memory, which is that of a bring-up."""
    watched = Lived(tmp_path / 'watched' / 'bag', (), config, scenario)
    alone = Lived(tmp_path / 'alone' / 'bag', (), config, scenario, has_page=False)
    assert len(watched.frames) > 10 and not alone.frames
    own = isa_ros.load(config, scenario, duration=0.05).simulate().save(tmp_path / 'own' / 'bag')
    assert bytes_of(watched.bags[0]) == bytes_of(alone.bags[0]) == bytes_of(own)


def test_frames_have_the_samples_of_every_tick(tmp_path):
    """Each once and in their order, though a frame is sent every third tick only."""
    lived = Lived(tmp_path / 'bag', scenario='identify_linear')
    ticks = [own['first'] + k for own in lived.frames for k in range(own['n'])]
    assert ticks == [*range(len(ticks))] and 45 < len(ticks) <= 51
    assert 15 < len(lived.frames) < 40
    result = isa_ros.read(lived.bag.path)
    rows = np.concatenate([own['rows'] for own in lived.frames])
    position = lived.page['groups'][0]['panels'][0]['curves'][0]['channel']
    assert len(set(rows[:, position].tolist())) > 5
    np.testing.assert_array_equal(
        rows[:, position], result['ram.position'][:len(ticks)].astype('<f4'))
    assert lived.frames[-1]['devices'] == ['enabled']


def test_a_setpoint_that_is_not_followed_is_answered_so(tmp_path):
    """While the device is disabled, and no longer once it is enabled again; so is its event."""
    lived = Lived(tmp_path / 'bag', {
        5: [{'what': 'request', 'of': 'ram', 'name': 'disable'}],
        10: [setpoint('position', 0.031), setpoint('stiffness', 54321.0)],
        12: [{'what': 'request', 'of': 'ram', 'name': 'enable'}, setpoint('effort', 70.0)]})
    told = [own['text'] for own in lived.answers]
    assert told[1] == 'ram: position = 0.031, not followed: the state is disabled'
    assert told[2] == 'ram: stiffness = 54321'   # a gain is kept, and in force once enabled
    assert told[4] == 'ram: effort = 70'
    assert [own['is_done'] for own in lived.answers] == [True] * 5
    events = [own.what for own in isa_ros.read(lived.bag.path).events if own.kind == 'change']
    assert sorted(events) == [
        'by the page, effort = 70',
        'by the page, position = 0.031, not followed: the state is disabled',
        'by the page, stiffness = 54321']


def test_a_setpoint_takes_effect_at_the_next_tick_and_is_in_the_bag(tmp_path):
    """With the number of the tick that the page is told; the bag replays."""
    lived = Lived(tmp_path / 'bag', {
        20: [setpoint('position', 0.031, number=5)], 30: [setpoint('stiffness', 54321.0)],
        40: [setpoint('effort', 77.0)]})
    assert lived.answers[0] == {
        'number': 5, 'is_done': True, 'text': 'ram: position = 0.031', 'tick': 20}
    assert lived.applied('/ram/applied_setpoint')[1:] == [21, 31, 41]
    result = isa_ros.read(lived.bag.path)
    reference = result['ram.position_reference']
    assert reference[20] != reference[21] == 0.031 == reference[-1]
    last = result.log.applied[41][0]
    assert [last[name] for name in ('position', 'effort', 'stiffness')] == [0.031, 77.0, 54321.0]
    assert replay(lived.bag).is_equal


def test_frames_have_the_setpoint_that_is_in_force(tmp_path):
    """Of a leg that stands: no command gave the effort that bears it, and a slider keeps it."""
    lived = Lived(tmp_path / 'bag', {20: [setpoint('position', 0.04, of='kfe')]}, config='leg')
    borne = lived.frames[4]['setpoints'][2][1]
    place, effort, *_ = lived.frames[-1]['setpoints'][2]
    assert abs(borne) > 20.0 and effort == borne and place == pytest.approx(40.0, abs=1e-9)
    result = isa_ros.read(lived.bag.path)
    last = result.log.applied[21][2]
    assert (last['effort'], last['position']) == (borne, 0.04)
    assert result.log.applied[0][2]['effort'] == 0.0     # what the recorded message has, as ever
    assert replay(lived.bag).is_equal


def test_gains_faults_requests_and_stops_are_in_the_bag(tmp_path):
    """Each at the tick after the order; what is on is told to all pages; the bag replays."""
    lived = Lived(tmp_path / 'bag', {
        5: [{'what': 'tune', 'of': 'ram', 'name': 'reu.force.kp', 'value': 5e-8}],
        10: [fault('valve_stuck', True), fault('supply_low', True, 'supply')],
        20: [fault('valve_stuck', False)],
        25: [{'what': 'request', 'of': 'ram', 'name': 'disable'}],
        32: [{'what': 'request', 'of': 'ram', 'name': 'enable'}],
        40: [{'what': 'stop', 'value': True}]})
    assert [own['is_done'] for own in lived.answers] == [True] * 7
    result = isa_ros.read(lived.bag.path)
    tuned = {tick: rows[0] for tick, rows in result.log.tuned.items()}
    assert tuned[6] == {'force.kp': 5e-8}
    assert tuned[11] == {'plant.spool.stuck': 1.0} and tuned[21] == {'plant.spool.stuck': 0.0}
    assert result.log.tuned_supplies[11] == {'supply.pressure_mpa': 10.0}
    assert result.log.tuned_supplies[41] == {'emergency_stop.all.opened': 1.0}
    enabled = [int(row[0]['is_enabled']) for tick, row in sorted(result.log.applied.items())]
    assert enabled[-2:] == [0, 1]
    assert [own for frame in lived.frames if frame['tick'] == 16 for own in frame['faults']] in (
        [], [['ram', 'valve_stuck'], ['supply', 'supply_low']])
    assert ['supply', 'supply_low'] in lived.frames[-1]['faults']
    assert ['ram', 'valve_stuck'] not in lived.frames[-1]['faults']
    assert lived.frames[-1]['is_stopped'] and not lived.frames[3]['is_stopped']
    assert replay(lived.bag).is_equal


def test_pause_step_and_speed(tmp_path):
    """A step is exactly its ticks; the pause is in the bag as an event, as one of ROS."""
    lived = Lived(tmp_path / 'bag', {
        0: [{'what': 'step', 'value': 7, 'number': 3}],
        7: [{'what': 'step', 'value': 1}, {'what': 'speed', 'value': 500.0}],
        8: [{'what': 'seek', 'value': 0.0}, {'what': 'pause', 'value': False}]}, is_paused=True)
    assert [(own['text'], own['tick'], own['is_done']) for own in lived.answers] == [
        ('7 ticks', 0, True), ('1 tick', 7, True), ('500 times real time', 8, True),
        ('seek: a run goes forward only', 8, False), ('runs', 8, True)]
    assert lived.frames[0]['is_paused'] and not lived.frames[-1]['is_paused']
    assert {own['speed'] for own in lived.frames} == {0.0, 500.0}
    assert isa_ros.read(lived.bag.path).time[-1] == 0.05
    assert replay(lived.bag).is_equal


def test_a_step_of_a_run_that_goes_on_pauses_it(tmp_path):
    lived = Lived(tmp_path / 'bag', {
        10: [{'what': 'step', 'value': 2}], 12: [{'what': 'pause', 'value': False}]})
    assert [(own['is_done'], own['tick']) for own in lived.answers] == [(True, 10), (True, 12)]
    assert {own['tick'] for own in lived.frames if own['is_paused']} <= {12}
    assert isa_ros.read(lived.bag.path).time[-1] == 0.05


def test_a_restart_begins_another_bag(tmp_path):
    """At t = 0 and without what lay over values; the second bag is that of a run by itself."""
    lived = Lived(tmp_path / 'bag', {
        12: [setpoint('position', 0.02), fault('valve_stuck', True)],
        20: [{'what': 'restart'}]})
    assert lived.bags == [tmp_path / 'bag', tmp_path / 'bag_2']
    assert isa_ros.read(lived.bags[0]).time[-1] == 0.02
    own = isa_ros.load('rig_linear').simulate(0.05).save(tmp_path / 'own')
    for mine, its in zip(Bag(lived.bags[1]).messages(), Bag(own).messages(), strict=True):
        assert mine == its
    again = next(k for k, frame in enumerate(lived.frames) if frame['tick'] == 0 and k > 5)
    assert lived.frames[again]['faults'] == [] and lived.frames[again - 1]['faults']
    ticks = [own['first'] + k for own in lived.frames[again:] for k in range(own['n'])]
    assert ticks == [*range(len(ticks))]


@pytest.mark.parametrize('order, message', [
    (setpoint('position', 9.0), 'ram: setpoint position = 9 m, must be 0 to 0.1 m, the stroke'),
    (setpoint('jerk', 1.0), "ram: setpoint 'jerk' is unknown; valid: "),
    (setpoint('position', 0.01, of='ra'), "'ra' is not an actuator; did you mean ram?"),
    (setpoint('spool', 1e-5), 'ram: setpoint spool is not of the mode in force, impedance'),
    (setpoint('stiffness', -1.0), 'ram: setpoint stiffness = -1.0, must be >= 0'),
    ({'what': 'tune', 'of': 'ram', 'name': 'reu.force.kp', 'value': 1.0}, 'reu.force.kp = 1'),
    ({'what': 'tune', 'of': 'ram', 'name': 'plant', 'value': 1.0}, 'plant is unknown'),
    ({'what': 'request', 'of': 'ram', 'name': 'eject'}, "request 'eject' is unknown; valid: "),
    ({'what': 'request', 'of': 'ram', 'name': 'clear_fault'}, 'ram: the state is enabled, '),
    (fault('valve_stuk', True), "ram: fault 'valve_stuk' is unknown; did you mean valve_stuck?"),
    (fault('link_lost', True), "ram: fault 'link_lost' is unknown"),
    (fault('valve_stuck', True, 'pump'), "'pump' is not an actuator or a supply; valid: "),
    ({'what': 'speed', 'value': 0.009}, 'speed: value = 0.009, must be >= 0.01, or 0 (as fast'),
    ({'what': 'stop', 'value': False}, '')])
def test_what_is_refused_changes_nothing(tmp_path, order, message):
    """One line with what, value and bound; the bag is that of a run without the order."""
    lived = Lived(tmp_path / 'bag', {20: [order]}, duration=0.03)
    answer, = lived.answers
    assert answer['is_done'] == (not message) and message in answer['text']
    assert '\n' not in answer['text']
    own = isa_ros.load('rig_linear').simulate(0.03).save(tmp_path / 'own')
    for mine, its in zip(lived.bag.messages(), Bag(own).messages(), strict=True):
        assert mine == its


def test_without_a_page_ticks_pass_quietly(tmp_path):
    lived = Lived(tmp_path / 'bag', has_page=False)
    assert lived.live.quiet_ticks(3) > 1e9
    lived.live.hub.opened()
    assert lived.live.quiet_ticks(3) == 0


def test_a_controller_that_is_a_node_is_refused(tmp_path):
    session = prepare(Request(
        config=find('rig_linear', CONFIG), out=tmp_path / 'bag', controllers=('sway',)))
    with pytest.raises(ConfigError, match='^rig_linear.yaml: controllers: sway cannot take part'):
        view_run(session, 0, Path(), print, None, lambda: False)


def test_the_run_begins_with_the_first_page_and_ends_its_pages(tmp_path, monkeypatch):
    """Stopped before, nothing is recorded."""
    session = prepare(Request(config=find('rig_linear', CONFIG), out=tmp_path / 'bag'))
    told, asked = [], []

    def should_stop():
        asked.append(1)
        return len(asked) > 3
    with pytest.raises(running.Interrupted, match='before a page was opened'):
        view_run(session, 0, Path(), told.append, None, should_stop)
    assert told[0].startswith('http://127.0.0.1:') and session.bags == []
