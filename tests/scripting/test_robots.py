"""Two legs from one file in one run: names, starts, faults and stops; a bag that replays."""

from pathlib import Path
from typing import Any

import isa_ros
from isa_ros.analysis.report.report import recorded, write_report
from isa_ros.analysis.signals.signals import read_signals
from isa_ros.bag.reader import Bag
from isa_ros.controller import Setpoint, State
from isa_ros.core.device import DISABLED, QUICK_STOP
from isa_ros.errors import ConfigError
from isa_ros.replay.replay import replay
import numpy as np
import pytest

TICKS = 40
PAIR: dict[str, Any] = {'name': 'pair', 'robots': {
    'r1': {'file': 'leg'},
    'r2': {'file': 'leg', 'actuators': {'kfe': {'link': {'kind': 'can', 'cycle_ms': 1.0}}}}}}
HOP: dict[str, Any] = {'name': 'hop', 'duration_s': TICKS * 1e-3, 'robots': {
    'r1': {'file': 'drop', 'leg': {'release_s': 0.01}},
    'r2': {'file': 'drop', 'leg': {'foot_height_mm': 0.0, 'release_s': 0.0}, 'faults': [
        {'t_s': 0.01, 'actuator': 'hfe', 'set': {'plant.sensors.force.bias': 40.0}},
        {'t_s': 0.015, 'link': 'kfe', 'set': {'loss': 0.5}},
        {'t_s': 0.02, 'supply': 'supply', 'set': {'pressure_mpa': 18.0}},
        {'t_s': 0.03, 'emergency_stop': 'all'}]}}}


@pytest.fixture(scope='module')
def result() -> isa_ros.Result:
    return isa_ros.load(PAIR, HOP).simulate()


@pytest.fixture(scope='module')
def bag(result, tmp_path_factory) -> Path:
    return result.save(tmp_path_factory.mktemp('robots') / 'bag')


def test_a_robot_moves_as_its_file_does_alone(result):
    """Bit for bit, on a pump of its own; with the setpoints and the start of its scenario."""
    alone = isa_ros.load('leg', 'drop').replace(
        {'scenario.leg.release_s': 0.01}).simulate(TICKS * 1e-3)
    for field in ('position', 'torque', 'foot_position', 'height'):
        assert np.array_equal(result[f'r1.{field}'], alone[f'body.{field}']), field
    for signal in ('kfe.force', 'haa.position', 'supply.pressure'):
        assert np.array_equal(result[f'r1/{signal}'], alone[signal]), signal
    assert result['r1.height'][0] != result['r2.height'][0]
    assert result.units['r1/kfe.force'] == 'N'


def test_faults_and_stops_of_a_scenario_are_those_of_its_robot(result):
    assert result['r2/supply.pressure'][-1] == 18e6 != result['r1/supply.pressure'][-1]
    states = {name: result[f'{name}.device_state'][-1] for name in (
        'r1/haa', 'r1/hfe', 'r1/kfe', 'r2/haa', 'r2/hfe', 'r2/kfe')}
    for name, state in states.items():
        assert (state in (QUICK_STOP, DISABLED)) == name.startswith('r2/'), name
    changed = {event.source for event in result.events if event.kind == 'change'}
    assert {'r2/hfe', 'r2/kfe', 'r2/supply'} <= changed
    assert not [source for source in changed if source.startswith('r1')]
    assert 'r2/kfe.link.position' in result and 'r1/kfe.link.position' not in result


def test_the_bag_has_the_topics_of_namespaces_and_replays(result, bag):
    types = set(Bag(bag).types)
    assert {f'/{robot}/{topic}' for robot in ('r1', 'r2') for topic in (
        'joint_states', 'ground_contact', 'supply_pressure', 'kfe/joint_states',
        'haa/device')} <= types
    assert {topic for topic in types if not topic.startswith(('/r1/', '/r2/'))} == {
        '/clock', '/coordinator/applied_parameters', '/coordinator/events', '/diagnostics'}
    signals = read_signals(bag)
    for name in ('r1/kfe.force', 'r2.height', 'r1/supply.pressure'):
        np.testing.assert_allclose(signals[name], result[name], rtol=1e-12, err_msg=name)
    assert replay(Bag(bag)).is_equal


def test_what_is_recorded_is_chosen_by_the_topics_of_namespaces(tmp_path):
    """A star stands for any text, also for robot and actuator; and the bag replays."""
    record = {'leave_out': ['/r1/*/references', '/r2/haa/pressure_*'],
              'decimate': {'/*/kfe/pressure_?': 8, '/r1/joint_states': 4}}
    run = isa_ros.load(PAIR | {'record': record}, HOP)
    bag = Bag(run.simulate().save(tmp_path / 'bag'))
    counts = {}
    for message in bag.messages():
        counts[message.topic] = counts.get(message.topic, 0) + 1
    assert not [topic for topic in counts
                if topic.startswith('/r1/') and topic.endswith('/references')]
    assert counts['/r2/kfe/references'] == TICKS + 1
    assert not [topic for topic in counts if topic.startswith('/r2/haa/pressure_')]
    assert counts['/r2/haa/joint_states'] == counts['/r1/haa/pressure_b'] == TICKS + 1
    for robot in ('r1', 'r2'):
        assert counts[f'/{robot}/kfe/pressure_a'] == TICKS // 8 + 1
        assert counts[f'/{robot}/hfe/pressure_a'] == TICKS + 1
    assert (counts['/r1/joint_states'], counts['/r2/joint_states']) == (TICKS // 4 + 1, TICKS + 1)
    assert replay(bag).is_equal


def test_a_filter_by_the_names_of_a_robots_own_file_matches_no_topic(bag):
    record = isa_ros.load(PAIR | {'record': {
        'leave_out': ['/kfe/references']}}).configuration.record
    with pytest.raises(ConfigError, match="record.leave_out = '/kfe/references' matches no topic"):
        record.refuse_misfits(Bag(bag).types, 'pair.yaml')


def test_the_report_of_a_bag_draws_each_actuator(bag, tmp_path):
    names = {path.name for path in write_report(recorded(bag), tmp_path / 'page.html')}
    assert {'page_r1_kfe.png', 'page_r2_kfe.svg', 'page_r1.png'} <= names
    assert 'r1/kfe' in (tmp_path / 'page.html').read_text()


def test_a_controller_and_a_simulation_name_actuators_and_bodies_with_their_robots():
    seen = []

    class Push(isa_ros.Controller):
        def step(self, state: State):
            seen.append((sorted(state.bodies), float(state.actuators['r2/kfe']['position'])))
            return {'r2/kfe': Setpoint(position=0.05)}
    simulation = isa_ros.load(PAIR).simulation([Push()])
    simulation.command('r1/kfe', position=0.06)
    for _ in range(3):
        simulation.step()
    assert seen[0][0] == ['r1', 'r2'] and 0.0 < seen[0][1] < 0.1
    assert simulation.body_samples['r1'].dtype == simulation.body_samples['r2'].dtype


@pytest.mark.parametrize(('scenario', 'message'), [
    ({'robots': {'r3': {'file': 'drop'}}},
     'hop.yaml: robots.r3 is not a robot of pair.yaml; valid: r1, r2'),
    ({'robots': {'r1': {'file': 'drop', 'no': 1}}}, 'hop.yaml: robots.r1.no is unknown'),
    ({'robots': {'r1': {'file': 'dorp'}}}, 'hop.yaml: robots.r1.file: dorp: no such file'),
    ({'robots': {'r1': {'file': 'drop'}, 'r2': {'file': 'drop', 'duration_s': 2.0}}},
     'hop.yaml: robots: duration_s = 1.0 of r1 and 2.0 of r2, must be one for all; give '
     'duration_s in hop.yaml'),
    ({'robots': {'r1': {'file': 'drop', 'faults': {}}}}, 'robots.r1.faults = {}, must be a list'),
    ({'robots': {'r1': {'file': 'drop', 'tracks': {'knee': []}}}}, 'tracks.r1/knee is unknown')])
def test_a_scenario_of_robots_is_refused_by_its_own_name(scenario, message):
    with pytest.raises(ConfigError) as error:
        isa_ros.load(PAIR, {'name': 'hop', **scenario})
    assert message in str(error.value)


def test_a_push_of_the_body_is_one_of_the_robot_and_a_range_is_that_of_all():
    """And what their files say of setpoints beyond the range holds for the run."""
    pushed = {'file': 'quadruped_jolt', 'duration_s': 3.0, 'beyond_range': 'accept'}
    run = isa_ros.load(
        {'name': 'herd', 'robots': {name: {'file': 'quadruped'} for name in ('r1', 'r2')}},
        {'name': 'jolts', 'robots': {'r1': pushed, 'r2': pushed}})
    assert {fault.target for fault in run.scenario.faults} == {'r1', 'r2'}
    assert all(name.startswith('push_') for fault in run.scenario.faults
               for name in (key.rpartition('.')[2] for key in fault.values))
    assert run.scenario.accepts_beyond


def test_a_scenario_stands_beside_those_of_its_robots():
    """Its tracks and starts win; the robots' duration is its own."""
    run = isa_ros.load(PAIR, {
        'name': 'hop', 'robots': HOP['robots'] | {'r1': {'file': 'drop'}},
        'bodies': {'r1': {'foot_height_mm': 70.0}},
        'tracks': {'r1/kfe': [{'t_s': 0.0, 'position': 0.04}]},
        'faults': [{'t_s': 0.2, 'actuator': 'r1/haa', 'fault': 'valve_stuck'}]})
    assert run.scenario.duration_s == 1.0
    assert [body.start.foot_height_mm for body in run.configuration.bodies] == [70.0, 0.0]
    assert [body.start.release_s for body in run.configuration.bodies] == [0.1, 0.0]
    tracks = {track.actuator: track for track in run.scenario.tracks}
    assert len(tracks) == 6 and tracks['r1/kfe'].events[0].setpoint.position == 0.04
    assert {fault.target for fault in run.scenario.faults} == {
        'r1/haa', 'r2/hfe', 'r2/kfe', 'r2/supply', 'r2'}
