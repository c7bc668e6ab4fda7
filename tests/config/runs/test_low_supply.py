"""A supply below the level of `supply_low`, which the REU does not know, is reported."""

from collections.abc import Mapping
from typing import Any
import warnings

import isa_ros
from isa_ros.config.paths import CONFIG, find, shipped
from isa_ros.config.runs.run_file import load_run
from isa_ros.config.text.yaml_text import read
from isa_ros.scenario.scenario import idle
import pytest

LOW = 'actuators.ram.parameters.reu.protection'


def lines(pressure: float, changes: Mapping[str, Any] | None = None) -> tuple[str, ...]:
    """Return what is said before a run of one ISA v5, whose relief valves open at 22 MPa."""
    return idle(isa_ros.load('rig_linear', changes={
        'supply.pressure_mpa': pressure, **(changes or {})}).configuration).warnings


def test_below_half_the_opening_pressure_it_warns() -> None:
    """0.5 of 22 MPa, with supply, actuator and key."""
    line, = lines(9.0)
    assert line == (
        'rig_linear.yaml: supply.pressure_mpa = 9 MPa < 11 MPa: ram will warn supply_low from the '
        'start (reu.protection.supply_low.warning, a part of the opening pressure of the relief '
        'valves; 0: off)')


def test_it_is_what_happens() -> None:
    """The device warns at the level that the line names, and not above it."""
    for pressure, warns in ((10.9, True), (11.1, False)):
        assert bool(lines(pressure)) is warns
        run = isa_ros.load('rig_linear', changes={'supply.pressure_mpa': pressure})
        with warnings.catch_warnings():
            warnings.simplefilter('ignore')
            simulation = run.simulation()
        for _ in range(30):
            simulation.step()
        assert bool(int(simulation.samples['ram'].warnings)) is warns


def test_below_the_trip_it_trips() -> None:
    """0.2 of 22 MPa; the trip alone is told."""
    line, = lines(4.0)
    assert '< 4.4 MPa: ram will trip supply_low' in line
    assert 'supply_low.trip, a part' in line


@pytest.mark.parametrize('changes', [
    {f'{LOW}.supply_low.warning': 0.3}, {f'{LOW}.supply_low.warning': 0.0},
    {f'{LOW}.supply_low.reaction': 'none'}, {f'{LOW}.switch': 'off'}, {f'{LOW}.mask': 1 << 7},
    {'actuators.ram.parameters.plant.relief.opening_pressure_mpa': 17.9}])
def test_what_is_not_watched_or_not_beyond_says_nothing(changes: dict[str, Any]) -> None:
    assert lines(9.0, changes) == ()
    assert lines(9.0, {f'{LOW}.mask': 1 << 6}) != ()


def test_each_supply_names_those_that_it_feeds() -> None:
    """With the highest of their levels."""
    supply = {'kind': 'constant', 'return_pressure_mpa': 0.0}
    tree = read(find('leg.yaml', CONFIG)) | {'supplies': {
        'high': supply | {'pressure_mpa': 20.7, 'feeds': ['haa']},
        'low': supply | {'pressure_mpa': 9.5, 'feeds': ['hfe', 'kfe']}}}
    del tree['supply']
    run = isa_ros.load(tree, changes={
        'actuators.kfe.parameters.plant.relief.opening_pressure_mpa': 25.0})
    line, = idle(run.configuration).warnings
    assert 'low.pressure_mpa = 9.5 MPa < 12.5 MPa: hfe, kfe will warn' in line


def test_of_the_shipped_runs_one_is_fed_with_less_as_its_page_says() -> None:
    """docs/servo_valve.md."""
    found = {name for name, path in shipped(CONFIG).items()
             if any('supply_low' in line for line in idle(load_run(path)).warnings)}
    assert found == {'rig_servo_valve.yaml'}


@pytest.mark.parametrize(('opens', 'tank', 'held'), [
    (9.0, 0.0, '9'), (10.6, 0.0, '10.6'), (10.6, 0.6, None), (10.2, 0.6, '10.8'),
    (13.0, 0.0, None)])
def test_of_a_circuit_it_is_what_its_relief_valve_leaves(
        opens: float, tank: float, held: str | None) -> None:
    """The device warns where the line says so, 0.5 of its 22 MPa, and not above it."""
    run = isa_ros.load('cooled_station', changes={
        'supplies.station.parts.safety.opens_mpa': opens,
        'supplies.station.parts.tank.pressure_mpa': tank})
    found = idle(run.configuration).warnings
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')
        simulation = run.simulation()
    for _ in range(30):
        simulation.step()
    assert bool(int(simulation.samples['cylinder'].warnings)) is bool(found) is (held is not None)
    if held is not None:
        assert found[0].startswith(
            f'cooled_station.yaml: station holds {held} MPa < 11 MPa: cylinder will warn ')


def test_below_the_return_the_oil_flows_the_other_way() -> None:
    """0.2 MPa beside 3: what an actuator draws is less than nothing."""
    run = isa_ros.load('rig_linear', changes={
        'supply.pressure_mpa': 0.2, 'supply.return_pressure_mpa': 3.0})
    with warnings.catch_warnings():
        warnings.simplefilter('ignore')
        found = run.simulate(0.05)
    assert found['ram.supply_volume'][-1] < 0.0 < found['ram.pressure_a'][-1] < 3e6
