"""Actuators fed by a warm tank: oil that may get too cold, temperatures that are not used."""

from collections.abc import Callable
from pathlib import Path

from isa_ros.config.paths import CONFIG, find
from isa_ros.config.text.yaml_text import read
from isa_ros.core.oil_properties import thickness
from isa_ros.errors import ConfigError
from isa_ros.plant.plant import plant_record
from isa_ros.scripting.run import load
from isa_ros.simulation import Simulation
import pytest

SHIPPED = load('warm_stand', 'warm_stand', duration=0.4)


def cold(celsius: float) -> Callable[[], object]:
    """Return what loads the shipped stand in a cold air; checked when it is assembled."""
    return lambda: Simulation(load('warm_stand', 'warm_stand', changes={
        'supplies.station.parts.tank.heat.air_celsius': celsius}).scenario)


def test_oil_that_may_get_too_cold_for_an_actuator_is_refused() -> None:
    """Its friction is too fast for the step; -12 celsius is not, nor is -30 without walls."""
    cold(-12.0)()
    with pytest.raises(ConfigError, match=(
            r'station: its oil can get as cold as -30 celsius by its start, air and coolants, '
            r'must be >= -2\d\.\d celsius: the friction of an actuator that it feeds is too '
            r'fast for the plant step of 20 us')):
        cold(-30.0)()
    simulation = Simulation(SHIPPED.scenario)
    with pytest.raises(ConfigError, match='its oil can get as cold as -29.5 celsius'):
        simulation.surroundings.tune({'station.parts.cooler.coolant_celsius': -29.5})
    simulation.surroundings.tune({'station.parts.cooler.coolant_celsius': -12.0})


@pytest.mark.parametrize('name', ['moved', 'held'])
def test_the_load_of_each_actuator_counts(name: str) -> None:
    """50 g bear no friction of -27.5 celsius: -27.1 is its bound, whichever actuator it is."""
    cold(-27.5)()
    with pytest.raises(ConfigError, match=r'as cold as -27\.5 .*, must be >= -27\.1 celsius'):
        Simulation(load('warm_stand', 'warm_stand', changes={
            'supplies.station.parts.tank.heat.air_celsius': -27.5,
            f'actuators.{name}.load': {'kind': 'mass', 'inertia': 0.05}}).scenario)


@pytest.mark.parametrize('name', ['moved', 'held'])
def test_the_seals_of_each_actuator_count(name: str) -> None:
    """Twice the friction is as much as before, -28.3 celsius, with oil half as thick: -23.2."""
    own = plant_record(SHIPPED.configuration.actuator(name).sheet.plant)[0].thermal.oil
    assert thickness(-23.2, own) == pytest.approx(0.5 * thickness(-28.27, own), rel=0.01)
    cold(-25.0)()
    with pytest.raises(ConfigError, match=r'as cold as -25 .*, must be >= -23\.2 celsius'):
        Simulation(load('warm_stand', 'warm_stand', changes={
            'supplies.station.parts.tank.heat.air_celsius': -25.0,
            f'actuators.{name}.parameters.plant.friction.viscous': 400.0}).scenario)


def test_a_supply_s_temperature_is_refused_on_a_warm_tank(tmp_path: Path) -> None:
    """Of whichever actuator, and on another supply or a circuit without heat it is not."""
    text = find('warm_stand', CONFIG).read_text(encoding='utf-8').replace(
        'start_celsius: 15.0, ambient', 'start_celsius: 15.0, supply_celsius: 41.0, ambient', 1)
    path = tmp_path / 'own.yaml'
    path.write_text(text, encoding='utf-8')
    with pytest.raises(ConfigError) as error:
        load(path)
    assert str(error.value) == (
        'own.yaml: actuators.moved.parameters.plant.thermal.supply_celsius is not used: station '
        'feeds it with the oil of its tank, which has a temperature of its own')
    with pytest.raises(ConfigError, match=r'actuators\.held\.parameters.* is not used: station'):
        load('warm_stand', changes={
            'actuators.held.parameters.plant.thermal.supply_celsius': 41.0})
    more = {'model': 'isa_v5', 'variants': ['thermal'], 'load': {'kind': 'mass'}, 'parameters': {}}
    for run_file, changes in (('rig_temperature', {}), ('pump_station', {
            'actuators.leak': more, 'supplies.station.feeds': {
                'press': ['left', 'right'], 'tool': ['clamp', 'leak']}})):
        own = load(run_file, changes={
            **changes, 'actuators.leak.parameters.plant.thermal.supply_celsius': 41.0})
        assert own.configuration.actuator('leak').sheet.plant.thermal.supply_celsius == 41.0


def test_it_is_refused_on_a_later_supply() -> None:
    """On the constant one beside it, which is the first, it is not."""
    tree = read(find('warm_stand', CONFIG))
    station = tree['supplies']['station'] | {'feeds': {'gallery': ['moved']}}
    tree['supplies'] = {
        'main': {'kind': 'constant', 'pressure_mpa': 20.7, 'return_pressure_mpa': 0.1,
                 'feeds': ['held']}, 'station': station}
    key = 'parameters.plant.thermal.supply_celsius'
    with pytest.raises(ConfigError, match=rf'moved\.{key} is not used: station feeds it'):
        load(tree, changes={f'actuators.moved.{key}': 41.0})
    own = load(tree, changes={f'actuators.held.{key}': 41.0}).configuration.actuator('held')
    assert own.sheet.plant.thermal.supply_celsius == 41.0
