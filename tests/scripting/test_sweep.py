"""Sweeps: every combination once, on any number of workers the same table."""

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
    advance = ActuatorGroup.advance

    def broken(self, *args):
        if self.t_ns == 10_000_000:
            self.actuators[0].memory.continuous['plant']['chambers']['p_a'][0] = np.nan
        return advance(self, *args)
    monkeypatch.setattr(ActuatorGroup, 'advance', broken)
    with pytest.raises(SimulationDiverged, match='ram: plant.'):
        isa_ros.sweep(ram, {MASS: [20.0, 30.0]}, measure=MEASURE, workers=workers)


def test_an_error_of_a_measure_is_not_swallowed(ram):
    with pytest.raises(ZeroDivisionError):
        isa_ros.sweep(ram, {MASS: [20.0]}, measure={'bad': lambda result: 1 / 0}, workers=1)
