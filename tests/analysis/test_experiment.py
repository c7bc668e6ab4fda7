"""Experiments: the same samples as a recorded run, with single parameters replaced."""

from isa_ros.analysis.experiment import prepared, run, with_overrides
from isa_ros.analysis.signals.traces import read_traces
from isa_ros.bag.reader import Bag
from isa_ros.config.paths import CONFIG, find
from isa_ros.config.run_file import load_run
from isa_ros.errors import BagError, ConfigError, ParameterError
from isa_ros.replay.replay import replay
import numpy as np
import pytest

STEP_TICK = 100  # the scenario's 17 Nm


@pytest.fixture(scope='module')
def rig():
    """Return the shipped rotary rig."""
    return load_run(find('rig_rotary', CONFIG))


def test_an_experiment_is_a_run_that_replays(tmp_path):
    """Its bag has the same traces and simulates again to the same bytes."""
    experiment = run('rig_rotary', 'step', tmp_path / 'bag')
    assert replay(Bag(tmp_path / 'bag')).is_equal
    _, traces = read_traces(tmp_path / 'bag')
    assert traces.keys() == experiment.traces.keys()
    torque = experiment.traces['/rotor/joint_states']['effort[0]']
    assert np.array_equal(torque, traces['/rotor/joint_states']['effort[0]'])
    assert len(torque) == 401 and abs(torque[:STEP_TICK]).max() < 1.0 < 17.0 < torque.max()


def test_without_a_directory_no_bag_is_left(rig, tmp_path, monkeypatch):
    monkeypatch.setattr('tempfile.tempdir', str(tmp_path))
    assert len(run(rig, duration=0.01).traces['/clock'].t) == 11
    assert not list(tmp_path.iterdir())


def test_an_override_changes_what_the_sensor_gives(rig):
    """S2: 4 bits over +-200 Nm are codes of 400/16 = 25 Nm, which a float holds exactly."""
    overrides = {'rotor': {'plant.sensors.adc_bits': 4}}
    torque = run(rig, 'step', overrides=overrides).traces['/rotor/joint_states']['effort[0]']
    assert len(set(torque)) > 1
    assert all(np.mod(torque, 25.0) == 0.0)


def test_an_override_of_a_load_and_of_a_section(rig):
    oil = rig.actuators[0].sheet.plant.oil
    changed = with_overrides(rig, {'rotor': {'load.inertia': 0.5, 'plant.oil': oil}})
    assert changed.actuators[0].load.inertia == 0.5
    assert changed.actuators[0].sheet == rig.actuators[0].sheet


def test_overrides_hold_for_the_load_of_the_scenario(rig):
    plan = prepared(rig, 'step', {'rotor': {'load.stiffness': 4e4}})
    assert plan.run.actuators[0].load.stiffness == 4e4


@pytest.mark.parametrize('overrides, expected', [
    ({'motor': {'plant.oil.dead_volume_ml': 1.0}}, "no actuator 'motor'; valid: rotor"),
    ({'rotor': {'plant.oil.dead_volume': 1.0}}, 'plant.oil.dead_volume is unknown; the key is '
                                                'dead_volume_ml'),
    ({'rotor': {'plant.oil.dead_volume_ml.x': 1.0}}, 'dead_volume_ml is one value, has no x'),
])
def test_an_unknown_override_is_named(rig, overrides, expected):
    with pytest.raises(ConfigError, match=expected):
        with_overrides(rig, overrides)


def test_an_override_out_of_range_is_refused(rig):
    with pytest.raises(ParameterError, match=r'rotor\.plant\.sensors\.adc_bits: .*must be >='):
        with_overrides(rig, {'rotor': {'plant.sensors.adc_bits': 0}})


def test_without_scenario_and_duration_there_is_no_end(rig):
    with pytest.raises(ConfigError, match='needs a scenario or a duration'):
        run(rig)


def test_an_existing_directory_is_not_touched(rig, tmp_path):
    with pytest.raises(BagError, match='exists'):
        run(rig, 'step', tmp_path)
