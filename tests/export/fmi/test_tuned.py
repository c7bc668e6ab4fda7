"""Parameters that change while a unit runs have the effect that they have in a run."""

from isa_ros.config.models.catalogue import model_names
from isa_ros.errors import ConfigError
from isa_ros.export.chosen import choose
from isa_ros.export.exported import exported
from isa_ros.export.fmi.description import Version
from isa_ros.export.fmi.tuned import tuned
from isa_ros.simulation import Simulation
import numpy as np
import pytest

pytest.importorskip('fmpy')
from tests.export.fmi.importing import ERROR, OK, Unit, WARNING  # noqa: E402
from tests.export.fmi.runs import inputs_of, SAMPLED  # noqa: E402

CHANGES = {
    20: {'reu.force.kp': 3e-7, 'reu.force.limit': 1e-4},
    45: {'reu.force.kp': 1.23456789e-7, 'reu.position.force_out': 5000.0},
    70: {'reu.force.ki': 1e-5, 'reu.force.compensation.slope': 0.3},
    100: {'reu.force.kp': 8e-8},    # that of the sheet
    130: {'reu.force.kd': 1e-9, 'reu.force.kv': 0.01, 'reu.force.offset': 1e-6,
          'reu.force.setpoint_weight': 0.7, 'reu.force.retracting_factor': 1.3}}


@pytest.fixture(scope='module', params=Version)
def path(request, cases):
    return cases('own_load').paths[request.param]


@pytest.mark.slow
def test_a_run_with_changes_has_the_same_bytes(path, cases, tmp_path):
    case = cases('own_load')
    unit, simulation = Unit(path, tmp_path / 'unit'), Simulation(case.run.scenario)
    without = []
    for k, tick in enumerate(case.ticks):
        changes = CHANGES.get(k, {})
        if changes:
            simulation.tune('ram', changes)
            unit.set(changes)
        simulation.step()
        unit.set(dict(inputs_of(tick, False)))
        unit.step()
        expected = [float(simulation.observed['ram'][name]) for name in SAMPLED]
        assert unit.numbers([*SAMPLED]).tobytes() == np.array(expected).tobytes(), k
        without.append(expected[0] == tick.sample['position'])
    assert all(without[:20]) and sum(without) < 200
    assert unit.messages == []


@pytest.mark.slow
def test_a_state_has_what_was_changed(path, cases, tmp_path):
    unit, other = (Unit(path, tmp_path / 'unit') for _ in range(2))
    ticks = cases('own_load').ticks
    for tick in ticks[:60]:
        unit.set(dict(inputs_of(tick, False)))
        unit.step()
    unit.set({'reu.force.kp': 3e-7})
    unit.step()
    unit.set({'reu.force.ki': 1e-5})     # not in force yet
    other.set({'reu.force.kp': 2e-8})
    other.step(4)
    other.restore(unit.state())
    other.n_steps = unit.n_steps
    for tick in ticks[61:120]:
        for own in (unit, other):
            own.set(dict(inputs_of(tick, False)))
            own.step()
    assert unit.state() == other.state() and other.get('reu.force.ki') == 1e-5
    unit.slave.reset()
    assert unit.get('reu.force.kp') == 8e-8


@pytest.mark.slow
def test_a_parameter_beyond_its_range_is_left_out(path, tmp_path):
    unit = Unit(path, tmp_path / 'unit')
    unit.set({'reu.force.kp': 1.0})
    assert unit.messages == [(WARNING, unit.messages[0][1])]
    assert 'reu.force.kp = 1 output/measured, must be 0 to 3.64544e-05 output/measured' in (
        unit.messages[0][1])
    assert unit.get('reu.force.kp') == 8e-8


@pytest.mark.slow
def test_only_these_are_tunable(path, cases, tmp_path):
    unit = Unit(path, tmp_path / 'unit')
    found = {name for name, own in unit.variables.items() if own.variability == 'tunable'}
    assert found == {own.name for own in tuned(cases('own_load').made.parts.own)}
    assert {name for changes in CHANGES.values() for name in changes} <= found
    assert OK < ERROR


@pytest.mark.slow
@pytest.mark.parametrize('model', model_names())
def test_every_gain_stands_at_its_place_whatever_the_others_are(model):
    """Of the packaged models; at random values, all at once."""
    own = exported(choose(model))
    base = own.layout().place(own.ticked.memory.constants)
    found = tuned(own)
    assert len({one.place for one in found}) == len(found) > 5
    draw = np.random.default_rng(7)
    actuator = own.actuator
    for _ in range(20):
        values = {}
        for one in found:
            value = one.low + (one.high - one.low) * draw.random() * 10.0 ** -draw.integers(0, 4)
            try:
                actuator.tune({one.name: value})
            except ConfigError:
                continue
            values[one] = value
        actuator.latch_tuning()
        floats = np.frombuffer(actuator.memory.constants.tobytes(), np.float64)
        for one, value in values.items():
            assert floats[(one.place - base) // 8] == value, one
        assert len(values) > 5
