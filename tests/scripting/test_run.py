"""Runs from Python: the files' keys and checks, and the same samples as everywhere else."""

import subprocess
import sys

import isa_ros
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.text.yaml_text import read
from isa_ros.controller import Controller, Setpoint
from isa_ros.errors import ConfigError, IsaError
from isa_ros.run.local_run import LocalRun
from isa_ros.tick.source import ScheduledSource
import numpy as np
import pytest
from tests.golden.message_digests import Digests, digests

STICTION = 'actuators.kfe.parameters.plant.friction.stiction'


@pytest.fixture(scope='module')
def drop() -> isa_ros.Run:
    """Return the leg's drop over its first 30 ms."""
    return isa_ros.load('leg', 'drop', duration=0.03)


def test_the_package_itself_loads_neither_numba_nor_ros_nor_messages():
    """`import isa_ros` answers at once; a simulation needs no message package."""
    program = (
        'import sys, isa_ros; early = {"numba", "rclpy", "numpy"} & set(sys.modules); '
        'isa_ros.load("leg", "drop", duration=0.001).simulate(); '
        'late = {"rclpy", "msg_adapters", "sensor_msgs", "mcap"} & set(sys.modules); '
        'print(early, late)')
    done = subprocess.run(
        [sys.executable, '-c', program], capture_output=True, text=True, check=True)
    assert done.stdout == 'set() set()\n'


def test_every_public_name_is_there():
    for name in isa_ros.__all__:
        assert getattr(isa_ros, name).__doc__, name
        assert name in dir(isa_ros)
    with pytest.raises(AttributeError, match="has no attribute 'nosuch'"):
        isa_ros.nosuch


def test_names_of_shipped_files_and_paths_and_dictionaries_are_taken(drop, tmp_path):
    path = tmp_path / 'mine.yaml'
    path.write_text('name: mine\nduration_s: 0.01\ntracks: {}\n')
    assert drop.actuators == ('haa', 'hfe', 'kfe')
    assert isa_ros.load('leg.yaml', path).scenario.n_ticks == 10
    given = {'name': 'given', 'duration_s': 0.02, 'tracks': {}}
    assert isa_ros.load('leg', given).scenario.n_ticks == 20
    with pytest.raises(ConfigError, match='given.yaml: duration is unknown'):
        isa_ros.load('leg', {'name': 'given', 'duration': 0.02})


def test_replace_changes_one_value_and_leaves_the_run_as_it_was(drop):
    changed = drop.replace({STICTION: 123.0, 'actuators.hfe.preset': 'table_4'})
    sheets = [run.configuration.actuator('kfe').sheet for run in (drop, changed)]
    assert [sheet.plant.friction.stiction for sheet in sheets] == [
        sheets[0].plant.friction.stiction, 123.0]
    assert [run.configuration.actuator('hfe').preset for run in (drop, changed)] == [
        'default', 'table_4']
    assert changed.scenario.n_ticks == drop.scenario.n_ticks


def test_replace_reaches_the_scenario(drop):
    changed = drop.replace({
        'scenario.leg.foot_height_mm': 50.0, 'scenario.tracks.kfe[0].stiffness': 7.0e4})
    assert changed.configuration.leg.start.foot_height_mm == 50.0
    track, = [track for track in changed.scenario.tracks if track.actuator == 'kfe']
    assert track.events[0].stiffness == 7.0e4


@pytest.mark.parametrize(('changes', 'message'), [
    ({STICTION + 'n': 1.0}, 'leg.yaml: .*stictionn is unknown; did you mean stiction'),
    ({STICTION: -1.0}, r'leg.yaml: .*stiction = -1 N, must be > 0'),
    ({STICTION: 'much'}, r"leg.yaml: .*stiction = 'much', must be a number in N"),
    ({'supply.pressure_bar': 207.0}, 'leg.yaml: .*the key is pressure_mpa'),
    ({'actuators..kfe': 1}, r"leg.yaml: key 'actuators..kfe' is malformed"),
    ({'name.first': 'x'}, 'leg.yaml: name.first: first is below a value'),
    ({'scenario.tracks.kfe[7].position': 0.1},
     r'drop.yaml: tracks.kfe\[7\].position: \[7\] does not exist, the number of entries is 1'),
    ({'scenario.duration_s': 0.0005}, 'drop.yaml: duration_s'),
])
def test_a_change_is_checked_as_if_it_stood_in_the_file(drop, changes, message):
    with pytest.raises(IsaError, match=message):
        drop.replace(changes)


def test_a_key_of_a_scenario_needs_one():
    with pytest.raises(ConfigError, match='scenario.name is not used: the run has no scenario'):
        isa_ros.load('leg').replace({'scenario.name': 'other'})
    with pytest.raises(ConfigError, match='simulate needs a duration'):
        isa_ros.load('leg').simulate()


def test_a_result_holds_what_a_run_records(drop):
    """Names, units, shapes; the numbers are those of the messages' rows."""
    result = drop.simulate()
    assert result.time.tolist() == pytest.approx([k * 1e-3 for k in range(31)], abs=1e-15)
    assert result['kfe.force'].shape == (31,)
    assert result['body.foot_force'].shape == (31, 3)
    assert result['supply.pressure'].tolist() == [20.7e6] * 31
    assert (result.units['kfe.position'], result.units['haa.position']) == ('m', 'rad')
    assert (result.units['haa.force'], result.units['body.height']) == ('Nm', 'm')
    assert set(result) == set(result.units)
    simulation = drop.simulation()
    for _ in range(30):
        samples = simulation.step()
    assert samples['kfe'].force == result['kfe.force'][-1]
    with pytest.raises(KeyError, match='kfe.forc is unknown; did you mean kfe.force'):
        result['kfe.forc']
    with pytest.raises(ValueError, match='read-only'):
        result['kfe.force'][0] = 1.0


def test_a_saved_result_is_the_bag_of_the_run(drop, tmp_path):
    """Topic by topic the bytes that the recorded run gives."""
    from isa_ros.bag.reader import Bag
    bag = Bag(drop.simulate().save(tmp_path / 'bag'))
    local = LocalRun(drop.configuration)
    recorder = Digests([topic.name for topic in local.topics])
    local.simulate(30, ScheduledSource(drop.scenario.commands), recorder)
    saved = Digests([topic.name for topic in local.topics])
    index = {topic.name: k for k, topic in enumerate(local.topics)}
    for tick in bag.ticks():
        saved.write_tick(tick.t_ns, tick.sequence, [(index[m.topic], m.data)
                                                    for m in tick.messages])
    assert saved.by_topic() == recorder.by_topic() != digests
    with pytest.raises(IsaError, match='bag already exists'):
        drop.simulate().save(tmp_path / 'bag')


@pytest.mark.parametrize(('record', 'message'), [
    ({'leave_out': ['/knee/valve']},
     r"leg.yaml: record.leave_out = '/knee/valve' matches no topic; valid: /clock, "),
    ({'leave_out': ['/kfe/*']}, 'leaves out /kfe/applied_parameters, which a replay needs'),
    ({'decimate': {'/coordinator/events': 5}},
     'decimates /coordinator/events, of which a replay')])
def test_a_result_whose_bag_would_lack_something_is_not_saved(drop, tmp_path, record, message):
    """As `isa bringup` refuses it: it was saved, and the pattern had no effect."""
    with pytest.raises(ConfigError, match=message):
        drop.replace({'record': record}).simulate().save(tmp_path / 'bag')
    assert not (tmp_path / 'bag').exists()


def test_a_result_is_saved_without_what_is_left_out(drop, tmp_path):
    from isa_ros.bag.reader import Bag
    thinned = drop.replace({'record': {'leave_out': ['/*/references', '/clock']}})
    topics = set(Bag(thinned.simulate().save(tmp_path / 'bag')).types)
    assert '/kfe/valve' in topics
    assert not topics & {'/clock', '/haa/references', '/kfe/references'}


class Push(Controller):
    """Asks the knee for another place at every tick."""

    def start(self, names):
        self.seen = []

    def step(self, state):
        self.seen.append((state.t_ns, float(state.body.height), len(state.supplies)))
        return {'kfe': Setpoint(position=float(state.actuators['kfe'].position) + 1e-3)}


def test_a_controller_in_memory_is_shown_a_tick_and_takes_effect_at_the_next(drop):
    push = Push()
    result = drop.simulate(controllers=[push])
    assert [t_ns for t_ns, _, _ in push.seen] == [k * 1_000_000 for k in range(30)]
    assert push.seen[0][1] == result['body.height'][0] and push.seen[0][2] == 1
    kfe = drop.actuators.index('kfe')
    applied = {tick: rows[kfe]['position'] for tick, rows in result.log.applied.items()
               if rows[kfe]['kinds']}
    assert applied[2] == result['kfe.position'][0] + 1e-3
    assert sorted(applied) == list(range(31))
    assert result.scenario.run.controllers == ('push',)


def test_controllers_are_named_once(drop):
    with pytest.raises(ConfigError, match='two controllers are named push'):
        drop.simulate(controllers=[Push(), Push()])
    named = drop.simulate(0.001, controllers={'left': Push(), 'right': Push()})
    assert named.scenario.run.controllers == ('left', 'right')
    file = drop.replace({'controllers': ['push']})
    with pytest.raises(ConfigError, match="'push' takes part in this run"):
        file.simulate()
    assert file.simulate(0.001, [Push()]).scenario.run.controllers == ('push',)


def test_tables_of_other_packages_have_names_units_and_time(drop):
    pandas = pytest.importorskip('pandas')
    frame = drop.simulate(0.002).to_pandas()
    assert isinstance(frame, pandas.DataFrame) and frame.index.name == 'time'
    assert list(frame['body.foot_force[2]']) == list(frame['body.foot_force[2]'])
    assert frame.attrs['units']['kfe.force'] == 'N'


def test_a_package_that_is_missing_is_named(drop, monkeypatch):
    monkeypatch.setitem(sys.modules, 'pandas', None)
    with pytest.raises(IsaError, match='pandas is not installed: pip install pandas'):
        drop.simulate(0.001).to_pandas()


def test_the_arrays_of_two_runs_are_independent(drop):
    first, second = drop.simulate(0.005), drop.simulate(0.005)
    assert np.array_equal(first['kfe.force'], second['kfe.force'])
    assert not np.shares_memory(first['kfe.force'], second['kfe.force'])


def test_a_setpoint_that_is_limited_is_reported_before_the_run():
    """As a `UserWarning` here, and as a line of a run on nodes."""
    far = {'name': 'far', 'duration_s': 0.002, 'tracks': {
        'kfe': [{'t_s': 0.0, 'position': 0.05, 'effort': 1e4}]}}
    with pytest.raises(ConfigError, match=r'far.yaml: tracks.kfe\[0\].effort = 10000 N, must be'):
        isa_ros.load('leg', far)
    leg = read(find('leg', CONFIG))
    leg['actuators']['kfe']['beyond_range'] = 'limit'
    with pytest.warns(UserWarning, match=(
            r'far.yaml: tracks.kfe\[0\].effort = 10000 N, limited to 7500 N, the rated force')
            ) as caught:
        result = isa_ros.load(leg, far).simulate()
    assert [own.filename for own in caught] == [__file__]
    assert result.log.applied[1]['effort'].tolist() == [0.0, 0.0, 7500.0]


def test_a_seed_for_one_run_keeps_its_faults(drop):
    """`simulate(seed=, faults=)` is the run replaced by that seed, with these faults."""
    fault = {'t_s': 0.005, 'actuator': 'kfe', 'fault': 'valve_stuck'}
    found = drop.simulate(0.01, seed=7, faults=[fault])
    expected = drop.replace({'seed': 7}).simulate(0.01, faults=[fault])
    without = drop.replace({'seed': 7}).simulate(0.01)
    assert np.array_equal(found['kfe.spool'], expected['kfe.spool'])
    assert not np.array_equal(found['kfe.spool'], without['kfe.spool'])


def test_replace_keeps_duration_compression_and_size_of_files():
    given = isa_ros.load('leg', duration=0.02, compression='lz4', split_mb=3.0)
    changed = given.replace({STICTION: 123.0})
    record = changed.configuration.record
    assert record == given.configuration.record != isa_ros.load('leg').configuration.record
    assert changed.scenario.n_ticks == 20


def test_a_fault_of_the_link_is_checked_with_the_link_that_is_given():
    """Alone the scenario does not fit the run; by both names of the target it is one fault."""
    plan = {'name': 'cut', 'duration_s': 0.02, 'faults': [
        {'t_s': 0.005, target: 'ram', 'fault': 'link_lost'} for target in ('link', 'actuator')]}
    with pytest.raises(ConfigError, match='link.loss is not used: there is no link'):
        isa_ros.load('rig_linear', plan)
    link = {'kind': 'ethercat', 'cycle_ms': 1.0, 'watchdog_ms': 4.0}
    run = isa_ros.load('rig_linear', plan, changes={'link': link, 'scenario.duration_s': 0.03})
    by_link, by_actuator = run.scenario.faults
    assert by_link == by_actuator and dict(by_link.values) == {'link.loss': 1.0}
    with pytest.warns(isa_ros.TripWarning, match='link_lost tripped'):
        result = run.simulate()
    assert len(result.time) == 31
    with pytest.raises(ConfigError, match='scenario.name is not used: the run has no scenario'):
        isa_ros.load('rig_linear', changes={'scenario.name': 'x'})


@pytest.mark.parametrize(('faults', 'message'), [
    ({}, 'the given faults: faults[0] lacks t_s'),
    ({'t_s': 0.0, 'set': {'load.force': float('nan')}},
     'faults[0].set.load.force = nan, must be finite'),
    ({'t_s': 0.0, 'set': {'load.force': 1e9}},
     'faults[0].set: load.force = 1e+09 N, must be <= 2e+07 N')])
def test_a_refused_fault_has_the_file_of_the_run_and_one_unit(faults, message):
    with pytest.raises(ConfigError) as caught:
        isa_ros.load('rig_linear').simulate(0.01, faults=[{'actuator': 'ram', **faults}])
    assert message in str(caught.value)


def test_a_fault_of_another_kind_of_supply_names_the_kind():
    with pytest.raises(ConfigError, match='pump_flow_lpm of supply, a supply of kind constant, '
                                          'is unknown or does not change .* valid: pressure_mpa'):
        isa_ros.load('rig_linear').simulate(
            0.01, faults=[{'t_s': 0.0, 'supply': 'supply', 'fault': 'pump_trip'}])
