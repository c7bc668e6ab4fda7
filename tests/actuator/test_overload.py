"""A force on a load beyond which a chamber has no volume is refused, and what is left runs."""

from dataclasses import replace
import math
from typing import Any

import isa_ros
from isa_ros.actuator.overload import force_bounds, most_force, refuse_overload
from isa_ros.actuator.tunable import changing
from isa_ros.config.paths import CONFIG, shipped
from isa_ros.config.runs import actuator_config
from isa_ros.config.runs.run_file import load_run
from isa_ros.errors import ConfigError, SimulationDiverged
from isa_ros.loads.sheets import Blocked, Mass
from isa_ros.nodes.actuator.parameters import descriptor
import pytest


def small(force: float, **load: float) -> dict[str, Any]:
    """Return a run of a cylinder of 1 mm bore whose load has a force."""
    return {
        'name': 'small', 'step_ms': 1.0, 'controller_offset_ms': 0.12,
        'supply': {'kind': 'constant', 'pressure_mpa': 16.0, 'return_pressure_mpa': 0.2},
        'actuators': {'ram': {
            'model': 'cylinder', 'load': {'kind': 'mass', 'force': force, **load},
            'parameters': {'plant': {
                'drive': {'bore_mm': 1.0, 'rod_mm': 0.5, 'stroke_mm': 100.0,
                          'rated_pressure_mpa': 16.0},
                'valve': {'flow': {'rated_flow_lpm': 20.0, 'rated_current_ma': 10.0}}}}}}}


def plant_of(name: str) -> Any:
    return load_run(shipped(CONFIG)[name]).actuators[0].sheet.plant


def test_the_bound_is_relief_valve_and_end_stop() -> None:
    """`p_r A + k (V_p/A)^2/(2 L)` by hand, for each side with its own area."""
    plant = plant_of('press.yaml')
    bore, rod, stroke = 0.08, 0.056, 0.25
    assert plant.oil.dead_volume_ml == pytest.approx(62.85)
    for area, lower in ((math.pi / 4.0 * bore ** 2, False),
                        (math.pi / 4.0 * (bore ** 2 - rod ** 2), True)):
        depth = 62.85e-6 / area
        expected = (plant.relief.opening_pressure_mpa * 1e6 * area
                    + plant.mechanics.stop_stiffness * depth ** 2 / (2.0 * stroke))
        assert most_force(plant, area) == pytest.approx(expected, rel=1e-4)
        mass = Mass(inertia=600.0, force=expected * (1.0 if lower else -1.0))
        refuse_overload(plant, replace(mass, force=mass.force * 0.999))
        with pytest.raises(ConfigError, match='^load.force = .* a larger bore carries it$'):
            refuse_overload(plant, replace(mass, force=mass.force * 1.001))


@pytest.mark.parametrize(('force', 'bounds'), [
    (-1000.0, '-19.87 to 21.11 N'), (60.0, '-19.87 to 21.11 N')])
def test_a_cylinder_that_is_too_small_is_refused_in_one_line(force: float, bounds: str) -> None:
    with pytest.raises(ConfigError) as refused:
        isa_ros.load(small(force))
    said = str(refused.value)
    assert said.startswith('small.yaml: actuators.ram: load.force = ') and '\n' not in said
    assert f'{force:g} N, must be {bounds}: beyond it the load falls past' in said


@pytest.mark.parametrize('force', [-19.8, 21.0])
@pytest.mark.parametrize('inertia', [1.0, 100.0])
def test_what_is_accepted_does_not_diverge(force: float, inertia: float) -> None:
    """1.6 times the rated 12.6 N: it is on its stop, and the numbers are finite."""
    result = isa_ros.load(small(force, inertia=inertia)).simulate(0.5)
    position = result['ram.position']
    assert -0.013 < position.min() and position.max() < 0.113


def test_without_the_refusal_it_diverges(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(actuator_config, 'refuse_overload', lambda plant, load: None)
    with pytest.raises(SimulationDiverged):
        isa_ros.load(small(-1000.0)).simulate(0.5)


def test_motors_and_other_loads_have_no_such_bound() -> None:
    refuse_overload(plant_of('winch.yaml'), Mass(inertia=1.0, force=1e6))
    refuse_overload(plant_of('press.yaml'), None)


def test_a_vane_is_refused_in_its_own_unit() -> None:
    with pytest.raises(ConfigError, match='^load.force = 1e.06 Nm, .* a larger displacement'):
        refuse_overload(plant_of('rig_rotary.yaml'), Mass(inertia=1.0, force=1e6))


def test_the_description_of_a_changing_force_says_what_may_stay() -> None:
    """A push may be as large as declared: it is the range of the ROS parameter, not the text."""
    own = load_run(shipped(CONFIG)['rig_linear.yaml']).actuators[0]
    force = changing(own.sheet, own.load)['load.force']
    assert force.bounds == {'ge': -2e7, 'le': 2e7}
    shown = descriptor(force)
    assert shown.description == (
        'force on it, e.g. weight; > 0 pushes out; for longer than a push -1.557e+04 to '
        '2.15e+04 N, which the relief valves of the file and the end stop bear, N')
    span, = shown.floating_point_range
    assert (span.from_value, span.to_value) == (-2e7, 2e7)


def test_what_the_description_says_is_what_a_file_may_have() -> None:
    own = load_run(shipped(CONFIG)['lift_table.yaml']).actuators[0]
    low, high = force_bounds(own.sheet.plant, own.load) or (0.0, 0.0)
    assert f'; for longer than a push {low:.4g} to {high:.4g} N, ' in changing(
        own.sheet, own.load)['load.force'].doc
    for bound in (low, high):
        refuse_overload(own.sheet.plant, Mass(inertia=1.0, force=0.9999 * bound))
        with pytest.raises(ConfigError, match=f'must be {low:.4g} to {high:.4g} N'.replace(
                '+', '[+]')):
            refuse_overload(own.sheet.plant, Mass(inertia=1.0, force=1.0001 * bound))


def test_a_force_without_such_a_bound_is_described_without_it() -> None:
    own = load_run(shipped(CONFIG)['winch.yaml']).actuators[0]
    assert isinstance(own.load, Mass)
    assert changing(own.sheet, own.load)['load.force'].doc == (
        'force on it, e.g. weight; > 0 pushes out')
    held = Blocked(inertia=1.0, stiffness=1e8, damping=1e4)
    rig = load_run(shipped(CONFIG)['rig_linear.yaml']).actuators[0]
    assert changing(rig.sheet, held)['load.force'].doc == (
        'force from outside on it, > 0 pushes out')
