"""A fault lies over a value: what was tuned stays beneath it and comes back with its end."""

from isa_ros.config.paths import CONFIG, find
from isa_ros.errors import ConfigError
from isa_ros.run.options import Request
from isa_ros.run.session import prepare
from isa_ros.run.without_ros import run_without_ros
from isa_ros.scripting.run import load
from isa_ros.simulation import Simulation
from isa_ros.testing import assert_replays
import pytest

STICTION, PRESSURE = 'plant.friction.stiction', 'pressure_mpa'
WINDOW = ({'t_s': 0.01, 'actuator': 'ram', 'set': {STICTION: 150.0, 'reu.force.kf': 0.0},
           'until_s': 0.02},
          {'t_s': 0.01, 'supply': 'supply', 'set': {PRESSURE: 10.0}, 'until_s': 0.02})
RIG = load('rig_linear', duration=0.03)


def simulation() -> Simulation:
    return Simulation(RIG.scenario.with_faults(WINDOW))


def tune(own: Simulation, stiction: float, kf: float, pressure: float) -> None:
    own.tune('ram', {STICTION: stiction, 'reu.force.kf': kf})
    own.tune('supply', {PRESSURE: pressure})


def values(own: Simulation) -> tuple[float, float, float]:
    """Return what is in force, from the records of the kernels and the supply."""
    constants = own.group.actuators[0].memory.constants[0]
    return (float(constants['plant']['friction']['stiction']),
            float(constants['reu']['force']['kf']),
            float(own.supply_samples['supply'].pressure))


def advance(own: Simulation, ticks: int) -> None:
    for _ in range(ticks):
        own.step()


TUNED, MEANWHILE = (60.0, 2e-4, 18.0), (70.0, 3e-4, 16.0)


def in_si(tuned):
    return (*tuned[:2], pytest.approx(tuned[2] * 1e6))


@pytest.mark.parametrize('at', [0, 5, 10, 15])
def test_tuned_values_survive_a_fault(at):
    """Tuned before tick 0, before the fault, in its first tick, and while it lasts."""
    own = simulation()
    advance(own, at)
    tune(own, *TUNED)
    advance(own, 12 - at if at < 12 else 1)
    assert values(own) == (150.0, 0.0, pytest.approx(10e6))
    advance(own, 22 - own.ticks)
    assert values(own) == in_si(TUNED)


def test_what_is_tuned_meanwhile_replaces_what_was_beneath():
    own = simulation()
    tune(own, *TUNED)
    advance(own, 15)
    tune(own, *MEANWHILE)
    assert own.group.actuators[0].parameter(STICTION) == 150.0, 'it is in force at the next tick'
    advance(own, 10)
    assert values(own) == in_si(MEANWHILE)


def test_a_run_that_is_reset_has_its_tuned_values_and_its_faults_again():
    own = simulation()
    tune(own, *TUNED)
    advance(own, 15)
    own.reset()
    advance(own, 5)
    assert values(own) == in_si(TUNED)
    advance(own, 10)
    assert values(own) == (150.0, 0.0, pytest.approx(10e6))
    advance(own, 10)
    assert values(own) == in_si(TUNED)


@pytest.mark.parametrize('at', [5, 9, 10, 15, 19, 20])
def test_a_state_saved_about_a_fault_continues_with_what_is_beneath(at):
    own, other = simulation(), simulation()
    tune(own, *TUNED)
    advance(own, at)
    other.restore(own.snapshot())
    for one in (own, other):
        advance(one, 28 - at)
    assert values(other) == values(own) == in_si(TUNED)
    assert other.snapshot() == own.snapshot()


def test_a_value_that_does_not_fit_beneath_a_fault_is_refused_at_once():
    own = simulation()
    advance(own, 12)
    with pytest.raises(ConfigError, match='stiction = -1'):
        own.tune('ram', {STICTION: -1.0})
    advance(own, 10)
    assert values(own)[0] == RIG.configuration.actuator('ram').sheet.plant.friction.stiction


def test_tuned_under_a_fault_it_replays(tmp_path):
    """Also from a saved state in the middle of the fault."""
    scenario = tmp_path / 'window.yaml'
    scenario.write_text(f'name: window\nduration_s: 0.03\nfaults: {list(WINDOW)}\n'
                        'tracks: {ram: [{t_s: 0.0, position: hold}]}\n')
    common = {'config': find('rig_linear', CONFIG), 'scenario': scenario}
    run_without_ros(prepare(Request(
        **common, out=tmp_path / 'first', duration_s=0.015, save=tmp_path / 'state.json')),
        None, lambda: False)
    run_without_ros(prepare(Request(
        **common, out=tmp_path / 'second', restore=tmp_path / 'state.json')),
        None, lambda: False)
    for bag in ('first', 'second'):
        assert_replays(tmp_path / bag)
