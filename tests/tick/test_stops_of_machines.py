"""Stops of whole machines: a boom behind a counterbalance valve, a robot that stands."""

from isa_ros.config.text.yaml_text import Tree
from isa_ros.core.device import DISABLED, ENABLED, QUICK_STOP
from isa_ros.scripting.run import load
from isa_ros.simulation import Simulation
import pytest
from tests.tick.stopped_group import advance, states, SUPPLY

LIFT, PORT = 'crane/lift', {'kind': 'moving'}
CATEGORIES = ('close', 'ramp', 'ramp_and_hold')
AT = 1.5        # s, of the stop: the boom sinks at 40 mm/s
CRANE: Tree = SUPPLY | {
    'pressure_mpa': 8.0, 'return_pressure_mpa': 0.1, 'precharge_mpa': 4.0,
    'pump_flow_lpm': 60.0, 'relief_mpa': 9.5, 'port': PORT}
ROBOT: Tree = SUPPLY | {'line_volume_l': 0.2, 'pump_flow_lpm': 30.0, 'port': PORT}


def lowered(category: str, supply: Tree) -> Simulation:
    """Return the crane while its boom is let down, with stops of a category."""
    scenario = {'name': 'lower', 'duration_s': 5.0, 'tracks': {
        LIFT: [{'t_s': 0.0, 'position': 'hold'},
               {'t_s': 0.2, 'position': 'hold',
                'sine': {'amplitude': -0.08, 'frequency_hz': 0.08}}],
        'crane/tilt': [{'t_s': 0.0, 'position': 'hold'}]}}
    simulation = load('crane_counterbalance', scenario).replace({
        'supply': supply,
        'robots.crane.actuators.lift.parameters.reu.device.quick_stop': category,
    }).simulation()
    advance(simulation, round(AT * 1e3))
    assert simulation.samples[LIFT].velocity < -0.03
    return simulation


def travel(simulation: Simulation, seconds: float) -> tuple[float, float]:
    """Return how far in and out of its place at the stop the piston goes, m."""
    start = float(simulation.samples[LIFT].position)
    lowest = highest = 0.0
    for _ in range(round(seconds * 1e3)):
        simulation.step()
        now = float(simulation.samples[LIFT].position) - start
        lowest, highest = min(lowest, now), max(highest, now)
    return lowest, highest


@pytest.mark.parametrize('is_group', [True, False])
@pytest.mark.parametrize('category', CATEGORIES[1:])
def test_a_boom_stands_on_its_counterbalance_valve(category: str, is_group: bool) -> None:
    """
    Braked from 40 mm/s it stands 0.7 s later, on a supply whose pressure moves, dumped or not.

    A position loop behind the valve swings it by 8 mm and more, as long as the outputs are on.
    """
    simulation = lowered(category, CRANE)
    if is_group:
        simulation.emergency_stop()
    else:
        simulation.command(LIFT, quick_stop=True)
    assert min(travel(simulation, 0.7)) > -4e-3
    # an eighth of what it swung by; it swings on its oil by 0.3 mm, and creeps by 0.3 mm/s
    lowest, highest = travel(simulation, 1.5)
    assert -1e-3 < lowest <= highest < 1e-3
    stays = category == 'ramp_and_hold' and not is_group
    assert states(simulation) == [QUICK_STOP if stays else DISABLED,
                                  DISABLED if is_group else ENABLED]
    pressure = float(simulation.supply_samples['supply'].pressure)
    assert pressure < 0.2e6 if is_group else pressure > 7.5e6


def test_a_boom_whose_valve_closes_at_once_swings_on_its_oil_and_stays() -> None:
    """Category 0; 40 mm/s of 1.2 t at the tip of the boom are worth 4 mm of the cylinder's oil."""
    simulation = lowered('close', CRANE)
    simulation.emergency_stop()
    lowest, highest = travel(simulation, 2.5)
    assert -8e-3 < lowest < -1e-3
    assert highest < 2e-3
    assert states(simulation) == [DISABLED, DISABLED]


@pytest.mark.slow
@pytest.mark.parametrize('is_circuit', [False, True], ids=['port', 'circuit'])
@pytest.mark.parametrize('category', CATEGORIES)
def test_a_standing_robot_stays_and_sinks_by_its_leakage_alone(
        category: str, is_circuit: bool) -> None:
    """
    All 12 stop, the supply is dumped, and what moves on is leakage: 8 mm in 2 s at most.

    HAA of a smart manifold are turned by less than 3 mrad.
    """
    robot = 'robots.quadruped.' if is_circuit else ''
    name = 'quadruped_power_unit' if is_circuit else 'quadruped'
    scenario = {'name': 's', 'duration_s': 9.0, 'robots': {'quadruped': {
        'file': 'quadruped_stand'}}} if is_circuit else 'quadruped_stand'
    simulation = load(name, scenario).replace({
        f'{robot}actuators.{leg}_{joint}.parameters.reu.device.quick_stop': category
        for leg in ('lf', 'rf', 'lh', 'rh') for joint in ('haa', 'hfe', 'kfe')} | (
            {'supplies.unit.parts.emptied': {
                'kind': 'dump', 'inlet': 'rail', 'outlet': 'tank', 'rated_lpm': 30.0}}
            if is_circuit else {'supply': ROBOT})).simulation()
    advance(simulation, 1000)
    starts = [float(own.position) for own in simulation.samples.values()]
    simulation.emergency_stop()
    advance(simulation, 2000)
    assert states(simulation) == [DISABLED] * 12
    assert max(float(own.pressure) for own in simulation.supply_samples.values()) < 0.2e6
    for joint, own in enumerate(simulation.samples.values()):
        moved = abs(float(own.position) - starts[joint])
        assert moved < (3e-3 if joint % 3 == 0 else 10e-3)
