"""Warm oil in runs: bag, replay, saved states, report."""

from pathlib import Path

from isa_ros.analysis.report.circuit_panels import circuit_group
from isa_ros.analysis.report.extremes import extremes
from isa_ros.analysis.signals.recorded_result import read as read_bag
from isa_ros.analysis.signals.signals import signals_of
from isa_ros.bag.reader import Bag
from isa_ros.scripting.result import Result
from isa_ros.scripting.run import load
from isa_ros.simulation import Simulation
import pytest
from tests.replay.replayed import content, replayed, result_of

SCENARIO = {'name': 'warmed', 'duration_s': 0.3, 'tracks': {'cylinder': [
    {'t_s': 0.0, 'position': 'hold'},
    {'t_s': 0.02, 'position': 'hold', 'sine': {'amplitude': 0.01, 'frequency_hz': 4.0}}]},
    'faults': [{'t_s': 0.15, 'supply': 'station', 'part': 'cooler', 'set': {'fouled': 0.9}}]}
TANK = 'station/tank'
RUN = load('cooled_station', SCENARIO, changes={
    'supplies.station.parts.tank.heat.oil_volume_l': 0.2,
    'supplies.station.parts.tank.heat.metal_heat_capacity': 0.0})


@pytest.fixture(scope='module')
def result() -> Result:
    return result_of(RUN.scenario)


def test_the_tank_warms_and_dirt_lets_it_warm_faster(result: Result) -> None:
    """6 kW into 340 J/K; what the cooler gives falls to a tenth with the fault."""
    oil, cooled = result[f'{TANK}.oil_temperature'], result['station/cooler.heat']
    assert oil[0] == 40.0 and oil[-1] > 43.0
    before, after = cooled[149] - cooled[139], cooled[-1] - cooled[-11]
    warmer = (oil[-1] - 22.0) / (oil[145] - 22.0)
    assert after == pytest.approx(0.1 * before * warmer, rel=0.02)


def test_a_run_replays_and_a_bag_has_the_temperature(result: Result, tmp_path: Path) -> None:
    """Byte for byte, and the topic is the tank's alone."""
    bag = result.save(tmp_path / 'bag')
    assert replayed(bag, tmp_path / 'again') == content(bag)
    types = Bag(bag).types
    assert types[f'/{TANK}_oil_temperature'] == 'sensor_msgs/msg/Temperature'
    assert [name for name in types if name.endswith('oil_temperature')] == [
        f'/{TANK}_oil_temperature']
    read = read_bag(bag)
    assert (read[f'{TANK}.oil_temperature'] == result[f'{TANK}.oil_temperature']).all()
    assert read.units[f'{TANK}.oil_temperature'] == 'celsius'


def test_a_saved_run_goes_on_byte_for_byte(result: Result) -> None:
    """From after the fault."""
    first, second = Simulation(RUN.scenario), Simulation(RUN.scenario)
    for _ in range(170):
        first.step()
    second.restore(first.snapshot())
    assert second.surroundings.supplies.tobytes() == result.log.supplies[170].tobytes()
    for _ in range(130):
        second.step()
    assert second.surroundings.supplies.tobytes() == result.log.supplies[-1].tobytes()


def test_a_report_draws_the_temperature_and_has_its_extremes(result: Result) -> None:
    """In a panel of its own."""
    signals = signals_of(result)
    group = circuit_group(signals.run.supplies[0], signals)
    panel, = (one for one in group.panels if one.title == 'temperature of the oil')
    assert [curve.label for curve in panel.curves] == ['tank']
    found = {row[0]: row[1:] for row in extremes(signals)}
    least, greatest, unit = found[f'{TANK} oil temperature']
    oil = result[f'{TANK}.oil_temperature']
    assert (least, greatest, unit) == (oil.min(), oil.max(), 'celsius')


def test_oil_without_heat_has_no_topic() -> None:
    tank = load('pump_station').configuration.supplies[0].sampled[1]
    assert tank.name == TANK and tank.published == ()
