"""Sweeps: every combination once, on any number of workers the same table."""

import os
import signal
import warnings

import isa_ros
from isa_ros.actuator.group import ActuatorGroup
from isa_ros.errors import ConfigError, SimulationDiverged
import numpy as np
import pytest

KP = 'actuators.ram.parameters.reu.force.kp'
MASS = 'actuators.ram.load.inertia'
MEASURE = {'last': lambda result: result['ram.position'][-1],
           'largest': lambda result: np.abs(result['ram.force']).max()}


@pytest.fixture(scope='module')
def ram() -> isa_ros.Run:
    """Return a cylinder under a mass that is pushed."""
    return isa_ros.load('rig_linear', {'name': 'push', 'duration_s': 0.02, 'tracks': {
        'ram': [{'t_s': 0.005, 'position': 0.06}]}})


def test_each_combination_is_a_row_in_order(ram):
    table = isa_ros.sweep(ram, {KP: [8e-8, 4e-8], MASS: [20.0, 50.0, 80.0]}, measure=MEASURE,
                          workers=1)
    assert list(table) == [KP, MASS, 'last', 'largest'] and len(table['last']) == 6
    assert table[KP].tolist() == [8e-8] * 3 + [4e-8] * 3
    assert table[MASS].tolist() == [20.0, 50.0, 80.0] * 2
    alone = ram.replace({KP: 4e-8, MASS: 50.0}).simulate()
    assert table['last'][4] == alone['ram.position'][-1]
    assert str(table).splitlines()[0].split() == [KP, MASS, 'last', 'largest']
    with pytest.raises(KeyError, match='lost is unknown; did you mean last'):
        table['lost']


def test_a_fault_is_swept_by_its_key(ram):
    """One key of `set`, which has dots itself, and one that stands in sections."""
    leaky = ram.replace({'scenario.faults': [
        {'t_s': 0.0, 'actuator': 'ram', 'set': {'plant.oil.cross_port_leakage': 0.0}}]})
    key = 'scenario.faults[0].set.plant.oil.cross_port_leakage'
    table = isa_ros.sweep(leaky, {key: [0.0, 8e-12]}, measure=MEASURE, workers=1)
    assert table[key].tolist() == [0.0, 8e-12]
    assert table['largest'][0] != table['largest'][1]


def test_workers_give_the_same_table(ram):
    values = {MASS: [20.0, 35.0, 50.0, 65.0, 80.0]}
    one, three = (isa_ros.sweep(ram, values, 0.01, measure=MEASURE, workers=n) for n in (1, 3))
    for name in one:
        assert np.array_equal(one[name], three[name]), name


@pytest.mark.parametrize(('values', 'options', 'message'), [
    ({KP: []}, {}, 'must be a list of at least one'),
    ({KP: 'default'}, {}, 'must be a list of at least one'),
    ({KP: [1e-8, -1.0]}, {}, r'kp = -1 \S+, must be'),
    ({KP + 'x': [1.0]}, {}, 'kpx is unknown'),
    ({KP: [1e-8]}, {'workers': 0}, 'workers = 0, must be >= 1, or -1'),
])
def test_bad_values_are_refused_before_anything_is_simulated(ram, values, options, message):
    def measure(result):
        raise AssertionError('nothing is to be simulated')
    with pytest.raises(ConfigError, match=message):
        isa_ros.sweep(ram, values, measure={'none': measure}, **options)


@pytest.mark.parametrize('workers', [1, 2])
def test_a_run_that_diverges_is_named_with_its_state(ram, workers, monkeypatch):
    """A pressure is no number: no value that a run may have leads there."""
    begin = ActuatorGroup.set_clock

    def broken(self):
        if self.t_ns > 0:
            self.actuators[0].memory.continuous['plant']['chambers']['p_a'][0] = np.nan
        begin(self)
    monkeypatch.setattr(ActuatorGroup, 'set_clock', broken)
    with pytest.raises(SimulationDiverged, match='ram: plant.'):
        isa_ros.sweep(ram, {MASS: [20.0, 30.0]}, measure=MEASURE, workers=workers)


def test_an_error_of_a_measure_is_not_swallowed(ram):
    """Without a single value the error is that of the measure."""
    with pytest.raises(ZeroDivisionError):
        isa_ros.sweep(ram, {MASS: [20.0]}, measure={'bad': lambda result: 1 / 0}, workers=1)


class OfTwo(Exception):
    """An error that does not survive pickling: its constructor takes two values."""

    def __init__(self, one, two):
        super().__init__(f'{one} of {two}')


def fails_with_35(error):
    """Return a measure that raises for the run with 35 kg."""
    def measure(result):
        if result.scenario.run.actuators[0].load.inertia == 35.0:
            raise error
        return result['ram.position'][-1]
    return measure


@pytest.mark.parametrize('workers', [1, 2])
@pytest.mark.parametrize(('error', 'shown'), [
    (ValueError('no peak'), 'ValueError: no peak'), (OfTwo(1, 2), 'OfTwo: 1 of 2')])
def test_an_error_of_a_measure_loses_no_other_value(ram, workers, error, shown):
    """The worker with the failed run does the others of its share too."""
    measure = {'odd': fails_with_35(error), **MEASURE}
    with pytest.warns(UserWarning, match=(
            f"1 of 5 runs lack a value; with {MASS} = 35.0: measure 'odd': {shown}")) as said:
        table = isa_ros.sweep(ram, {MASS: [20.0, 35.0, 50.0, 65.0, 80.0]}, 0.01, measure=measure,
                              workers=workers)
    assert 'test_sweep.py:' in str(said[0].message) or workers == 2
    assert said[0].filename == __file__
    assert np.isnan(table['odd']).tolist() == [False, True, False, False, False]
    assert np.isfinite(table['last']).all() and np.isfinite(table['largest']).all()
    assert [failure.measure for failure in table.failures[1]] == ['odd']
    assert list(table.failures) == [1]


def test_a_run_that_diverges_loses_no_other_run(ram, monkeypatch):
    simulate = isa_ros.Run.simulate

    def broken(self, *args):
        if self.configuration.actuators[0].load.inertia == 30.0:
            raise SimulationDiverged(10_000_000, 'ram: plant.p_a', np.nan)
        return simulate(self, *args)
    monkeypatch.setattr(isa_ros.Run, 'simulate', broken)
    with pytest.warns(UserWarning, match=f'1 of 3 runs lack a value; with {MASS} = 30.0: ram: '):
        table = isa_ros.sweep(ram, {MASS: [20.0, 30.0, 40.0]}, measure=MEASURE, workers=2)
    assert np.isnan(table['last']).tolist() == [False, True, False]
    assert isinstance(table.failures[1][0].error, SimulationDiverged)


def test_a_worker_that_is_killed_loses_its_own_runs_only(ram):
    """As by the kernel where memory is short; the second worker has every other run."""
    def killed(result):
        if result.scenario.run.actuators[0].load.inertia == 35.0:
            os.kill(os.getpid(), signal.SIGKILL)
        return 1.0
    with pytest.warns(UserWarning, match='2 of 4 runs lack .*: a worker of the sweep ended with '
                                         'exit code -9'):
        table = isa_ros.sweep(
            ram, {MASS: [20.0, 35.0, 50.0, 65.0]}, 0.01, measure={'one': killed}, workers=2)
    assert np.isnan(table['one']).tolist() == [False, True, False, True]


BORE = 'actuators.ram.parameters.plant.drive.bore_mm'


def test_values_that_follow_a_changed_bore_are_named_in_one_line(ram):
    """Of the others no line: nothing follows the supply or the load's mass."""
    with pytest.warns(UserWarning) as said:
        isa_ros.sweep(ram, {BORE: [21.5, 25.0]}, 0.002, measure=MEASURE, workers=1)
    line, = (str(one.message) for one in said if one.filename == __file__)
    assert f'more values of ram follow {BORE}: parameters.' in line and '\n' not in line
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        isa_ros.sweep(ram, {'supply.pressure_mpa': [20.7, 14.0], MASS: [20.0, 30.0]}, 0.002,
                      measure=MEASURE, workers=1)
